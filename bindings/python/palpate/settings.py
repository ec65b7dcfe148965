"""Completes the classes of settings: keywords, repr, pickling, equality, and nested settings that are
one with their owner: `setup.force.limit = 0.5` changes the setup.

What a class in C++ holds are values. A nested object in Python is a copy that its owner keeps, and
each change of it is handed to the owner, which may refuse it. What cannot be handed on refuses to be
changed: lists, dicts and arrays, and what a read-only property returns.
"""

import copy
import os
import re
import weakref

import numpy

from .arguments import signatures, unknown


def _refuse(self, *args, **keywords):
    raise TypeError("this is a copy, changing it would have no effect: assign a whole new "
                    f"{type(self).__name__}")


class _List(list):
    __setitem__ = __delitem__ = __iadd__ = __imul__ = append = clear = extend = insert = pop = _refuse
    remove = reverse = sort = _refuse

    def __reduce__(self):
        return list, (list(self),)


class _Dict(dict):
    __setitem__ = __delitem__ = __ior__ = clear = pop = popitem = setdefault = update = _refuse

    def __reduce__(self):
        return dict, (dict(self),)


_List.__name__, _Dict.__name__ = "list", "dict"


def _kept(value):
    """A value as a getter returns it."""
    if hasattr(type(value), "_fields"):
        return copy.copy(value)
    if isinstance(value, numpy.ndarray):
        value = value.copy()
        value.flags.writeable = False
    elif type(value) is list:
        value = _List(map(_kept, value))
    elif type(value) is tuple:
        value = tuple(map(_kept, value))
    elif type(value) is dict:
        value = _Dict((key, _kept(one)) for key, one in value.items())
    return value


def _settings_in(value):
    return [one for one in (value if isinstance(value, list) else [value])
            if hasattr(type(one), "_fields")]


def _frozen(value, why):
    for one in _settings_in(value):
        vars(one)["_frozen"] = why
        for name in one._fields:
            _frozen(getattr(one, name), why)
    return value


class _Nested:
    """A settable property whose value, where it is settings, belongs to its object."""

    def __init__(self, raw):
        self.raw, self.__doc__ = raw, raw.__doc__

    def __set_name__(self, kind, name):
        self.name = name

    def __get__(self, owner, kind=None):
        if owner is None:
            return self
        if self.name in vars(owner):
            return vars(owner)[self.name]
        value = _kept(self.raw.__get__(owner))
        self.adopt(owner, value)
        return value

    def __set__(self, owner, value):
        if "_frozen" in vars(owner):
            raise AttributeError(vars(owner)["_frozen"])
        if isinstance(value, os.PathLike):
            value = os.fspath(value)
        before = _kept(self.raw.__get__(owner))
        self.raw.__set__(owner, value)
        try:
            _hand_on(owner)
        except Exception:
            self.raw.__set__(owner, before)
            _hand_on(owner)
            raise
        vars(owner).pop(self.name, None)
        value = _List(value) if type(value) in (list, tuple) else value
        # Not where the owner has filled in what was left open.
        children = _settings_in(value)
        if children and not any("_frozen" in vars(child) for child in children) and (
                _same(value, self.raw.__get__(owner))):
            self.adopt(owner, value)

    def adopt(self, owner, value):
        """From now on the owner has each change of these settings."""
        children = _settings_in(value)
        for child in children:
            vars(child).setdefault("_owners", []).append((weakref.ref(owner), self))
        if children:
            vars(owner)[self.name] = value


def _hand_on(child):
    """To the owners of these settings, and on to theirs."""
    owners = vars(child).get("_owners", [])
    for link in list(owners):
        owner, nested = link[0](), link[1]
        held = owner is not None and vars(owner).get(nested.name)
        if held is child or isinstance(held, list) and any(one is child for one in held):
            nested.raw.__set__(owner, held)
            _hand_on(owner)
        else:  # it is another's now, or nobody's
            owners.remove(link)


