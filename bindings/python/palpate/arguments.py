"""Errors about arguments in one line: "Volume(): spacing must be 3 numbers, not 2".

pybind11 lists all that a function accepts, and everything that it was called with. Here the first
argument that does not fit the function's signature is named instead.
"""

import difflib
import functools
import numbers
import os
import re
import types
from typing import SupportsIndex

import numpy

_MARK = re.compile(r"incompatible (function|constructor) arguments")
_STRICT = re.compile(r"\b(bool|int)\b")
_ARRAY = re.compile(r"numpy\.ndarray\[(?:numpy\.)?(\w+)(?:\[(.*)\])?\]")


def _split(text):
    """At commas outside of brackets and quotes."""
    parts, depth, quote, last = [], 0, "", 0
    for at, char in enumerate(text):
        if quote:
            quote = "" if char == quote else quote
        elif char in "'\"":
            quote = char
        else:
            depth += (char in "([{<") - (char in ")]}>")
            if char == "," and depth == 0:
                parts.append(text[last:at].strip())
                last = at + 1
    return [part for part in (*parts, text[last:].strip()) if part]


class _Parameter:
    def __init__(self, text, named_only):
        head, _, default = text.partition(" = ")
        self.name, _, self.type = head.partition(": ")
        self.required, self.named_only = not default, named_only

    def words(self):
        unnamed = re.fullmatch(r"arg(\d+)", self.name)
        return f"argument {int(unnamed[1]) + 1}" if unnamed else self.name


def signatures(function):
    """The parameters of each overload, without self."""
    found = []
    for text in re.findall(r"^(?:\d+\. )?\w*\((.*?)\)(?: -> [^\n]*)?$", function.__doc__ or "",
                           re.MULTILINE | re.DOTALL):
        parameters, named_only = [], False
        for part in _split(text):
            if part == "*":
                named_only = True
            elif not part.startswith(("self:", "*args", "**kwargs")):
                parameters.append(_Parameter(part, named_only))
        if text != "*args, **kwargs":
            found.append(parameters)
    return found


def _inside(kind):
    return _split(kind[kind.index("[") + 1:-1])


def _items(kind):
    """Of a list: the kind of its items, and how many it has, or None."""
    kind, count = re.fullmatch(r"(.*?)(?:\[(\d+)\])?", _inside(kind)[0]).groups()
    return kind, count and int(count)


def _holds(dtype, numbers):
    """Whether an argument of this type takes these numbers (bindings/python/numbers.hpp)."""
    if not dtype.startswith(("int", "uint")):
        return numbers.dtype.kind in "biuf"
    limits = numpy.iinfo(dtype)
    return numbers.dtype.kind in "iuf" and bool(numpy.all(
        (numbers >= limits.min) & (numbers <= limits.max) & (numbers == numpy.trunc(numbers))))


def _fits(value, kind):
    if kind.startswith("Optional["):
        return value is None or _fits(value, _inside(kind)[0])
    if kind.startswith("Union["):
        return any(_fits(value, one) for one in _inside(kind))
    if kind.startswith(("List[", "Sequence[")):
        inside, count = _items(kind)
        return (isinstance(value, (list, tuple, numpy.ndarray)) and count in (None, len(value))
                and all(_fits(one, inside) for one in value))
    if kind.startswith("Tuple["):
        kinds = _inside(kind)
        return (isinstance(value, (list, tuple)) and len(value) == len(kinds)
                and all(map(_fits, value, kinds)))
    if array := _ARRAY.fullmatch(kind):
        try:
            got = numpy.asarray(value)
        except (TypeError, ValueError):
            return False
        if not _holds(array[1], got):
            return False
        shape = [side.strip() for side in (array[2] or "").split(",") if side.strip()]
        shape = shape[:1] if shape[1:] == ["1"] else shape
        return not shape or (len(shape) == got.ndim and all(
            not side.isdigit() or int(side) == size for side, size in zip(shape, got.shape)))
    plain = {"numpy.ndarray": numpy.ndarray, "str": str, "bool": (bool, numpy.bool_), "float": numbers.Real,
             "int": SupportsIndex, "None": type(None), "dict": dict, "list": list, "tuple": tuple}
    if kind == "os.PathLike":
        return isinstance(value, (str, bytes, os.PathLike)) and "\0" not in os.fsdecode(value)
    if kind in plain:
        return isinstance(value, plain[kind])
    if kind in ("function", "Callable") or kind.startswith("Callable["):
        return callable(value)
    if kind.startswith("palpate::"):  # unknown to Python
        return False
    if kind.startswith("palpate."):
        return kind.rpartition(".")[2] in (one.__name__ for one in type(value).__mro__)
    return True


