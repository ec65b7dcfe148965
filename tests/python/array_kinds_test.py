"""Every function that takes an array takes any kind of array with the same numbers, and gives the same result."""

import pickle

import numpy
import palpate
import pytest

BALL = palpate.scene("sphere:16x16x16")
LINEAR = palpate.Field(BALL.volume, interpolation="linear")
FIELD, LEVEL = palpate.Field(BALL.volume), BALL.isovalue
HIPS = numpy.array([[-9.0, 0, 0], [-4, 0, 0], [-3, 1, 0], [-2, 1, 1]])
TURNS = numpy.tile([0.0, 0, 0.6, 0.8], (4, 1))
TIMES = numpy.arange(4) / 1000
TOOL = palpate.Tool.named("sphere:1", 1.0)
BODY = palpate.ToolBody(TOOL, 0.5, 2)
TRIANGLES = numpy.array([[0, 1, 2], [1, 2, 3]], "uint32")


class Interface:
    """Has NumPy's older protocol alone."""

    def __init__(self, array):
        self.kept, self.__array_interface__ = array, array.__array_interface__


class Converted:
    def __init__(self, array):
        self.kept = array

    def __array__(self, dtype=None, copy=None):
        return self.kept if dtype is None else self.kept.astype(dtype)


class Shared:
    """Has DLPack alone, as the arrays of other libraries may."""

    def __init__(self, array):
        self.kept = array

    def __dlpack__(self, **keywords):
        return self.kept.__dlpack__(**keywords)

    def __dlpack_device__(self):
        return self.kept.__dlpack_device__()


def read_only(array):
    array = array.copy()
    array.flags.writeable = False
    return array


def backwards(array):
    return numpy.ascontiguousarray(array[(slice(None, None, -1),) * array.ndim])[(slice(None, None, -1),) * array.ndim]


def sparse(array):
    wide = numpy.repeat(array, 2, axis=0)
    wide[1::2] = 7
    return wide[::2]


KINDS = {"Fortran": numpy.asfortranarray, "backwards": backwards, "sparse": sparse, "read-only": read_only,
         "big-endian": lambda array: array.astype(array.dtype.newbyteorder(">")), "memoryview": lambda array: memoryview(array.copy()),
         "interface": Interface, "__array__": Converted, "DLPack": Shared, "list": lambda array: array.tolist(),
         "wider": lambda array: array.astype("longdouble" if array.dtype.kind == "f" else "int64")}


def trace_of(table):
    return [getattr(table, name).tobytes() for name in ("scp", "density", "constrained", "tetrahedra")]


def without_times(table):
    return {name: value.tobytes() for name, value in table.items() if isinstance(value, numpy.ndarray)}


def followed(to):
    renderer = palpate.Renderer(FIELD, LEVEL)
    return without_times(renderer.follow(to(TIMES), to(HIPS), pointing=to(HIPS)))