def _set(self, name, value):
    if not isinstance(getattr(type(self), name, None), (_Nested, property)):
        settable = [name for name, one in vars(type(self)).items() if isinstance(one, _Nested)]
        raise AttributeError(f"{type(self).__name__} has no {name}; there are {', '.join(settable)}")
    object.__setattr__(self, name, value)


def _same(one, other):
    if isinstance(one, numpy.ndarray):
        return numpy.array_equal(one, other)
    if hasattr(one, "array") and hasattr(other, "array"):  # volumes
        return one.geometry == other.geometry and numpy.array_equal(one.array, other.array)
    return one == other


class _Parts:
    """Of a class whose objects are what they were made of, by keywords: `_parts` names these."""

    def __repr__(self):
        within = "command." if type(self).__module__.endswith(".command") else ""
        parts = ", ".join(f"{name}={getattr(self, name)!r}" for name in self._parts)
        return f"{within}{type(self).__name__}({parts})"

    def __eq__(self, other):
        if type(self) is not type(other):
            return NotImplemented
        return all(_same(getattr(self, name), getattr(other, name)) for name in self._parts)

    __hash__ = None

    def __reduce__(self):
        return _made, (type(self), {name: getattr(self, name) for name in self._parts})


def _made(kind, parts):
    return kind(**parts)


def _complete_parts(kind, parts):
    kind._parts = tuple(parts)
    for name in ("__repr__", "__eq__", "__hash__", "__reduce__"):
        if name != "__reduce__" or "__getstate__" not in vars(kind):
            setattr(kind, name, vars(_Parts)[name])


def _initializer(raw, kind, fields):
    def __init__(self, *unnamed, **given):
        if unnamed:
            raise TypeError(f"{kind}(): arguments have names here, as in {kind}({fields[0]}=...)")
        raw(self)
        for name in given:
            if name not in fields:
                raise TypeError(f"{kind}(): {unknown(name, fields)}")
        for name in fields:
            if name in given:
                setattr(self, name, given[name])
    return __init__


def _alias(kind, part, name):
    """A field that is another name of one in a part, which is of this kind."""
    def get(self):
        return getattr(getattr(self, part), name)

    get.__doc__ = vars(kind)[name].raw.fget.__doc__
    return property(get, lambda self, value: setattr(getattr(self, part), name, value),
                    doc=f"The same as {part}.{name}.")


def _frozen_getter(raw, why):
    def get(self):
        return _frozen(_kept(raw.__get__(self)), why)

    get.__doc__ = raw.fget.__doc__
    return property(get, doc=raw.__doc__)


def complete(module):
    kinds = [kind for kind in vars(module).values() if isinstance(kind, type)]
    names = "|".join(kind.__name__ for kind in kinds if hasattr(kind, "_fields"))
    returns_settings = re.compile(rf"-> .*\b(?:{names})\b")
    for kind in kinds:
        for name, raw in list(vars(kind).items()):
            if not isinstance(raw, property):
                continue
            if raw.fset:
                nested = _Nested(raw)
                nested.__set_name__(kind, name)
                setattr(kind, name, nested)
                kind.__setattr__ = _set
            elif returns_settings.search(raw.fget.__doc__ or ""):
                why = (f"{name} of a {kind.__name__} cannot be changed: change a copy of it, by "
                       "copy.copy()")
                setattr(kind, name, _frozen_getter(raw, why))
        if hasattr(kind, "_fields"):
            _complete_parts(kind, kind._fields)
            kind.__init__ = _initializer(kind.__init__, kind.__name__, kind._fields)
    commands = [kind for name, kind in vars(module.command).items() if isinstance(kind, type) and name != "UseLayers"]
    for kind in (module.Stroke, module.Sweep, module.ToolBody, module.Fill, module.Replace, *commands):
        _complete_parts(kind, [one.name for one in signatures(kind.__init__)[0]])
    for name in ("limit", "stiffness"):
        setattr(module.RenderSetup, name, _alias(module.ForceSettings, "force", name))
