"""Settings of the Python module: keywords, repr, pickling, one test for all of them."""

import copy
import pickle

import numpy
import pytest

import palpate

RECORDS = [kind for kind in vars(palpate).values() if isinstance(kind, type) and hasattr(kind, "_fields")]


def changed(kind):
    """An instance in which every number, bool and array differs."""
    made = kind()
    for name in kind._fields:
        value = getattr(made, name)
        if isinstance(value, (bool, int, float, numpy.ndarray)) or name == "rate":
            setattr(made, name, another(name, value))
    return made


def test_there_are_settings_to_test():
    assert len(RECORDS) > 12


@pytest.mark.parametrize("kind", RECORDS, ids=lambda kind: kind.__name__)
def test_settings_survive_pickling_and_copying_bit_for_bit(kind):
    made = changed(kind)
    assert made != kind()
    for again in (pickle.loads(pickle.dumps(made)), copy.copy(made)):
        assert again == made


@pytest.mark.parametrize("kind", RECORDS, ids=lambda kind: kind.__name__)
def test_settings_name_their_fields_in_repr_and_refuse_others(kind):
    assert all(f"{name}=" in repr(kind()) for name in kind._fields)
    with pytest.raises(TypeError, match="no argument colour_of_hat"):
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


@pytest.mark.parametrize("make", [
    lambda: palpate.command.Freeze(True), lambda: palpate.command.Isovalue(0.5), lambda: palpate.command.Lift(),
    lambda: palpate.command.UseTool(palpate.Tool.named("burr:3", 1.0)), lambda: palpate.command.UseTool(None),
    lambda: palpate.Fill((0, 0, 0), (1, 2, 3), 4.0), lambda: palpate.Stroke(palpate.Brush(), (0, 0, 0), (1, 1, 1)),
    lambda: palpate.ToolBody(palpate.Tool.named("rod:4", 1.0), 0.5, 2), lambda: palpate.Sweep(
        palpate.Brush(), palpate.ToolBody(palpate.Tool.named("rod:4", 1.0), 0.5, 2), (0, 0, 0), (1, 1, 1), end_orientation_xyzw=(0.6, 0, 0, 0.8)),
    lambda: palpate.RenderSetup(tool=palpate.Tool.named("burr:3", 1.0))], ids=lambda make: repr(make())[:24])
def test_commands_and_edits_are_values(make):
    one = make()
    assert one == make() and pickle.loads(pickle.dumps(one)) == one and copy.deepcopy(one) == one
    assert "object at" not in repr(one)


@pytest.mark.parametrize("change", [
    lambda r: setattr(r, "isovalue", -4.0), lambda r: setattr(r.force, "stiffness", 4.0),
    lambda r: setattr(r, "transform", palpate.DeviceTransform(translation=(0, 0, -3))),
    lambda r: setattr(r, "transform", palpate.DeviceTransform(scale=0.9))])
def test_a_change_of_a_renderer_raises_the_force_on_a_standing_hand_with_the_ramp(change):
    field = palpate.Field(palpate.Volume((20 - numpy.indices((40, 40, 40))[0]).astype("f4")))
    renderer, force = palpate.Renderer(field, 0.0), []
    for i in range(1400):
        if i == 1000:
            change(renderer)
        force.append(numpy.linalg.norm(renderer.render(i * 0.001, (20, 20, 22 - min(i, 250) * 0.01)).force))
    assert max(numpy.diff(force[990:])) <= 3.3 / 250 + 1e-9
    assert force[-1] > force[999] + 1


def test_values_that_differ_are_not_equal():
    assert palpate.command.Freeze(True) != palpate.command.Freeze(False) != palpate.command.Clutch(False)
    assert palpate.Fill((0, 0, 0), (1, 2, 3), 4.0) != palpate.Fill((0, 0, 0), (1, 2, 4), 4.0)
    assert palpate.Tool.named("burr:3", 1.0) != palpate.Tool.named("burr:2", 1.0)
    volume = palpate.scene("torus:16x16x16").volume
    put = palpate.Replace((1, 2, 3), volume)
    assert put == palpate.Replace((1, 2, 3), volume) and put.samples.array is not None
    assert repr(palpate.command.Freeze(True)) == "command.Freeze(on=True)"


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


