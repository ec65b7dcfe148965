#!/usr/bin/env python3
"""The checks of the documentation find mistakes that are planted here."""

import contextlib
import importlib.util
import io
import sys
import tempfile
import unittest
from pathlib import Path

import tutorial

SITE = Path(__file__).resolve().parents[2] / "docs" / "site"


def loaded(name):
    spec = importlib.util.spec_from_file_location(name, SITE / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


by_stage, check_links, stage = (loaded(n) for n in ("by_stage", "check_links", "stage"))


class Folder(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name).resolve()

    def write(self, name, text):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        return path


class Tutorial(Folder):
    def read(self, text):
        page = self.write("page.md", text)
        work = self.folder / "work"
        work.mkdir()
        reader = tutorial.Reader(page, self.folder / "prefix", work)
        reader.read()
        return reader

    def test_files_commands_and_programs_are_run_in_order(self):
        reader = self.read("```c\n// a.txt: one\n```\n```c\n// a.txt: two\n```\n"
                           "```sh\nwc -l <a.txt\n```\n```text\n2\n```\n"
                           "```python\nx = 3\n```\nwords\n```python\nprint(x, 'done')\n```\n```text\n3 ...e\n```\n")
        self.assertEqual((reader.ran, reader.files), (2, {"a.txt"}))

    def test_a_command_that_fails_is_found_with_its_line(self):
        with self.assertRaisesRegex(SystemExit, "page.md:2: status 3"):
            self.read("\n```sh\nexit 3\n```\n")

    def test_another_output_is_found(self):
        for block in ("sh\necho one", "python\nprint('one')"):
            with self.subTest(block), self.assertRaisesRegex(SystemExit, "expected:\ntwo"):
                self.setUp()
                self.read(f"```{block}\n```\n```text\ntwo\n```\n")

    def test_a_block_that_nobody_runs_is_found(self):
        with self.assertRaisesRegex(SystemExit, "is not run by anybody"):
            self.read("```cpp\nint x;\n```\n")


class Links(Folder):
    def problems(self, body):
        self.write("b.html", "<h1 id='there'>b</h1>")
        self.write("a.html", body)
        return check_links.check(self.folder)[1]

    def test_links_to_pages_places_and_other_sites_pass(self):
        self.assertEqual(self.problems("<a href='b.html#there'></a><a href='https://example.org'></a>"), [])

    def test_links_that_lead_nowhere_are_found(self):
        self.assertIn("leads nowhere", self.problems("<img src='gone.png'>")[0])
        self.assertIn("no such place", self.problems("<a href='b.html#gone'></a>")[0])

    def test_what_is_loaded_from_elsewhere_is_found(self):
        self.assertIn("from elsewhere", self.problems("<script src='https://example.org/x.js'></script>")[0])
        self.write("a.css", "@font-face { src: url(//example.org/x.woff); }")
        self.assertIn("a.css", self.problems("")[0])


class Stage(Folder):
    def site(self, left_out=None, **pages):
        for name in stage.PAGES:
            self.write(name, "# page\n\nfirst\n\nrest\n")
        for name in ("site.css", "theme_extra.js", "cell.js"):
            self.write(f"docs/site/{name}", "")
        for name, text in pages.items():
            self.write(f"docs/{name}.md", text)
        self.write("docs/site/mkdocs.yml", "\n".join(
            [*stage.PAGES, *(f"docs/{name}.md" for name in pages if name != left_out)]))
        out = self.folder / "out"
        out.mkdir(exist_ok=True)
        stage.Site(self.folder, out).run()
        return out

    def test_a_link_to_a_source_leads_to_a_page_that_shows_it(self):
        self.write("src/a.cpp", "int answer = 42;\n")
        self.write("examples/b.py", "print()\n")
        out = self.site(one="[a](../src/a.cpp), [all](../examples/), [other](two.md)\n", two="# two\n")
        self.assertIn("[a](../src/a.cpp.md), [all](../examples/index.md), [other](two.md)",
                      (out / "docs/one.md").read_text())
        self.assertIn("```cpp\nint answer = 42;", (out / "src/a.cpp.md").read_text())
        self.assertTrue((out / "examples/b.py.md").exists())

    def test_programs_in_javascript_run_where_the_page_for_the_browser_is(self):
        text = "# one\n\n```js\nlet a = 1;\n\nif (a < 2) a = 3;\n```\n\nEnd\n"
        self.assertEqual((self.site(one=text) / "docs/one.md").read_text(), text)
        self.setUp()
        self.write("out/touch/page/index.html", "")
        page = (self.site(one=text, two="# two\n") / "docs/one.md").read_text()
        self.assertNotIn("```", page)
        self.assertIn('data-module="../touch/palpate.js"', page)
        self.assertIn("let a = 1;\n\nif (a &lt; 2) a = 3;</textarea>", page)
        self.assertIn('src="../cell.js"', page)

    def test_a_link_to_what_is_not_there_is_found(self):
        with self.assertRaisesRegex(SystemExit, "one.md: links to ../gone.cpp"):
            self.site(one="[a](../gone.cpp)\n")

    def test_code_has_no_links(self):
        text = "# one\n\n```cpp\nauto f = [&](const int& a) { return a; };\n```\n\n[two](two.md)\n"
        self.assertEqual((self.site(one=text, two="# two\n") / "docs/one.md").read_text(), text)

    def test_a_page_that_the_navigation_lacks_is_found(self):
        with self.assertRaisesRegex(SystemExit, "lacks docs/two.md"):
            self.site(left_out="two", one="# one\n", two="# two\n")

    def test_lists_are_as_python_markdown_wants_them(self):
        self.assertEqual(stage.for_markdown("Text:\n- one\n  more\n  - inner\n\n  again\n- two\n\nEnd\n"),
                         "Text:\n\n- one\n    more\n    - inner\n\n    again\n- two\n\nEnd\n")
        self.assertEqual(stage.for_markdown("```\nText:\n- one\n```\n"), "```\nText:\n- one\n```\n")


class Groups(Folder):
    def test_a_stage_a_library_and_the_c_interface_have_groups_in_the_order_of_the_flow(self):
        self.write("palpate/servo.hpp", "// Stage 20, servo: the thread.\n#pragma once\n")
        self.write("palpate/proxy.hpp", "// Stage 9, proxy: the point.\n#pragma once\n")
        self.write("palpate/io/trace.hpp", "// Traces.\n#pragma once\n")
        self.write("palpate-c/palpate.h", "/* In C. */\n")
        said = io.StringIO()
        with contextlib.redirect_stdout(said):
            by_stage.define_groups(self.folder)
        places = [said.getvalue().index(f"@defgroup {name} ") for name in ("proxy", "servo", "io", "palpate-c")]
        self.assertEqual(places, sorted(places))
        self.assertIn("The thread.", said.getvalue())

    def test_lines_keep_their_numbers(self):
        text = "// Stage 9, proxy: the point.\n#pragma once\nnamespace palpate {\nint a;\n}  // namespace palpate\n"
        read = by_stage.for_doxygen(Path("palpate/proxy.hpp"), text)
        self.assertEqual(read.count("\n"), text.count("\n"))
        self.assertIn("@addtogroup proxy", read.split("\n")[2])


if __name__ == "__main__":
    sys.dont_write_bytecode = True
    unittest.main()
