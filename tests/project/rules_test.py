#!/usr/bin/env python3
"""The rule checks find violations that are planted here."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import figures
import globals as writable
import includes
import pages
import prose
import style

GOOD = {
    "include/palpate/volume.hpp": "#include <Eigen/Core>\n#include <vector>\n",
    "include/palpate/field.hpp": '#include "palpate/volume.hpp"\n',
    "include/palpate/lattice.hpp": '#include "palpate/field.hpp"\n',
    "include/palpate/surface.hpp": '#include "palpate/lattice.hpp"\n',
    "include/palpate/proxy.hpp": '#include "palpate/lattice.hpp"\n',
    "include/palpate/force.hpp": '#include <palpate/proxy.hpp>\n',
    "include/palpate/palpate.hpp": "".join(
        f'#include "palpate/{name}.hpp"\n'
        for name in ("volume", "field", "lattice", "proxy", "force", "surface")),
    "src/proxy/site.hpp": '#include "palpate/proxy.hpp"\n',
    "src/proxy/site.cpp": '#include "proxy/site.hpp"\n',
    "src/force.cpp": '#include "palpate/force.hpp"\n',
    "baselines/gradient.cpp": '#include "palpate/proxy.hpp"\n',
    "scenes/volumes.hpp": '#include "palpate/volume.hpp"\n',
    "io/read.hpp": '#include <itkImage.h>\n#include "scenes/volumes.hpp"\n',
    "apps/palpate/main.cpp": '#include "io/read.hpp"\n#include "palpate/palpate.hpp"\n',
    "devices/devices.cpp": '#include "devices/haply/haply.hpp"\n',
    "devices/haply/haply.hpp": "#include <string>\n",
    "devices/spacenav/puck.hpp": "#include <string>\n",
    "apps/viewer/model/run_state.hpp": '#include "palpate/proxy.hpp"\n',
    "apps/viewer/window/main_window.cpp": '#include "apps/viewer/model/run_state.hpp"\n',
    "tests/core/cone_test.cpp": '#include "proxy/site.hpp"\n#include <gtest/gtest.h>\n',
}


class Tree:
    """A small source tree: the good one, with some files replaced."""

    def __init__(self, changes):
        self.folder = tempfile.TemporaryDirectory()
        self.root = Path(self.folder.name).resolve()
        for name, text in {**GOOD, **changes}.items():
            path = self.root / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")

    def __enter__(self):
        return self.root

    def __exit__(self, *_):
        self.folder.cleanup()


class Includes(unittest.TestCase):
    def problems(self, changes):
        with Tree(changes) as root:
            return includes.check(root)

    def assert_found(self, name, include, words):
        problems = self.problems({name: GOOD.get(name, "") + f"#include {include}\n"})
        self.assertEqual(len(problems), 1, problems)
        self.assertIn(name, problems[0])
        self.assertIn(words, problems[0])

    def test_a_tree_that_keeps_the_rules_passes(self):
        self.assertEqual(self.problems({}), [])

    def test_a_stage_may_not_include_a_later_one(self):
        self.assert_found("include/palpate/field.hpp", '"palpate/lattice.hpp"', "after field")
        self.assert_found("src/proxy/site.cpp", '"palpate/force.hpp"', "after proxy")
        self.assert_found("include/palpate/surface.hpp", '"palpate/proxy.hpp"', "after density")

    def test_a_private_header_does_not_hide_its_stage(self):
        self.assert_found("src/field.cpp", '"proxy/site.hpp"', "after field")

    def test_no_stage_includes_the_observer(self):
        self.assert_found("src/force.cpp", '"palpate/surface.hpp"', "observes")

    def test_the_core_does_not_include_the_umbrella(self):
        self.assert_found("src/force.cpp", '"palpate/palpate.hpp"', "all of it")

    def test_the_core_needs_nothing_but_the_standard_library_and_eigen(self):
        for outside in ("<itkImage.h>", "<QWidget>", "<fmt/format.h>", '"palpate/gone.hpp"'):
            self.assert_found("src/force.cpp", outside, "nothing else")
        self.assert_found("baselines/gradient.cpp", "<vtkMath.h>", "nothing else")

    def test_folders_see_only_what_they_may(self):
        self.assert_found("include/palpate/force.hpp", '"proxy/site.hpp"', "may not see src/")
        self.assert_found("baselines/gradient.cpp", '"proxy/site.hpp"', "may not see src/")
        self.assert_found("scenes/volumes.hpp", '"io/read.hpp"', "may not see io/")
        self.assert_found("apps/palpate/main.cpp", '"proxy/site.hpp"', "may not see src/")
        self.assert_found("io/read.hpp", '"apps/palpate/main.cpp"', "may not see apps/")

    def test_an_inner_folder_sees_what_its_own_line_lists(self):
        self.assert_found("apps/viewer/model/run_state.hpp", '"apps/viewer/window/main_window.cpp"',
                          "may not see apps/viewer/window/")
        self.assert_found("apps/palpate/main.cpp", '"apps/viewer/model/run_state.hpp"',
                          "may not see apps/viewer/model/")

    def test_alternatives_beside_each_other_do_not_know_of_each_other(self):
        self.assert_found("devices/haply/haply.hpp", '"devices/spacenav/puck.hpp"', "beside it")

    def test_a_folder_that_nobody_listed_is_found(self):
        self.assertIn("in no line", self.problems({"apps/new/a.cpp": '#include "io/read.hpp"\n'})[0])

    def test_a_public_header_that_includes_a_private_one_is_found(self):
        for name, include in (("include/palpate/io/read.hpp", '"io/read.hpp"'),
                              ("include/palpate/scenes/named.hpp", '"scenes/volumes.hpp"')):
            self.assert_found(name, include, "public headers only")
        self.assert_found("include/palpate/scenes/named.hpp", '"io/read.hpp"', "may not see io/")

    def test_a_way_around_through_the_parent_folder_is_found(self):
        self.assert_found("apps/palpate/main.cpp", '"../../src/proxy/site.hpp"', "never ..")

    def test_a_stage_that_nobody_put_in_the_flow_is_found(self):
        self.assertIn("not a stage", self.problems({"src/extra.cpp": "\n"})[0])

    def test_the_umbrella_lists_every_header_in_order(self):
        name = "include/palpate/palpate.hpp"
        lines = GOOD[name].splitlines(keepends=True)
        self.assertIn("order", self.problems({name: "".join(reversed(lines))})[0])
        self.assertIn("missing", self.problems({name: "".join(lines[:-1])})[0])

    def test_a_source_that_windows_lacks_is_found(self):
        tree = {"stream/CMakeLists.txt": "if(WIN32)  # raw files\n  set(sources plain.cpp store_windows.cpp)\nendif()\n",
                "stream/plain.cpp": '#include "stream/room.hpp"\n', "stream/room.hpp": "\n",
                "stream/store_windows.cpp": "\n"}
        self.assertEqual(self.problems(tree), [])
        tree["stream/room.cpp"] = "\n"
        self.assertIn("plain.cpp needs room.cpp on Windows", self.problems(tree)[0])
        tree["stream/store_windows.cpp"] = '#include "stream/room.hpp"\n'
        self.assertEqual(self.problems(tree), [])


class Style(unittest.TestCase):
    def assert_found(self, name, text, words):
        with Tree({name: text}) as root:
            problems = style.check(root)
        self.assertEqual(len(problems), 1, problems)
        self.assertIn(words, problems[0])

    def test_a_tree_that_keeps_the_rules_passes(self):
        with Tree({"src/force.cpp": "int a;\n" * 500}) as root:
            self.assertEqual(style.check(root), [])

    def test_long_files_and_headers_are_found(self):
        self.assert_found("src/force.cpp", "int a;\n" * 501, "501 lines")
        self.assert_found("include/palpate/force.hpp", "int a;\n" * 301, "301 lines")

    def test_long_functions_are_found(self):
        for head, indent in (("void f() {", ""), ("TEST(Proxy, stays_free) {", ""),
                             ("double Field::cell(\n    int a, int b) const {", ""),
                             ("Field::Field(int a)\n    : a_(a),\n      b_{2} {", ""),
                             ("auto f() -> int {", ""), ("int g() const noexcept {", "    ")):
            for body, found in ((58, False), (59, True)):
                lines = head.split("\n") + ["    g();"] * (body - head.count("\n")) + ["}"]
                lines[0], lines[-1] = indent + lines[0], indent + lines[-1]
                lengths = [length for _, length in style.functions("\n".join(lines))]
                self.assertEqual([length > 60 for length in lengths], [found], head)

    def test_a_long_loop_or_namespace_is_not_a_function(self):
        for head in ("namespace palpate {", "struct Field {", "    for (;;) {", "    if (f(x)) {"):
            self.assertEqual(list(style.functions(f"{head}\n" + "int a;\n" * 99 + "}\n")), [])

    def test_names_that_say_nothing_are_found(self):
        self.assert_found("src/utils/force.cpp", "\n", "utils")
        self.assert_found("src/force.cpp", "class ForceManager {\n};\n", "ForceManager")

    def test_paths_of_the_build_machine_are_found(self):
        self.assert_found("scripts/run.sh", "cd /" + "home/somebody/palpate\n", "one machine")
        with Tree({}) as root:
            (root / "scripts").mkdir()
            (root / "scripts/run.sh").write_text(f"cd {root}/src\n", encoding="utf-8")
            self.assertEqual(len(style.check(root)), 1)


class Globals(unittest.TestCase):
    compiler = "c++"
    nm = "nm"

    def problems(self, source):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "one.cpp"
            path.write_text(source, encoding="utf-8")
            subprocess.run([self.compiler, "-std=c++20", "-O1", "-fPIC", "-c", str(path), "-o",
                            str(path.with_suffix(".o"))], check=True)
            listing = subprocess.run(
                [self.nm, "--demangle", "--defined-only", "--format=sysv",
                 str(path.with_suffix(".o"))], check=True, capture_output=True, text=True).stdout
            return writable.problems_in(listing)

    def test_constants_and_virtual_tables_pass(self):
        self.assertEqual(self.problems(
            "extern const char* const words[] = {\"a\", \"b\"}; extern const int three = 3;\n"
            "struct S { virtual ~S(); virtual void f(); }; S::~S() {} void S::f() { throw 1; }\n"
            "void g() { try { S().f(); } catch (int) {} }\n"), [])

    def test_every_kind_of_global_is_found(self):
        for source in ("int counter;", "int counter = 1;", "thread_local int counter;",
                       "inline int counter = 1; int* use() { return &counter; }",
                       "int f() { static int counter = 0; return ++counter; }",
                       "struct S { S(); int a; }; S& f() { static S counter; return counter; }",
                       "namespace { int counter = 1; } int f() { return counter++; }"):
            found = self.problems(source)
            self.assertTrue(any("counter" in problem for problem in found), source)


class Prose(unittest.TestCase):
    BAD = {"long": "It " + "goes on and " * 12 + "ends.", "fronted": "Of a store, pictures are made.",
           "is not": "It refuses a member that there is not.", "per": "It costs 30 ns a tetrahedron.",
           "what": "It lists what a file lacks.", "semicolons": "It starts; it ends."}
    GOOD = ("It costs 30 ns per tetrahedron, 1000 times a second.", "Where do I put a device?", "It says what is wrong.",
            "`a; b` is code.", "[Of](of;it.md)")

    def found(self, name, text):
        with Tree({name: text}) as root:
            return next(prose.found_in(parts)[0] for file, parts in prose.blocks(root) if file == name)

    def test_every_pattern_is_found_with_its_line(self):
        for rule, text in self.BAD.items():
            for name, opening in (("docs/a.md", "# Of a page\n\nIt has\ntwo lines. "), ("src/force.cpp", "// It has.\n//\n// "),
                                  ("include/palpate/force.hpp", "int a;\n\n// It has. "), ("docs/b.md", "|a|\n|-|\n| ")):
                self.assertEqual(self.found(name, opening + text + "\n"), {rule: [(opening.count("\n") + 1, text)]}, name)

    def test_good_sentences_code_and_headings_pass(self):
        for text in self.GOOD:
            self.assertEqual(self.found("docs/a.md", text + "\n"), {}, text)
        self.assertEqual(self.found("docs/a.md", "# Of it; and it\n\n```\nOf a; b\n```\n\n    Of a; b\n"), {})
        self.assertEqual(self.found("src/force.cpp", "// Forces.\n\n// Of another comment; not checked.\n"), {})


class Figures(unittest.TestCase):
    CSV = "method,mean_ns\nexact,108.9\nsmooth,270.5\nsmooth,511.2\n"

    def wrong(self, said, mark):
        text = f"An update takes\n{said} \u00b5s.\n<!-- figure {mark} -->\n"
        with Tree({"docs/a.csv": self.CSV}) as root:
            return figures.problem(root, text, figures.MARK.search(text))

    def test_numbers_that_the_csv_gives_pass(self):
        self.assertIsNone(self.wrong("0.51", "0.51: docs/a.csv, max mean_ns / 1000, method=smooth"))
        self.assertIsNone(self.wrong("109", "109: docs/a.csv, only mean_ns, method=exact"))
        self.assertIsNone(self.wrong("8.91e2", "8.91e2: docs/a.csv, sum mean_ns"))

    def test_numbers_that_are_others_or_not_in_the_text_are_found(self):
        for said, mark in (("0.52", "0.52: docs/a.csv, max mean_ns / 1000, method=smooth"),
                           ("10.51", "0.51: docs/a.csv, max mean_ns / 1000, method=smooth"),
                           ("0.51", "0.51: docs/a.csv, max mean_ns / 1000, method=paper"),
                           ("511", "511: docs/a.csv, only mean_ns, method=smooth"),
                           ("511", "511: docs/a.csv, max mean, method=smooth"),
                           ("511", "511: docs/b.csv, max mean_ns"),
                           ("511", "511 of docs/a.csv")):
            self.assertIsNotNone(self.wrong(said, mark), mark)


class Pages(unittest.TestCase):
    def found(self, text):
        known = {("Proxy", "never_enters_the_solid")}, {"a_hand_that_jumps_over_a_wall"}, {"tests/core/proxy_test.cpp"}
        return [problem for _, problem in pages.problems(text, *known)]

    def test_names_of_tests_and_files_that_exist_pass(self):
        self.assertEqual(self.found("`Proxy.never_enters_the_solid`, `Every/Proxy.never_enters_the_solid`, `core/proxy_test.cpp`, "
                                    "`a_hand_that_jumps_over_a_wall`, `devices/NAME/NAME.cpp`\n```\n`core/none.cpp`\n```\n"), [])

    def test_options_that_a_command_lacks_are_found(self):
        def of_command(*command):
            return "--isovalue --force-limit" if command == ("touch",) else "--beats" if command == ("demo", "beating") else ""
        text = "`palpate touch a.nrrd --isovalue 3 --force-limit 1`, `palpate demo beating --beats 2`, `palpate ros --arm /a`\n"
        self.assertEqual(list(pages.options_that_are_none(text, of_command)), [])
        for wrong in ("touch --force", "touch --isovalues 3", "demo beating --isovalue 3"):
            self.assertEqual(len(list(pages.options_that_are_none(f"\n    palpate {wrong}\n", of_command))), 1, wrong)

    def test_names_that_lead_nowhere_are_found(self):
        for name in ("Proxy.always_enters_the_solid", "Field.never_enters_the_solid", "core/prox_test.cpp",
                     "a_hand_that_jumps_over_the_wall"):
            self.assertEqual(len(self.found(f"`{name}`")), 1, name)


if __name__ == "__main__":
    if len(sys.argv) == 3:  # rules_test.py COMPILER NM
        Globals.compiler, Globals.nm = sys.argv[1:]
        del sys.argv[1:]
    unittest.main()