def renderer(setup=None, **limits):
    scene = palpate.scene("sphere:40x40x40", "float32")
    return palpate.Renderer(palpate.Field(scene.volume), scene.isovalue,
                            setup or palpate.RenderSetup.offline(), palpate.DeviceLimits(**limits))


def owners():
    """An object of each class that can be set, with all that is optional."""
    made = {kind.__name__: kind for kind in RECORDS}
    layers = palpate.layers_named("ct-needle")
    setup = palpate.RenderSetup(
        penetrability=palpate.Penetrability(ranges=[(1, 2)]), layers=layers,
        friction=palpate.Friction(static_coefficient=0.5, dynamic_coefficient=0.1))
    made |= {"Layers": lambda: pickle.loads(pickle.dumps(layers)),
             "RenderSetup": lambda: copy.copy(setup),
             "Setup": lambda: palpate.Setup(render=copy.copy(setup)),
             "Renderer": lambda: renderer(palpate.RenderSetup(friction=copy.copy(setup.friction)))}
    return made


def settable(owner):
    return [name for name in dir(owner) if hasattr(getattr(type(owner), name, None), "__set__")
            and not name.startswith("_") and getattr(getattr(type(owner), name), "fset", True)]


def paths(owner):
    """How each attribute is reached: names and numbers of elements."""
    for name in settable(owner):
        yield (name,)
        value = getattr(owner, name)
        for number, part in enumerate(value if isinstance(value, list) else [value]):
            if hasattr(type(part), "_fields"):
                first = (name, number) if isinstance(value, list) else (name,)
                yield from (first + rest for rest in paths(part))


def at(owner, path):
    for step in path:
        owner = owner[step] if isinstance(step, int) else getattr(owner, step)
    return owner


NAMES = {"solid": "below", "interpolation": "linear", "method": "paper", "kind": "add", "tool": "sphere:2",
         "facing": "left", "type": "uint16", "status": "ready", "curves": {"drag": ([(0, 1)], [(0, 2)])},
         "properties": {"drag": 0.5}, "ranges": [(3, "50%")], "background": 3.0, "isovalue": 0.5,
         "minimum": 5.0, "clutch": 2, "deadman": 1, "step_budget": 77, "rate": 500.0, "device": "recorded:file.csv"}


def equal(one, other):
    return numpy.array_equal(one, other) if isinstance(one, numpy.ndarray) else one == other


def another(name, value):
    """A value of the attribute that differs, and that can be rendered."""
    if hasattr(type(value), "_fields"):
        made, first = copy.copy(value), value._fields[0]
        setattr(made, first, another(first, getattr(value, first)))
        return made
    if isinstance(value, bool):
        return not value
    if isinstance(value, numpy.ndarray):
        return (numpy.roll(value, 1, axis=0) if value.ndim == 2 or name.endswith("_xyzw")
                else value + 1)
    if isinstance(value, list) and name == "layers":
        return value[:-1]
    if isinstance(value, list) and name == "colour":
        return [0.5, 0.25, 0.125]
    if name in NAMES:
        return NAMES[name]
    if isinstance(value, str):
        return value + "x"
    if isinstance(value, int):
        return value + 1
    return 0.9 * value if value and numpy.isfinite(value) else 0.001 if value == 0 else 0.25


@pytest.mark.parametrize("name", owners())
def test_what_is_set_by_any_path_is_what_the_owner_has(name):
    make, tried = owners()[name], 0
    for path in paths(make()):
        owner = make()
        value = another(path[-1], at(owner, path))
        assert not equal(at(owner, path), value), path
        setattr(at(owner, path[:-1]), path[-1], value)
        for again in (owner, copy.copy(owner)):  # the copy is made of what C++ has
            assert equal(at(again, path), value), path
        tried += 1
    assert tried >= {"RenderSetup": 60, "Setup": 73, "Renderer": 25}.get(name, 2)


