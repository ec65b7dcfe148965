"""Settings of the Python module: keywords, repr, pickling, one test for all of them."""

import copy
import pickle

import numpy
import pytest

import palpate

RECORDS = [kind for kind in vars(palpate).values() if isinstance(kind, type) and hasattr(kind, "_fields")]


def same(a, b):
    if isinstance(a, numpy.ndarray):
        return numpy.array_equal(a, b)
    if hasattr(type(a), "_fields"):
        return all(same(getattr(a, name), getattr(b, name)) for name in type(a)._fields)
    if isinstance(a, (list, tuple)):
        return len(a) == len(b) and all(same(x, y) for x, y in zip(a, b))
    return a == b


def changed(kind):
    """An instance in which every number, bool and array differs."""
    made = kind()
    for name in kind._fields:
        value = getattr(made, name)
        if isinstance(value, bool):
            setattr(made, name, not value)
        elif isinstance(value, numpy.ndarray):
            setattr(made, name, value + 1)
        elif isinstance(value, (int, float)) and numpy.isfinite(value):
            setattr(made, name, type(value)(value + 1))
        elif value is None and name == "rate":
            setattr(made, name, 500.0)
    return made


def test_there_are_settings_to_test():
    assert len(RECORDS) > 12


@pytest.mark.parametrize("kind", RECORDS, ids=lambda kind: kind.__name__)
def test_settings_survive_pickling_and_copying_bit_for_bit(kind):
    made = changed(kind)
    assert not same(made, kind())
    for again in (pickle.loads(pickle.dumps(made)), copy.copy(made)):
        assert same(made, again)


@pytest.mark.parametrize("kind", RECORDS, ids=lambda kind: kind.__name__)
def test_settings_name_their_fields_in_repr_and_refuse_others(kind):
    assert all(f"{name}=" in repr(kind()) for name in kind._fields)
    with pytest.raises(TypeError, match="no field colour_of_hat"):
        kind(colour_of_hat=1)
    with pytest.raises(AttributeError):
        kind().colour_of_hat = 1


def test_tools_and_layers_survive_pickling():
    tool = palpate.Tool.named("burr:3", 1.0)
    again = pickle.loads(pickle.dumps(tool))
    assert numpy.array_equal(tool.points, again.points) and tool.gyration == again.gyration
    layers = palpate.layers_named("ct-needle")
    assert pickle.loads(pickle.dumps(layers)).text == layers.text
    setup = palpate.RenderSetup(tool=tool, layers=layers)
    assert numpy.array_equal(pickle.loads(pickle.dumps(setup)).tool.points, tool.points)


def test_names_that_there_are_not_are_refused_with_those_that_there_are():
    volume = palpate.scene("torus:16x16x16").volume
    with pytest.raises(ValueError, match="above, below"):
        palpate.Field(volume, solid="left")
    with pytest.raises(ValueError, match="linear, cubic"):
        palpate.Field(volume, interpolation="quartic")
    with pytest.raises(ValueError, match="sphere"):
        palpate.RenderSetup(tool="hammer")
    with pytest.raises(palpate.InputError):
        palpate.RenderSetup(layers="no-such-set")
