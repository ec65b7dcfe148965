"""Wrong arguments: every constructor, function, method and setter names the wrong one and the expected
type, in one line."""

import inspect
import pathlib
import pickle
import subprocess
import sys

import numpy
import palpate
import pytest
from palpate import arguments


class Wrong:
    """Fits nothing."""


def wrapped(owner, title):
    """(title, function with the signature, what calls it) of all that the module binds there."""
    for name, one in list(vars(owner).items()):
        if inspect.ismodule(one):
            yield from wrapped(one, f"{title}{name}.")
        elif isinstance(one, type) and one.__module__.startswith("palpate._palpate"):
            yield from wrapped(one, f"{title}{one.__name__}.")
        elif isinstance(one, staticmethod) or inspect.isfunction(one):
            function = one.__func__ if isinstance(one, staticmethod) else one
            if hasattr(function, "__wrapped__"):
                yield f"{title}{name}", owner, function, isinstance(one, staticmethod)


ALL = list(wrapped(palpate._palpate, ""))
ACCEPTS_ALL = ("object", "function", "handle", "args", "kwargs")


def complaint(call):
    with pytest.raises((TypeError, ValueError)) as raised:
        call()
    return str(raised.value)


@pytest.mark.parametrize("title, owner, function, is_static", ALL, ids=[one[0] for one in ALL])
def test_a_wrong_argument_is_named_in_one_line(title, owner, function, is_static):
    is_method = isinstance(owner, type) and not is_static
    for parameters in arguments.signatures(function.__wrapped__):
        checked = [one for one in parameters if one.type not in ACCEPTS_ALL]
        required = [one for one in parameters if one.required]
        for one in checked:
            if one in required and one is not required[0]:
                continue  # the first one is named
            given = {other.name: Wrong() for other in {*required, one} if not other.name.startswith("arg")}
            if one.name.startswith("arg") or (required and not one.required and required[0] in checked):
                continue
            made = owner.__new__(owner) if title.endswith("__init__") else Wrong()
            self = [made] if is_method else []
            text = complaint(lambda: function(*self, **given))
            assert "\n" not in text and len(text) < 400, text
            assert one.name in text and " must be " in text and "Wrong" in text, text


def test_the_walk_sees_the_whole_module():
    titles = {one[0] for one in ALL}
    assert {"load", "extract", "Volume.__init__", "Field.value", "command.Isovalue.__init__"} <= titles
    assert len(titles) > 100


SETTERS = [(kind, name) for kind in vars(palpate).values()
           if isinstance(kind, type) and hasattr(kind, "_fields") for name in kind._fields]


@pytest.mark.parametrize("kind, name", SETTERS, ids=[f"{k.__name__}.{n}" for k, n in SETTERS])
def test_a_wrong_value_of_a_setting_is_named_in_one_line(kind, name):
    text = complaint(lambda: setattr(kind(), name, Wrong()))
    assert "\n" not in text and len(text) < 400, text
    assert name in text and " must be " in text and text.endswith(", not Wrong"), text
    text = complaint(lambda: kind(**{name: Wrong()}))
    assert name in text and "\n" not in text


@pytest.mark.parametrize("kind, name", SETTERS, ids=[f"{k.__name__}.{n}" for k, n in SETTERS])
def test_none_is_a_value_of_a_setting_or_refused_in_one_line(kind, name):
    try:
        setattr(kind(), name, None)
    except (TypeError, ValueError) as refused:
        text = str(refused)
        assert name in text and " must be " in text and text.endswith(", not None"), text


def volume():
    return palpate.Volume(numpy.zeros((2, 2, 2), "f4"))


@pytest.mark.parametrize("call, text", [
    (lambda: palpate.Volume(numpy.zeros((2, 2, 2), "f4"), spacing=2),
     "Volume(): spacing must be 3 numbers or None, not 2"),
    (lambda: palpate.Volume([1]), "Volume(): array must be an array, not list"),
    (lambda: palpate.RenderSetup(penetrability="threshold"),
     "RenderSetup.penetrability must be Penetrability or None, not 'threshold'"),
    (lambda: setattr(palpate.RenderSetup(), "friction", 0.5), "RenderSetup.friction must be Friction or None, not 0.5"),
    (lambda: palpate.Field(3), "Field(): volume must be Volume or samples must be Samples, not 3"),
    (lambda: palpate.Field(palpate.LoadedVolume(volume())),
     "Field(): volume must be Volume or samples must be Samples, not LoadedVolume: give its .volume"),
    (lambda: palpate.smoothed(palpate.scene("sphere:8x8x8")),
     "smoothed(): volume must be Volume, not Scene: give its .volume"),
    (lambda: palpate.Field(volume(), soild="above"),
     "Field(): there is no argument soild (did you mean solid?); there are: volume, solid, background, "
     "interpolation"),
    (lambda: palpate.Field(), "Field(): volume is missing: Volume"),
    (lambda: palpate.extract(palpate.Field(volume()), None),
     "extract(): isovalue must be a number or text, not None"),
    (lambda: palpate.extract(palpate.Field(volume()), 1, 2),
     "extract(): 3 arguments are too many; there are: field, isovalue, tolerance, normals, progress"),
    (lambda: palpate.ForceSettings(limit="x"), "ForceSettings.limit must be a number or None, not 'x'"),
    (lambda: palpate.Friction(1, 2),
     "Friction(): arguments have names here, as in Friction(static_coefficient=...)"),
    (lambda: palpate.replay(3, 1, [0.0], [[0, 0, 0]]), "replay(): field must be Field, not 3"),
    (lambda: palpate.replay(palpate.Field(volume()), 1, [[0, 0, 0]], [0.0]),
     "time: an array of shape (n,) is needed, not (1, 3)"),
    (lambda: palpate.Tool.named("box:1", 1), "the tool 'box:1': 3 lengths above 0 and below 1e6 [mm] must follow a colon, "
     "as in box:2,2,2"),
    (lambda: palpate.read_trace(3), "read_trace(): path must be a path, not 3"),
    (lambda: palpate.Run(3), "Run(): loaded must be LoadedVolume or Volume or Store or Run, not 3"),
    (lambda: palpate.load("a\0b"), "load(): source must be a path, not 'a\\x00b'"),
    (lambda: palpate.read_trace(pathlib.Path("a\0b")), "read_trace(): path must be a path, not PosixPath"),
    (lambda: palpate.Layer(colour="red"), "Layer.colour must be a list of 3, each a number, not 'red'"),
    (lambda: palpate.Layer(colour=(1, 0)), "Layer.colour must be a list of 3, each a number, not (1, 0)"),
    (lambda: palpate.Snapshot(), "Snapshot() cannot be called: functions of palpate return one"),
    (lambda: palpate.Field(volume(), solid="abve"),
     "there is no solid side 'abve': use one of above, below (did you mean above?)"),
])
def test_messages_say_what_to_write(call, text):
    assert complaint(call) == text