@pytest.mark.parametrize("name", owners())
def test_what_can_have_no_effect_cannot_be_changed(name):
    owner = owners()[name]()
    for path in paths(owner):
        value = at(owner, path)
        if isinstance(value, numpy.ndarray):
            with pytest.raises(ValueError, match="read-only"):
                value[0] = 1
        elif isinstance(value, (list, dict)):
            with pytest.raises(TypeError, match="assign a whole new"):
                value.clear()
            with pytest.raises(TypeError, match="assign a whole new"):
                value[0] = 1
        elif hasattr(type(value), "_fields"):
            with pytest.raises(AttributeError, match="there are"):
                value.colour_of_hat = 1


def test_settings_that_are_only_told_refuse_changes_and_their_copies_do_not():
    volume = palpate.scene("torus:16x16x16").volume
    for told in (volume.geometry, palpate.Field(volume).geometry, palpate.Samples(volume).geometry):
        with pytest.raises(AttributeError, match="geometry of a .* cannot be changed"):
            told.spacing = (2, 2, 2)
        own = copy.copy(told)
        own.spacing = (2, 2, 2)
        assert list(own.spacing) == [2, 2, 2] and list(volume.geometry.spacing) != [2, 2, 2]
    with pytest.raises(AttributeError, match="limits of a Renderer"):
        renderer().limits.maximum_force = 1
    run = palpate.Run(volume, palpate.Setup(isovalue="50%", real_time=False))
    with pytest.raises(AttributeError, match="device of a Run"):
        run.device.limits.maximum_force = 1


def deepest_force(renderer):
    scene_radius = 19.5
    ticks = [renderer.render(i / 1000, (0, 0, scene_radius - 0.01 * i)) for i in range(1, 1500)]
    return max(numpy.linalg.norm(tick.force) for tick in ticks)


def test_what_was_assigned_belongs_to_each_owner():
    mine = palpate.ForceSettings()
    one, other = palpate.RenderSetup(force=mine), palpate.RenderSetup()
    other.force = mine
    mine.limit = 0.5
    assert (one.limit, other.limit, copy.copy(one).limit) == (0.5, 0.5, 0.5)
    one.force = one.force  # nothing is lost
    mine.limit = 0.25
    assert (one.limit, other.limit) == (0.25, 0.25)
    one.force = palpate.ForceSettings()
    mine.limit = 1
    assert (one.limit, other.limit) == (None, 1)
    with pytest.raises(ValueError):
        mine.limit = -1
        renderer(one).force = mine


@pytest.mark.parametrize("kind, name, value, words", [
    ("Layers", "closing", -1, r"closing \[mm, physical\] = -1\.0: must be finite and above 0"),
    ("Layers", "closing", numpy.nan, "closing .* = nan: must be"),
    ("ForceSettings", "limit", -1, r"force limit \[N\] = -1\.0: must be finite and at least 0"),
    ("ForceSettings", "damping", numpy.inf, "damping .* = inf: must be"),
    ("Friction", "dynamic_coefficient", -0.1, r"dynamic friction = -0\.1: must be"),
    ("DeviceLimits", "maximum_force", 0, "maximum force .* = 0.0: must be finite and above 0"),
    ("DeviceTransform", "scale", 0, "scale = 0.0: must be"),
    ("Needle", "static_ratio", 0.5, "static ratio of the needle = 0.5: must be finite and at least 1"),
    ("Texture", "wavelength", 0, "texture wavelength"), ("Magnet", "distance", -1, "magnet distance")])
