"""Values that cannot be: every attribute and every number of a command or an edit refuses them at once, in one
line, and stays as it was. A new attribute has to be named below if it accepts more than the usual."""

import copy
import math

import numpy
import palpate
import pytest

NAN, INF = math.nan, math.inf
RECORDS = [kind for kind in vars(palpate).values() if isinstance(kind, type) and hasattr(kind, "_fields")]
FIELDS = [(kind, name) for kind in RECORDS for name in kind._fields]

# Groups of values, and what accepts them.
WRONG = {"nan": (NAN, numpy.float32(NAN), (NAN, 0, 0), [[NAN] * 3] * 3), "infinity": (INF,), "less": (-INF,),
         "negative": (-1, -1.5, numpy.float64(-2)), "zero": (0,), "huge": (1e300, 2**1000), "huge places": ((1e300,) * 3,),
         "negative places": ((-1, -1, -1),), "infinite places": ((INF, 0, 0), [[INF] * 3] * 3), "no axes": (numpy.zeros((3, 3)),),
         "text": ("x", b"x"), "no text": ("",), "other": (object(), [None], {"x": 1}, 1j, numpy.datetime64("now"), lambda: 0)}
POSITIVE = {"MotionSettings.rate_hz", "MotionSettings.speed_mm_s", "RenderSetup.tool_spacing", "RenderSetup.scale", "DeviceTransform.scale",
            "Texture.wavelength", "DeviceLimits.maximum_force", "DeviceLimits.physical_damping", "DeviceLimits.warming_time",
            "DeviceLimits.physical_rotational_damping", "Layers.closing", "Brush.radius", "HandBrush.radius"}
LIMITS = {"ForceSettings.rate_limit", "ForceSettings.stale_after", "ForceSettings.torque_rate_limit", "DeviceLimits.continuous_force",
          "HandBrush.rate", "Setup.fastest_hand", "Setup.overrun"}
FROM_ZERO = {"MotionSettings.duration_s", "MotionSettings.depth_mm", "DeviceInfo.stiffness", "RenderSetup.limit", "RenderSetup.stiffness",
             "DeviceLimits.maximum_torque", "DeviceLimits.delay", "Needle.lateral_stiffness", "Magnet.distance", "Magnet.peak",
             "Texture.amplitude", "Friction.static_coefficient", "Friction.dynamic_coefficient"} | {
             f"ForceSettings.{name}" for name in ("stiffness", "damping", "viscosity", "limit", "ramp", "rotational_stiffness",
                                                  "rotational_damping")}
FROM_ZERO_OR_INFINITE = {"Needle.stick_speed", "ForceSettings.torque_limit", "ForceSettings.start_below", "Penetrability.threshold"}
FINITE = {"DeviceReading.opening", "Brush.level", "Brush.value", "HandBrush.value", "Layer.level", "Setup.background"}
ANY = {"Setup.isovalue", "Penetrability.minimum", "DeviceReading.age"}
COUNTS = {"RawLayout.skip", "DeviceInfo.buttons", "DeviceReading.buttons", "Setup.memory_bytes", "MotionSettings.seed"}
PARTS = {"Layer.opacity", "Brush.hardness", "HandBrush.hardness"}
PLACES = {"DeviceTransform.translation", "Geometry.origin", "DeviceInfo.workspace_low", "DeviceInfo.workspace_high",
          "DeviceReading.position"}
TEXTS = {"Layer.name", "Layers.name", "Layers.units", "Layers.about", "DeviceInfo.name", "DeviceInfo.model"}
ACCEPTED = {
    "infinity": LIMITS | FROM_ZERO_OR_INFINITE | ANY, "less": ANY, "negative": FINITE | ANY | {"Setup.speed"},
    "zero": FINITE | ANY | FROM_ZERO | FROM_ZERO_OR_INFINITE | COUNTS | PARTS | {"Setup.speed"},
    "huge": (FINITE | ANY | FROM_ZERO | FROM_ZERO_OR_INFINITE | POSITIVE | LIMITS | {"Needle.static_ratio"})
            - {"RenderSetup.scale", "DeviceTransform.scale"},
    "huge places": PLACES - {"DeviceTransform.translation"}, "negative places": PLACES, "text": TEXTS, "no text": TEXTS}


FIELD = palpate.Field(palpate.scene("sphere:12x12x12", "float32").volume)
TOOL = palpate.Tool.named("sphere:1", 1.0)
BODY = palpate.ToolBody(TOOL, 0.5, 2)
NOTHING = numpy.empty((0, 3))


def refused(change):
    """What the refusal says; None: there was none."""
    try:
        change()
    except (ValueError, TypeError) as error:
        text = str(error)
        assert text and "\n" not in text and len(text) < 400, text
        return text
    return None


@pytest.mark.parametrize("kind, name", FIELDS, ids=[f"{kind.__name__}.{name}" for kind, name in FIELDS])
def test_a_value_that_cannot_be_is_refused_where_it_is_set(kind, name):
    full = f"{kind.__name__}.{name}"
    for group, values in WRONG.items():
        for value in values:
            made = kind()
            told = refused(lambda: setattr(made, name, value))
            assert (told is None) == (full in ACCEPTED.get(group, ())), (group, value, told)
            if told:
                assert made == kind()
                assert refused(lambda: kind(**{name: value}))


@pytest.mark.parametrize("name, value, good", [
    ("scale", 1e30, True), ("scale", 1e-30, True), ("scale", 1.1e30, False), ("scale", 1e300, False), ("scale", 5e-324, False),
    ("translation", (0, 1e60, 0), True), ("translation", (0, -1.1e60, 0), False), ("rotation", numpy.eye(3) + 1e-9, True),
    ("rotation", numpy.eye(3) + 1e-5, False), ("rotation", numpy.diag([1.0, 1, -1]), False)], ids=str)
