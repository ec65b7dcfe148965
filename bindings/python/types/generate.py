"""Writes the module's types for editors and type checkers: a part written by hand, then the types of the compiled
part, from its docstrings.

usage: generate.py HEAD.pyi OUT.pyi  (with the package palpate in PYTHONPATH)
"""

import re
import sys
from pathlib import Path

import palpate
from palpate import _palpate
from palpate.arguments import _split

SPECIAL = ("__init__", "__enter__", "__exit__", "__array__")
BARE = {"list": "list[Any]", "dict": "dict[str, Any]", "tuple": "tuple[Any, ...]", "object": "Any",
        "function": "Callable[..., Any]", "Callable": "Callable[..., Any]"}


def type_of(text, given):
    """A type of pybind11's as Python's. given: the caller gives it, so it may be more general."""
    text = re.sub(r"(, )?palpate::[\w:]+", "", text)
    text = re.sub(r"palpate\._palpate\.", "", text)
    text = re.sub(r"(\w)\[\d+\]", r"\1", text)  # of a size that does not change
    text = re.sub(r"\b(list|dict|tuple|object|function|Callable)\b(?!\[)", lambda found: BARE[found[1]], text)
    text = text.replace("os.PathLike", "_Path" if given else "Path").replace("Union[str, Tool]", "Union[_Path, Tool]")
    array = re.compile(r"numpy\.ndarray(?:\[(?:numpy\.)?(\w+)(?:\[[^\]]*\])?\])?")
    text = array.sub(lambda found: "ArrayLike" if given else f"NDArray[numpy.{found[1]}]" if found[1] else "NDArray[Any]",
                     text).replace("numpy.bool]", "numpy.bool_]")
    for name, general in (("List", "Sequence"), ("Dict", "Mapping"), ("Tuple", "tuple")):
        text = re.sub(rf"\b{name}\[", (general if given else name.lower()) + "[", text)
    return text


def default_of(text):
    return text if re.fullmatch(r"-?[\d.e+-]+|True|False|None|'[^']*'", text) else "..."


def parameter_of(text):
    if text.startswith(("*args", "**")):
        return text.split(":")[0] + ": Any"
    name, _, rest = text.partition(": ")
    kind, _, default = rest.partition(" = ")
    kind = type_of(kind, given=True)
    if (name, kind) == ("device", "Any"):  # one that is written in Python
        kind = "Optional[_Device]" if default == "None" else "_Device"
    return f"{name}: {kind}" + (f" = {default_of(default)}" if default else "") if kind else name


def signatures_of(function):
    """Pairs of parameters and result, of each overload."""
    text = (getattr(function, "__doc__", None) or "").partition("Overloaded function.")
    found = re.findall(r"^(?:\d+\. )?\w*\((.*?)\) -> ([^\n]*)$", text[2] or text[0], re.MULTILINE | re.DOTALL)
    return [(_split(arguments), result) for arguments, result in found]


def function_lines(name, function, static):
    found = signatures_of(function)
    assert found, f"{name} has no signature in its docstring"
    for parameters, result in found:
        if parameters and re.match(r"(self|arg0)\b", parameters[0]) and not static:
            parameters = ["self", *map(parameter_of, parameters[1:])]
        else:
            parameters = list(map(parameter_of, parameters))
        returns = "Self" if name == "__enter__" else type_of(result, given=False)
        if len(found) > 1:
            yield "@overload"
        yield f"def {name}({', '.join(parameters)}) -> {returns}: ..."


def property_lines(name, made):
    raw = getattr(made, "raw", made)
    [(_, result)] = signatures_of(raw.fget)
    if raw.fset:
        array = "ndarray" in result
        return [f"{name}: {type_of(result, given=not array)}"]
    return ["@property", f"def {name}(self) -> {type_of(result, given=False)}: ..."]


def fields_lines(kind):
    """How a class of settings is made, and its fields."""
    usual, parameters = kind(), ["self", "*"]
    for name in kind._fields:
        made = vars(kind)[name]
        [(_, result)] = signatures_of(getattr(made, "raw", made).fget)
        parameters.append(f"{name}: {type_of(result, given=True)} = {default_of(repr(getattr(usual, name)))}")
    return ["_fields: ClassVar[tuple[str, ...]]", f"def __init__({', '.join(parameters)}) -> None: ..."]


def class_lines(kind):
    lines = fields_lines(kind) if hasattr(kind, "_fields") else []
    for name, value in vars(kind).items():
        if name.startswith("_") and (name not in SPECIAL or name == "__init__" and lines):
            continue
        if isinstance(value, property) or hasattr(value, "raw"):
            lines += property_lines(name, value)
        elif name != "__init__" or signatures_of(value):
            static = isinstance(value, staticmethod)
            lines += ["@staticmethod"] if static else []
            lines += function_lines(name, value.__func__ if static else value, static)
    return [f"class {kind.__name__}:", *("    " + line for line in lines or ["..."])]


def stub():
    names = [name for name in palpate.__all__ if getattr(_palpate, name, None) is getattr(palpate, name)]
    for name in names:
        value = getattr(palpate, name)
        if isinstance(value, type):
            yield from class_lines(value)
        elif callable(value):
            yield from function_lines(name, value, static=True)
    yield "_Samples = Samples"
    yield "class command:"
    for name, kind in vars(_palpate.command).items():
        if isinstance(kind, type):
            yield from ("    " + re.sub(r"\bSamples,", "_Samples,", line.replace(": command.", ": "))
                        for line in class_lines(kind))


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__.strip())
    head = Path(sys.argv[1]).read_text(encoding="utf-8")
    Path(sys.argv[2]).write_text(head + "\n" + "\n".join(stub()) + "\n", encoding="utf-8")