CALLS = {
    "Field.value": lambda to: FIELD.value(to(HIPS)).tobytes(),
    "Field.gradient": lambda to: FIELD.gradient(to(HIPS)).tobytes(),
    "Field.cast_ray": lambda to: numpy.array(FIELD.cast_ray(LEVEL, to(HIPS[0]), to(-HIPS[0]))).tobytes(),
    "cast_rays": lambda to: [one.tobytes() for one in palpate.cast_rays(FIELD, LEVEL, to(HIPS), to(-HIPS))],
    "ray_ns": lambda to: palpate.ray_ns(FIELD, LEVEL, to(HIPS), to(-HIPS)) > 0,
    "Scene.exact": lambda to: BALL.exact(to(HIPS)).tobytes(),
    "Mesh": lambda to: (palpate.Mesh(to(HIPS), to(TRIANGLES)).vertices.tobytes(), palpate.Mesh(to(HIPS), to(TRIANGLES)).triangles.tobytes()),
    "Tool": lambda to: palpate.Tool(to(HIPS)).points.tobytes(),
    "replay": lambda to: palpate.replay(FIELD, LEVEL, to(TIMES), to(HIPS), orientation_xyzw=to(TURNS), tool=TOOL).force.tobytes(),
    "Renderer.follow": followed,
    "Renderer.render": lambda to: palpate.Renderer(FIELD, LEVEL).render(0, to(HIPS[0]), orientation_xyzw=to(TURNS[0])).scp.tobytes(),
    "Renderer.batch_ns": lambda to: palpate.Renderer(FIELD, LEVEL).batch_ns(to(TIMES), to(HIPS), 2).shape,
    "Proxy": lambda to: trace_of(palpate.Proxy(LINEAR, LEVEL, to(HIPS[0])).follow(to(HIPS))),
    "follow_each": lambda to: trace_of(palpate.follow_each(LINEAR, LEVEL, to(HIPS), to(numpy.array([0, 2])))),
    "follow_levels": lambda to: trace_of(palpate.follow_levels(LINEAR, to(HIPS), to(numpy.array([0, 2])), to(TIMES + LEVEL))["trace"]),
    "update_times": lambda to: palpate.update_times(LINEAR, LEVEL, to(HIPS), to(numpy.array([0, 2]))).shape,
    "follow_tool": lambda to: without_times(palpate.follow_tool(FIELD, LEVEL, TOOL, to(HIPS), to(TURNS))),
    "Geometry": lambda to: repr(palpate.Geometry(size=to(numpy.array([3, 4, 5])), spacing=to(HIPS[3] ** 2), direction=to(numpy.eye(3)[::-1]))),
    "Stroke": lambda to: repr(palpate.Stroke(palpate.Brush(), to(HIPS[0]), to(HIPS[1]))),
    "Sweep": lambda to: repr(palpate.Sweep(palpate.Brush(), BODY, to(HIPS[0]), to(HIPS[1]), to(TURNS[0]), to(TURNS[0]))),
    "DeviceReading": lambda to: repr(palpate.DeviceReading(position=to(HIPS[1]), orientation_xyzw=to(TURNS[0]))),
    "DeviceTransform": lambda to: palpate.DeviceTransform(translation=to(HIPS[2])).physical(to(HIPS[1])).tobytes(),
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", CALLS)
def test_every_kind_of_array_has_the_same_result(name, kind):
    plain = CALLS[name](numpy.array)
    assert CALLS[name](KINDS[kind]) == plain


@pytest.mark.parametrize("type", ("uint8", "int16", "uint16", "float32"))
@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind not in ("list", "wider")])
def test_every_kind_of_array_becomes_the_same_volume(kind, type):
    samples = (numpy.arange(60).reshape(3, 4, 5) % 7).astype(type)
    given = KINDS[kind](samples)
    volume = palpate.as_volume(given, spacing=(1, 2, 3))
    assert volume.type == type and numpy.array_equal(volume.array, samples)
    if isinstance(given, numpy.ndarray):
        assert numpy.array_equal(palpate.Volume(given, copy=None).array, samples)
        if given.flags.c_contiguous and given.dtype.isnative:
            assert numpy.shares_memory(palpate.Volume(given).array, given)
        else:
            with pytest.raises(ValueError, match="copy=True"):
                palpate.Volume(given)
    else:
        with pytest.raises(TypeError, match="array must be an array, not"):
            palpate.Volume(given)


def same(one, other):
    for name in dir(type(one)):
        if not name.startswith("_") and isinstance(getattr(type(one), name), property):
            first, second = getattr(one, name), getattr(other, name)
            if isinstance(first, palpate.Volume):
                first, second = (first.geometry, first.array.tobytes()), (second.geometry, second.array.tobytes())
            if isinstance(first, dict):
                first, second = without_times(first), without_times(second)
            assert numpy.array_equal(first, second), name
    return True


def test_results_survive_pickling_bit_for_bit():
    renderer = palpate.Renderer(FIELD, LEVEL, palpate.RenderSetup(tool="sphere:1"))
    for time, hip, turn in zip(TIMES, HIPS, TURNS):
        tick = renderer.render(time, hip, orientation_xyzw=turn)
    assert tick.contacts > 0
    trace = palpate.Proxy(LINEAR, LEVEL, HIPS[0]).follow(HIPS, steps=True)
    scenes = [BALL, palpate.scene("noise", "int16", palpate.Geometry(size=(5, 6, 7), spacing=(1, 2, 3)))]
    for one in (tick, trace, palpate.follow_each(LINEAR, LEVEL, HIPS, [0]), *scenes):
        assert same(one, pickle.loads(pickle.dumps(one)))
    assert pickle.loads(pickle.dumps(BALL)).exact(HIPS).tobytes() == BALL.exact(HIPS).tobytes()