def _expected(kind):
    if kind.startswith("Optional["):
        return f"{_expected(_inside(kind)[0])} or None"
    if kind.startswith("Union["):
        return " or ".join(_expected(one) for one in _inside(kind) if not one.startswith("palpate::"))
    if kind.startswith(("List[", "Sequence[")):
        inside, count = _items(kind)
        return f"a list{f' of {count}' if count else ''}, each {_expected(inside)}"
    if kind.startswith("Tuple["):
        return f"({', '.join(map(_expected, _inside(kind)))})"
    if kind.startswith("Dict["):
        key, value = map(_expected, _inside(kind))
        return f"a dict from {key} to {value}"
    if array := _ARRAY.fullmatch(kind):
        sides = [side.strip() for side in (array[2] or "").split(",") if side.strip()]
        numbers = {"i": "whole numbers", "u": "whole numbers from 0"}.get(array[1][0], "numbers")
        if not sides:
            return f"an array of {numbers}"
        if len(sides) == 1 or sides[1] == "1":
            return f"{sides[0]} {numbers}"
        return f"an array of shape ({', '.join(sides)})"
    return {"numpy.ndarray": "an array", "str": "text", "bool": "True or False", "float": "a number",
            "int": "a whole number", "os.PathLike": "a path", "function": "a function"}.get(
                kind, kind.rpartition(".")[2] if kind.startswith("palpate.") else kind)


def _given(value, kind=""):
    if isinstance(value, (str, int, float, type(None))):
        text = repr(value)
        return text if len(text) <= 40 else text[:37] + "..."
    if isinstance(value, tuple) and len(repr(value)) <= 40:
        return repr(value)
    shape = f" of shape {value.shape}" if isinstance(value, numpy.ndarray) else ""
    has_it = kind.endswith(".Volume") and hasattr(value, "volume")  # LoadedVolume, Scene
    return type(value).__name__ + shape + (": give its .volume" if has_it else "")


def unknown(name, names):
    """What to say about a name that is none of these."""
    near = difflib.get_close_matches(name, names, 1)
    return (f"there is no argument {name}" + (f" (did you mean {near[0]}?)" if near else "")
            + f"; there are: {', '.join(names) or 'none'}")


def _names(parameters):
    return ", ".join(one.words() for one in parameters) or "none"


def _flaw(parameters, args, keywords):
    """How far the arguments fit, and what is wrong then."""
    named = {one.name for one in parameters}
    positional = [one for one in parameters if not one.named_only]
    for name in keywords:
        if name not in named:
            return -1, unknown(name, [one.words() for one in parameters])
    if len(args) > len(positional):
        return -1, f"{len(args)} arguments are too many; there are: {_names(parameters)}"
    given = dict(zip((one.name for one in positional), args))
    for at, one in enumerate(parameters):
        if one.name in given and one.name in keywords:
            return at, f"{one.words()} is given twice"
        if one.name in given or one.name in keywords:
            value = given.get(one.name, keywords.get(one.name))
            if not _fits(value, one.type):
                return at, (one.words(), _expected(one.type), _given(value, one.type))
        elif one.required:
            return at, f"{one.words()} is missing: {_expected(one.type)}"
    return len(parameters), None


