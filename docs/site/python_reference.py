#!/usr/bin/env python3
"""Writes the reference of the Python module as pages of the site. Signatures come from its types (__init__.pyi) and
its sources, and the text from its docstrings.

usage: python_reference.py OUT  (with the package palpate in PYTHONPATH)
"""

import ast
import inspect
import re
import sys
from pathlib import Path

import palpate
from palpate.arguments import _split

WIDTH = 100
PACKAGE = Path(palpate.__file__).parent
MODULES = {"study": ("study",), "trials": ("Plan", "Trial", "session", "read", "next_trial", "staircase"),
           "thresholds": ("fit", "psychometric", "Observer"), "distributed": ("convert", "Converted"), "ros": ("Node", "Arm")}  # public parts of modules that are imported by name
# The lines that pybind11 puts before a docstring.
SIGNATURE = re.compile(r"^(?:\d+\. )?\w*\((?:.*?\) -> [^\n]*|\*args, \*\*kwargs\))$|^Overloaded function\.$", re.MULTILINE | re.DOTALL)
CLASS, ATTRIBUTE = ast.ClassDef, ast.AnnAssign


def words(docstring):
    """A docstring without signatures, as Markdown."""
    text = SIGNATURE.sub("", inspect.cleandoc(docstring or ""))
    text = re.sub(r"\n{3,}", "\n\n", text).strip().replace("``", "`")
    text = re.sub(r"`[^`\n]*`|[*_<|\\]", lambda mark: mark[0] if mark[0][0] == "`" else "\\" + mark[0], text)
    return re.sub(r"docs/([\w\\/]+)\.md", lambda page: "[{0}](../docs/{0}.md)".format(page[1].replace("\\", "")), text)


def named(path):
    """The public names of a file of Python: {name: nodes}. Overloads are several functions of one name."""
    return by_name(ast.parse(path.read_text(encoding="utf-8")))


def by_name(body):
    found = {}
    for node in body.body:
        name = node.target.id if isinstance(node, ATTRIBUTE) else getattr(node, "name", "_")
        if name == "__init__" or not name.startswith("_"):
            found.setdefault(name, []).append(node)
    return found


def doc_of(node, value):
    """The docstring of a name of the module, or else that of the source. The default of a field has none of its own."""
    if inspect.isroutine(value) or inspect.isclass(value) or isinstance(value, property) or hasattr(value, "raw"):
        return value.__doc__
    return ast.get_docstring(node) if hasattr(node, "body") else ""


def call(name, node):
    """How a function is called, with a line for each parameter if it does not fit into one."""
    parameters = [each for each in _split(ast.unparse(node.args)) if each != "self"]
    result = f" -> {ast.unparse(node.returns)}" if node.returns and node.name != "__init__" else ""
    line = f"{name}({', '.join(parameters)}){result}"
    return line if len(line) <= WIDTH else f"{name}(\n    " + ",\n    ".join(parameters) + f"){result}"


def function_lines(name, nodes, value, head):
    calls = "\n".join(call(name, node) for node in nodes)
    return [*([head, ""] if head else []), "```python", calls, "```", "", words(doc_of(nodes[0], value)), ""]


def is_attribute(node):
    return isinstance(node, ATTRIBUTE) or any(ast.unparse(each) == "property" for each in node.decorator_list)


def class_lines(name, nodes, value, head="##"):
    members = by_name(nodes[0])
    lines = [f"{head} {name}", "", words(doc_of(nodes[0], value)), ""]
    made, of = members.pop("__init__", None), vars(value) if value else {}
    if made:
        lines += function_lines(name, made, None if hasattr(value, "_fields") else of.get("__init__"), "")
    attributes = {each: found[0] for each, found in members.items() if is_attribute(found[0])}
    lines += ["| attribute | type | |", "|---|---|---|"] if attributes else []
    for each, node in attributes.items():
        kind = ast.unparse(node.annotation if isinstance(node, ATTRIBUTE) else node.returns)
        lines.append(f"| {each} | `{kind}` | {' '.join(words(doc_of(node, of.get(each))).split())} |")
    lines.append("")
    for each, found in members.items():
        if each not in attributes:
            lines += function_lines(each, found, of.get(each), f"{head}# {name}.{each}")
    return lines


def pages():
    """The pages: {name: text}."""
    nodes = {}
    for file in ("__init__.pyi", "arrays.py", "errors.py", "trace.py"):
        nodes |= {name: found for name, found in named(PACKAGE / file).items() if not isinstance(found[0], ATTRIBUTE)}
    functions, classes = ["# palpate: functions", ""], ["# palpate: classes", ""]
    for name in palpate.__all__:
        value = getattr(palpate, name)
        if isinstance(value, type):
            classes += class_lines(name, nodes[name], value)
        elif callable(value):
            functions += function_lines(name, nodes[name], value, f"## {name}")
    commands = ["# palpate.command", "", "Commands to a running session, for `Run.send()` and `Servo.send()`.", ""]
    for name, found in by_name(nodes["command"][0]).items():
        commands += class_lines(name, found, getattr(palpate.command, name))
    modules = ["# Further modules", "", "Import these modules by name, for example `import palpate.study`.", ""]
    for module, names in MODULES.items():
        path = PACKAGE / f"{module}.py"
        path = path if path.exists() else PACKAGE / module / "__init__.py"
        modules += [f"## palpate.{module}", "", words(ast.get_docstring(ast.parse(path.read_text(encoding="utf-8")))), ""]
        found = named(path)
        for name in names:
            lines = class_lines(name, found[name], None, "###") if isinstance(found[name][0], CLASS) else \
                function_lines(name, found[name], None, f"### {name}")
            modules += lines
    made = {"functions": functions, "classes": classes, "commands": commands, "modules": modules}
    index = ["# Python reference", "", words(palpate.__doc__), "", "[Python](../docs/python.md) explains how to use the module.", ""]
    for page, lines in made.items():
        index += [f"**[{lines[0][2:]}]({page}.md)**: " + ", ".join(line[3:] for line in lines if line.startswith("## ")), ""]
    return {page: re.sub(r"\n{3,}", "\n\n", "\n".join(lines)) + "\n" for page, lines in {"index": index, **made}.items()}


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__.strip().splitlines()[-1])
    out = Path(sys.argv[1])
    out.mkdir(parents=True, exist_ok=True)
    for page_name, page_text in pages().items():
        (out / f"{page_name}.md").write_text(page_text, encoding="utf-8")