@pytest.mark.parametrize("call", [
    lambda: palpate.Setup(isovalue="\ud800"), lambda: palpate.Setup(solid="\ud800"),
    lambda: palpate.extract(palpate.Field(volume()), "\ud800"), lambda: palpate.Brush(kind="\ud800")])
def test_text_that_has_no_utf_8_is_a_value_error_in_one_line(call):
    with pytest.raises(ValueError, match="^[^\n]*surrogates not allowed$"):
        call()


def test_a_number_that_c_does_not_hold_is_named():
    volume = palpate.scene("sphere:8x8x8").volume
    field = palpate.Field(volume)
    for call, name in ((lambda: palpate.smoothed(volume, 2**70), "passes"), (lambda: palpate.smoothed(volume, passes=-2**70), "passes"),
                       (lambda: palpate.Renderer(field, 2**2000), "isovalue"), (lambda: palpate.extract(field, -2**2000), "isovalue"),
                       (lambda: palpate.explore(field, 100, seed=-1), "seed")):
        assert f"(): {name} = " in complaint(call) and "is out of range" in complaint(call)


CLASSES = [kind for within in (palpate, palpate.command) for kind in vars(within).values()
           if isinstance(kind, type) and kind.__module__.startswith("palpate") and "__new__" not in vars(kind)
           and type(kind).__name__ == "pybind11_type"]


@pytest.mark.parametrize("kind", CLASSES, ids=lambda kind: kind.__name__)
def test_an_object_that_was_not_made_is_refused_wherever_it_is_used(kind):
    unmade = kind.__new__(kind)
    for name in dir(kind):
        if not name.startswith("_") and isinstance(getattr(kind, name), property):
            with pytest.raises((TypeError, RuntimeError), match="^[^\n]*$"):
                getattr(unmade, name)
    if kind is palpate.Volume:
        with pytest.raises(TypeError, match="this object was not made"):
            palpate.Field(unmade)


@pytest.mark.parametrize("protocol", range(pickle.HIGHEST_PROTOCOL + 1))
def test_every_protocol_of_pickle_gives_the_same_or_is_refused(protocol):
    volume = palpate.scene("sphere:8x8x8").volume
    for one in (palpate.Friction(static_coefficient=0.5), palpate.command.Freeze(True), palpate.Fill((0, 0, 0), (1, 1, 1), 3),
                palpate.Tool.named("burr:3", 1.0), volume.geometry):
        assert pickle.loads(pickle.dumps(one, protocol)) == one
    assert numpy.array_equal(pickle.loads(pickle.dumps(palpate.Field(volume), protocol)).volume.array, volume.array)
    for one in (palpate.Renderer(palpate.Field(volume), 100), palpate.Run(volume, palpate.Setup(real_time=False)), palpate.Editor(volume)):
        with pytest.raises(TypeError, match="cannot pickle"):
            pickle.dumps(one, protocol)


def test_an_error_inside_a_callback_stays_as_it_is():
    def progress(fraction):
        raise TypeError("mine,\nin two lines")
    with pytest.raises(TypeError, match="mine,\nin two lines"):
        palpate.extract(palpate.Field(palpate.scene("sphere").volume), 1, progress=progress)


@pytest.mark.parametrize("again", ["importlib.reload(palpate)", """
for name in [name for name in sys.modules if name.startswith("palpate")]:
    del sys.modules[name]
import palpate"""], ids=["reload", "import"])
def test_the_package_may_be_loaded_again(again):
    program = f"""import importlib, sys, numpy, palpate
{again}
volume = palpate.Volume(numpy.ones((2, 2, 2), "u1"))
setup = palpate.RenderSetup(stiffness=0.25)
assert palpate.Field(volume).geometry == volume.geometry and setup.force.stiffness == 0.25
try:
    palpate.Volume(3)
except TypeError as error:
    print(error)
try:
    palpate.load("nothing.nrrd")
except palpate.InputError:
    print("refused")
"""
    ran = subprocess.run([sys.executable, "-B", "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    assert ran.stdout == "Volume(): array must be an array, not 3\nrefused\n", ran.stderr