def _problem(function, args, keywords):
    flaws = [_flaw(parameters, args, keywords) for parameters in signatures(function)]
    furthest = max((at for at, flaw in flaws), default=-1)
    flaws = [flaw for at, flaw in flaws if at == furthest]
    wrong = [flaw for flaw in flaws if isinstance(flaw, tuple)]
    if wrong:
        expected = {}
        for name, what, _ in wrong:
            expected.setdefault(name, []).append(what)
        return (" or ".join(f"{name} must be {' or '.join(dict.fromkeys(kinds))}"
                            for name, kinds in expected.items()) + f", not {wrong[0][2]}")
    told = [flaw for flaw in flaws if flaw]
    if told:
        return told[0]
    for one, value in zip(signatures(function)[0], args):  # pybind11 has tried each as a number of C++
        keywords = {one.name: value, **keywords}
    for name, value in keywords.items():
        if isinstance(value, (int, numpy.integer)) and not 0 <= value < 2**31:
            return f"{name} = {_given(value)} is out of range"
    values = [*map(_given, args), *(f"{name}={_given(value)}" for name, value in keywords.items())]
    return f"it does not take ({', '.join(values)})"


def _strict(function):
    """(place, parameter) of those for which pybind11 takes too much: the truth of any object, and the whole
    part of any number."""
    overloads = signatures(function)
    return [(at, one) for at, one in enumerate(overloads[0]) if _STRICT.search(one.type)] if len(overloads) == 1 else []


def _told(function, name, is_method):
    """The function, with errors about its arguments in one line."""
    strict = _strict(function)

    @functools.wraps(function)
    def call(*args, **keywords):
        try:
            for at, one in strict:
                at += is_method
                if not (_fits(args[at], one.type) if at < len(args) else
                        one.name not in keywords or _fits(keywords[one.name], one.type)):
                    break
            else:
                return function(*args, **keywords)
        except TypeError as error:
            if not _MARK.search(str(error)):
                raise
        raise TypeError(f"{name}(): " + _problem(function, args[1:] if is_method else args, keywords))
    return call


def _told_setter(setter, name):
    strict = _strict(setter)

    @functools.wraps(setter)
    def change(self, value):
        try:
            if not strict or _fits(value, strict[0][1].type):
                return setter(self, value)
        except TypeError as error:
            if not _MARK.search(str(error)):
                raise
        kinds = dict.fromkeys(_expected(one[-1].type) for one in signatures(setter))
        raise TypeError(f"{name} must be {' or '.join(kinds)}, not {_given(value)}")
    return change


def _unmade(kind):
    def __init__(self, *args, **keywords):
        raise TypeError(f"{kind.__name__}() cannot be called: functions of palpate return one")
    return __init__


def _complete_class(kind):
    if isinstance(vars(kind).get("__init__"), types.FunctionType):
        return  # by an import before this one: classes of C++ stay when the package is reloaded
    if type(vars(kind).get("__init__")).__name__ != "instancemethod":
        kind.__init__ = _unmade(kind)
    # Protocols 0 and 1 of pickle would call a base class of pybind11, which ends the process.
    kind.__reduce_ex__ = lambda self, protocol: object.__reduce_ex__(self, max(2, protocol))
    for name, raw in list(vars(kind).items()):
        if name.startswith("_") and name != "__init__":
            continue
        title = kind.__name__ if name == "__init__" else f"{kind.__name__}.{name}"
        if isinstance(raw, property):
            if raw.fset:
                setattr(kind, name, property(raw.fget, _told_setter(raw.fset, title), doc=raw.__doc__))
        elif isinstance(raw, staticmethod):
            setattr(kind, name, staticmethod(_told(raw.__func__, title, False)))
        elif type(raw).__name__ == "instancemethod":
            setattr(kind, name, _told(raw.__func__, title, True))


def complete(module):
    for name, one in list(vars(module).items()):
        if isinstance(one, type):
            _complete_class(one)
        elif type(one).__name__ == "builtin_function_or_method":
            setattr(module, name, _told(one, name.lstrip("_"), False))
        elif type(one).__name__ == "module":
            complete(one)
