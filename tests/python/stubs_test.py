"""The type stubs agree with the module: every name, every member, every parameter."""

import ast
import inspect
import pathlib
import re

import palpate

STUB = pathlib.Path(palpate.__file__).with_name("__init__.pyi")
TREE = ast.parse(STUB.read_text(encoding="utf-8"))


def stub_names(body):
    """Name to node, of what is public; overloads are one name."""
    names = {}
    for node in body:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            names.setdefault(node.name, []).append(node)
        elif isinstance(node, ast.AnnAssign):
            names.setdefault(node.target.id, []).append(node)
    return names


def parameters_of_stub(node):
    a = node.args
    return [p.arg for p in (*a.posonlyargs, *a.args, *a.kwonlyargs) if p.arg != "self"]


def parameters_of(function):
    """A list for each overload; None where they cannot be known."""
    try:
        names = [p.name for p in inspect.signature(function).parameters.values()
                 if p.kind is not p.VAR_KEYWORD]
        return [[name for name in names if name != "self"]]
    except (ValueError, TypeError):
        pass
    found = re.findall(r"^(?:\d+\. )?\w+\((.*)\) -> ", function.__doc__ or "", re.MULTILINE)
    lists = []
    for text in found:
        text = re.sub(r"\[[^\[\]]*(\[[^\[\]]*\])*[^\[\]]*\]", "", text)  # no commas but our own
        names = re.findall(r"(?:^|, )(\w+):", re.sub(r"= ?<[^>]*>", "", text))
        lists.append([name for name in names if name != "self"])
    return lists or None


def public(names):
    return {name for name in names if not name.startswith("_")}


def members(kind):
    return {name: value for name, value in vars(kind).items() if not name.startswith("_")}


def test_the_stub_has_every_name_of_the_module_and_no_other():
    constants = {"__version__"}
    assert public(stub_names(TREE.body)) == set(palpate.__all__) - constants


def test_every_class_has_the_members_of_its_stub_and_no_other():
    wrong = []
    for name, nodes in stub_names(TREE.body).items():
        kind = getattr(palpate, name, None)
        if not isinstance(nodes[0], ast.ClassDef):
            continue
        if isinstance(kind, type) and issubclass(kind, Exception):
            continue
        told = public(stub_names(nodes[0].body))
        there = set(members(kind))
        if hasattr(kind, "__dataclass_fields__"):
            there |= set(kind.__dataclass_fields__)
        if told != there:
            wrong.append((name, sorted(told - there), sorted(there - told)))
    assert not wrong


def test_parameters_have_the_names_of_the_stub():
    wrong, compared = [], 0
    for owner, body in [(palpate, TREE.body)] + [
            (getattr(palpate, node.name), node.body) for node in TREE.body
            if isinstance(node, ast.ClassDef)]:
        for name, nodes in stub_names(body).items():
            function = getattr(owner, name, None)
            if not isinstance(nodes[0], ast.FunctionDef) or not callable(function):
                continue
            if name == "__init__" and hasattr(owner, "_fields"):
                there = [list(owner._fields)]
            else:
                there = parameters_of(function)
            told = [parameters_of_stub(node) for node in nodes]
            compared += 1
            if there is None or sorted(there) != sorted(told):
                wrong.append((getattr(owner, "__name__", ""), name, told, there))
    assert compared > 60
    assert not wrong


def test_what_is_public_has_a_docstring():
    silent = [name for name in palpate.__all__
              if callable(getattr(palpate, name)) and not (getattr(palpate, name).__doc__ or "").strip()]
    assert not silent