def test_a_transform_that_cannot_be_rendered_is_refused_where_it_is_set(name, value, good):
    transform = palpate.DeviceTransform()
    assert (refused(lambda: setattr(transform, name, value)) is None) == good
    palpate.Renderer(FIELD, 0.5, transform=transform)


@pytest.mark.parametrize("kind, name", FIELDS, ids=[f"{kind.__name__}.{name}" for kind, name in FIELDS])
def test_what_is_true_or_whole_is_not_what_python_can_convert(kind, name):
    made = kind()
    usual = getattr(made, name)
    if isinstance(usual, bool):
        setattr(made, name, numpy.bool_(not usual))
        assert getattr(made, name) is not usual
        for value in (1, 0, None, "no", NAN, [1]):
            assert refused(lambda: setattr(made, name, value))
    elif type(usual) is int:
        setattr(made, name, numpy.int64(usual))
        for value in (1.5, 2.0, "1", numpy.float64(1)):
            assert refused(lambda: setattr(made, name, value))


@pytest.mark.parametrize("call", [
    lambda bad: palpate.command.Isovalue(bad), lambda bad: palpate.command.Scale(bad), lambda bad: palpate.command.Moment(bad),
    lambda bad: palpate.command.Speed(bad), lambda bad: palpate.Fill((0, 0, 0), (1, 1, 1), bad),
    lambda bad: palpate.Stroke(palpate.Brush(), (0, bad, 0), (0, 0, 0)), lambda bad: palpate.Stroke(palpate.Brush(), (0, 0, 0), (bad, 0, 0)),
    lambda bad: palpate.Sweep(palpate.Brush(), BODY, (0, bad, 0), (0, 0, 0)), lambda bad: palpate.ToolBody(TOOL, bad, 1),
    lambda bad: palpate.Sweep(palpate.Brush(), BODY, (0, 0, 0), (0, 0, 0), (bad, 0, 0, 1)),
    lambda bad: palpate.brush_for("carve", FIELD, bad, 1), lambda bad: palpate.brush_for("carve", FIELD, 0.5, bad),
    lambda bad: palpate.LoadedVolume(FIELD.volume, isovalue=bad), lambda bad: palpate.Samples(FIELD.volume).volume(bad),
    lambda bad: palpate.Mesh([[0, 0, bad], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]), lambda bad: palpate.extract(FIELD, bad),
    lambda bad: FIELD.cast_ray(bad, (0, 0, 9), (0, 0, 0)), lambda bad: palpate.cast_rays(FIELD, bad, [[0, 0, 9]], [[0, 0, 0]]),
    lambda bad: palpate.simulated_info("simulated", FIELD, bad, 1000), lambda bad: palpate.simulated_info("simulated", FIELD, 0.5, bad),
    lambda bad: palpate.explicit_surface(FIELD, bad, [[0, 0, 9]], [[0, 0, 0]]),
    lambda bad: palpate.explicit_surface(FIELD, 0.5, [[0, 0, bad]], [[0, 0, 0]]),
    lambda bad: palpate.Run(FIELD.volume, device_rate=bad), lambda bad: palpate.Renderer(FIELD, bad)])
def test_an_argument_that_is_no_number_is_refused_in_one_line(call):
    for bad in (NAN, "", 1j):
        assert refused(lambda: call(bad))


@pytest.mark.parametrize("call", [
    lambda flag: palpate.command.Freeze(flag), lambda flag: palpate.extract(FIELD, 0.5, normals=flag),
    lambda flag: palpate.Volume(FIELD.volume.array, copy=flag), lambda flag: palpate.Renderer(FIELD, 0.5).render(0, (0, 0, 0), valid=flag)])
def test_an_argument_that_is_true_or_false_takes_nothing_else(call):
    for flag in (1, "no", NAN, [0]):
        assert "must be True or False" in refused(lambda: call(flag))
    call(numpy.bool_(True))


def test_a_setup_that_was_refused_is_as_before_wherever_it_is_nested():
    setup = palpate.Setup()
    before = copy.copy(setup)
    for owner, name, value in ((setup.render, "scale", NAN), (setup.render.force, "limit", -1), (setup, "device", "lever"),
                               (setup, "speed", 1e4)):
        assert refused(lambda: setattr(owner, name, value))
    assert setup == before


@pytest.mark.parametrize("name, other", ((" a.nhdr", ".nrrd"), (" a.mhd", ".mha"), ("a\nb.nhdr", ".nrrd"), ("a\rb.mhd", ".mha"), ("a:b.nhdr", ".nrrd")))
def test_a_name_that_a_header_cannot_hold_is_refused_before_anything_is_written(tmp_path, name, other):
    volume = palpate.Volume(numpy.zeros((2, 2, 2), "u1"))
    with pytest.raises(palpate.OutputError, match=f"name it {other}"):
        palpate.write(volume, tmp_path / name)
    assert not list(tmp_path.iterdir())
    palpate.write(volume, (tmp_path / name).with_suffix(other))
    assert numpy.array_equal(palpate.load((tmp_path / name).with_suffix(other)).volume.array, volume.array)


@pytest.mark.parametrize("call", [
    lambda: palpate.explore(FIELD, 0.5, trajectories=1, trajectory_s=1e-3), lambda: palpate.ray_ns(FIELD, 0.5, NOTHING, NOTHING),
    lambda: palpate.closed_loop(palpate.Renderer(FIELD, 0.5), "simulated", seconds=5e-4)])
def test_less_than_one_tick_or_ray_is_refused(call):
    assert refused(call)
