"""The reference on the site has every name of the module, with a text."""

import importlib.util
import pathlib
import re

import palpate

SOURCE = pathlib.Path(__file__).parents[2] / "docs" / "site" / "python_reference.py"
spec = importlib.util.spec_from_file_location("python_reference", SOURCE)
reference = importlib.util.module_from_spec(spec)
spec.loader.exec_module(reference)
PAGES = reference.pages()


def test_each_function_class_command_and_module_is_in_the_reference():
    told = set(re.findall(r"^## (\S+)$", "\n".join(PAGES.values()), re.MULTILINE))
    wanted = {name for name in palpate.__all__ if callable(getattr(palpate, name))} | set(reference.by_name(
        reference.named(reference.PACKAGE / "__init__.pyi")["command"][0])) | {f"palpate.{name}" for name in reference.MODULES}
    assert told == wanted


def test_each_member_of_a_class_is_in_the_reference():
    for name, [node, *_] in reference.named(reference.PACKAGE / "__init__.pyi").items():
        if isinstance(node, reference.CLASS) and name != "command":
            section = PAGES["classes"].partition(f"\n## {name}\n")[2].partition("\n## ")[0]
            shown = {member: f"\n| {member} |" in section or f"\n### {name}.{member}\n" in section for member in reference.by_name(node)}
            shown["__init__"] = re.search(rf"^{name}\(", section, re.MULTILINE) or "__init__" not in shown
            missing = [member for member, found in shown.items() if not found]
            assert not missing, (name, missing)


def test_signatures_of_the_binding_and_texts_of_other_types_do_not_get_into_the_text():
    text = "".join(PAGES.values()).replace("\\", "")
    assert "_palpate" not in text
    assert "Convert a number or string" not in text  # of int


def test_no_function_class_or_method_is_without_a_text():
    for page, text in PAGES.items():
        bare = re.findall(r"^(#+ \S+)\n+(?:```python\n[^`]*```\n+)?(?=#|\Z)", text, re.MULTILINE)
        assert not bare, (page, bare)