def test_a_number_out_of_range_is_refused_where_it_is_set_or_constructed(kind, name, value, words):
    with pytest.raises(ValueError, match=words):
        getattr(palpate, kind)(**{name: value})
    made = getattr(palpate, kind)()
    with pytest.raises(ValueError, match=words):
        setattr(made, name, value)
    assert made == getattr(palpate, kind)()


@pytest.mark.parametrize("name, usual, wrong", [
    ("clutch", None, ("Middle", 0, -1, 33)), ("deadman", None, ("Middle", 0, -1, 33))])
def test_a_button_is_a_number_or_none_at_all(name, usual, wrong):
    setup = palpate.Setup()
    assert getattr(setup, name) is usual
    for value in wrong:
        with pytest.raises(ValueError, match=f"^{name}: a button is a number from 1 to 32, none or auto"):
            setattr(setup, name, value)
    setattr(setup, name, 2)
    assert getattr(setup, name) == getattr(copy.copy(setup), name) == 2
    setattr(setup, name, "auto")
    assert getattr(setup, name) == {"clutch": None, "deadman": "auto"}[name]
    setattr(setup, name, "none")
    assert getattr(setup, name) == {"clutch": "none", "deadman": None}[name]


def test_layers_in_another_order_are_still_those_of_the_set():
    layers = palpate.layers_named("ct-needle")
    first = layers.layers[0]
    layers.layers = layers.layers[::-1]
    first.level = 123
    assert copy.copy(layers).layers[-1].level == 123


def test_a_limit_is_kept_wherever_it_is_set():
    assert deepest_force(renderer()) > 3
    setups = [palpate.RenderSetup.offline() for _ in range(3)]
    setups[0].force.limit = 0.5
    setups[1].limit = 0.5
    setups[2].force = palpate.ForceSettings(limit=0.5)
    live = palpate.Setup(render=palpate.RenderSetup.offline())
    live.render.force.limit = 0.5
    for setup in (*setups, live.render):
        assert 0.49 < deepest_force(renderer(setup)) <= 0.5 + 1e-12
        assert 3 < deepest_force(renderer(palpate.RenderSetup.offline(), maximum_force=8))
    ready = renderer()
    ready.force.limit = 0.5
    assert deepest_force(ready) <= 0.5 + 1e-12
    strong = palpate.DeviceLimits(maximum_force=8)
    assert palpate.Renderer(ready.field, 0.5, limits=strong).force.limit == 8


def test_what_a_renderer_cannot_render_is_refused_and_changes_nothing():
    ready = renderer()
    before = ready.force
    for name, value in (("limit", -1), ("stiffness", numpy.nan), ("damping", 9)):
        with pytest.raises(ValueError):
            setattr(ready.force, name, value)
    with pytest.raises(ValueError):
        ready.force.texture.wavelength = 0
    with pytest.raises(ValueError):
        ready.transform.scale = 0
    assert ready.force == before == renderer().force and ready.transform == renderer().transform
    ready.force.stiffness = 0.25
    assert copy.copy(ready).force.stiffness == 0.25


def test_levels_of_layers_and_friction_are_felt_as_they_were_set():
    volume = palpate.scene("sphere:40x40x40", "float32").volume  # 0 to 0.96
    field = palpate.Field(volume)
    setup = palpate.RenderSetup(layers=palpate.Layers(layers=[palpate.Layer(name="ball", level=0.3)]))
    outer = palpate.Renderer(field, 0.5, setup)
    setup.layers.layers[0].level = 0.6
    inner = palpate.Renderer(field, 0.5, setup)
    height = [abs(next(0.1 * i for i in range(300)
                       if r.render(i / 1000 + 1, (0, 0, 30 - 0.1 * i)).mode == "constrained"))
              for r in (outer, inner)]
    assert height[1] > height[0] + 0.5
    ready = renderer()
    ready.friction.static_coefficient = 0.5
    ready.friction.dynamic_coefficient = 0.4
    assert ready.friction == palpate.Friction(static_coefficient=0.5, dynamic_coefficient=0.4)
