"""The type stubs agree with the module: every name, every member, every parameter."""

import ast
import inspect
import os
import pathlib
import re
import subprocess
import sys

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
        elif isinstance(node, ast.ImportFrom) and node.level:  # written in Python, with its types
            for alias in node.names:
                names.setdefault(alias.asname, []).append(node)
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
    found = re.findall(r"^(?:\d+\. )?\w+\((.*?)\) -> ", function.__doc__ or "", re.MULTILINE | re.DOTALL)
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
        if not isinstance(nodes[0], ast.ClassDef) or name.startswith("_"):
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
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_")]:
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


def test_the_stub_says_how_each_class_is_made():
    silent = [name for name, nodes in stub_names(TREE.body).items() if isinstance(nodes[0], ast.ClassDef)
              and "__init__(self" in (getattr(palpate, name, object).__init__.__doc__ or "")
              and "__init__" not in stub_names(nodes[0].body)]
    assert not silent


def blocks_of(page):
    """The Python of a page, in one program for each file that its blocks name, or for the page."""
    text = page.read_text(encoding="utf-8")
    return "\n".join(re.findall(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL))


RIGHT = '''import pathlib

import palpate

class Hand:
    def info(self) -> palpate.DeviceInfo:
        return palpate.DeviceInfo(name="hand")
    def read(self) -> palpate.DeviceReading:
        return palpate.DeviceReading()

head = palpate.load("head.nrrd")
left, store = palpate.Run(head, device=Hand()), palpate.Run(palpate.open_store("head.zarr"))
right = palpate.Run(left, palpate.Setup(device="simulated"))
hit = palpate.Field(head.volume).cast_ray(300, (0, 0, 0), (1, 0, 0))
if hit:
    point, normal = hit
head.volume, palpate.load(b"head.nrrd"), palpate.read_trace(pathlib.Path("trace.csv"))
names = [found["name"] for found in palpate.find_devices()]
time, position = palpate.motion("press", palpate.Field(head.volume), 300)
'''
# An error in each line but the first.
WRONG = '''import palpate
palpate.Volume(palpate)
force: str = palpate.ForceSettings().ramp
palpate.Run("head.nrrd")
palpate.Run(palpate.load("head.nrrd"), device="simulated")
point, normal = palpate.Field(palpate.load("head.nrrd").volume).cast_ray(300, (0, 0, 0), (1, 0, 0))
palpate.find_devices()[0].name
low: str = palpate.as_volume([[[1]]]).minimum
palpate.replay(palpate.load("head.nrrd"), 300, [0], [[0, 0, 0]])
'''


def test_examples_tutorials_and_documentation_pass_a_strict_type_check(tmp_path):
    source = pathlib.Path(os.environ["PALPATE_SOURCE"])
    programs = list((source / "examples/python").glob("*.py"))
    for page in (source / "docs/python.md", *(source / "docs/tutorials").glob("*.md")):
        if blocks_of(page):
            programs.append(tmp_path / f"{page.stem}_page.py")
            programs[-1].write_text(blocks_of(page), encoding="utf-8")
    assert len(programs) >= 6
    programs.append(tmp_path / "right.py")
    programs[-1].write_text(RIGHT)
    wrong = tmp_path / "wrong.py"
    wrong.write_text(WRONG)
    settings = tmp_path / "mypy.ini"
    settings.write_text("[mypy]\nstrict = True\nfollow_imports = silent\nignore_missing_imports = True\n"
                        "[mypy-distributed.*]\nfollow_imports = skip\n")  # it has few types
    ran = subprocess.run(
        [sys.executable, "-m", "mypy", "--config-file", settings, "--cache-dir", tmp_path / "cache",
         *programs, wrong],
        env={**os.environ, "MYPYPATH": str(STUB.parents[1])}, stdout=subprocess.PIPE, text=True)
    complaints = [line for line in ran.stdout.splitlines() if ": error:" in line]
    assert len([line for line in complaints if "wrong.py" in line]) == WRONG.count("\n") - 1, ran.stdout
    assert len(complaints) == WRONG.count("\n") - 1, ran.stdout


def test_what_is_public_has_a_docstring():
    silent = [name for name in palpate.__all__
              if callable(getattr(palpate, name)) and not (getattr(palpate, name).__doc__ or "").strip()]
    assert not silent
