"""Warnings in Python are those of the command line, name the line of the caller, and can be errors. Arguments that cannot be meant
are refused."""

import os
import subprocess
import warnings

import numpy
import palpate
import pytest

SCENE = palpate.scene("sphere:16x16x16")  # its densities are 0 to 223
FIELD = palpate.Field(SCENE.volume)
TIMES, HIPS = numpy.arange(2) / 1000, numpy.array([[-20.0, 0, 0], [-19.0, 0, 0]])
HIGH = "nothing is solid, so there is nothing to touch"
CT = palpate.layers_named("ct-needle")


def warned(call):
    """The warning's text, which has to name this file."""
    with warnings.catch_warnings(record=True) as all_of_them:
        warnings.simplefilter("always")
        call()
    assert [one.filename for one in all_of_them] in ([], [__file__])
    return str(all_of_them[0].message) if all_of_them else ""


def run(**setup):
    return palpate.Run(palpate.load("synthetic:sphere:16x16x16"), palpate.Setup(real_time=False, **setup))


@pytest.mark.parametrize("call", [
    lambda level: palpate.replay(FIELD, level, TIMES, HIPS), lambda level: palpate.Renderer(FIELD, level),
    lambda level: palpate.extract(FIELD, level), lambda level: run(isovalue=level)])
def test_a_level_at_which_there_is_nothing_to_touch_is_warned_of(call):
    assert warned(lambda: call(100)) == ""
    assert warned(lambda: call(1000)).endswith(HIGH)
    assert warned(lambda: call(1000)).startswith("isovalue 1000 (data 0 to ")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(UserWarning):
            call(1000)


def test_the_warning_is_that_of_the_command_line(tmp_path):
    words = ["extract", "synthetic:sphere:16x16x16", "--isovalue", "1000", "-o", str(tmp_path / "s.ply")]
    told = subprocess.run([os.environ["PALPATE"], *words], capture_output=True, text=True, check=True).stderr
    text = warned(lambda: palpate.extract(FIELD, 1000))
    assert text and text in told


def test_a_level_that_is_not_felt_is_not_warned_of():
    ranges = palpate.RenderSetup(penetrability=palpate.Penetrability(ranges=[(50, 90)]))
    layers = palpate.RenderSetup(layers=palpate.Layers(layers=[palpate.Layer(name="a", level=90)]))
    for setup in (ranges, layers):
        assert warned(lambda: palpate.replay(FIELD, 1000, TIMES, HIPS, setup=setup)) == ""
        assert warned(lambda: palpate.Renderer(FIELD, 1000, setup)) == ""
        assert warned(lambda: run(render=setup)) == ""


def test_layers_in_other_units_are_warned_of():
    assert "the layers are in HU" in warned(lambda: run(render=palpate.RenderSetup(layers=CT)))


@pytest.mark.parametrize("other, refused", [(2.0, False), (1.0, True)])
def test_two_scales_are_refused(other, refused):
    setup, transform = palpate.RenderSetup(scale=2.0), palpate.DeviceTransform(scale=other)
    if refused:
        with pytest.raises(ValueError, match="scale does nothing: the transform has another one"):
            palpate.Renderer(FIELD, 100, setup, transform=transform)
    else:
        assert palpate.Renderer(FIELD, 100, setup, transform=transform).transform.scale == 2.0


@pytest.mark.parametrize("turn", [(0, 0, 0, 0), (0, 0, 0, 5), (float("nan"), 0, 0, 1)])
def test_a_renderer_refuses_an_orientation_that_is_none(turn):
    with pytest.raises(ValueError, match="orientation_xyzw must have length 1"):
        palpate.Renderer(FIELD, 100).render(0, HIPS[0], orientation_xyzw=turn)


def test_rays_from_nowhere_are_refused():
    for starts, ends in ((HIPS, numpy.full_like(HIPS, numpy.nan)), (numpy.full_like(HIPS, numpy.inf), HIPS)):
        for cast in (palpate.cast_rays, palpate.ray_ns):
            with pytest.raises(ValueError, match="the ends of a ray have to be finite"):
                cast(FIELD, 100, starts, ends)


def test_a_box_without_samples_is_refused():
    with pytest.raises(ValueError, match="high must not lie below low along any axis"):
        palpate.Fill((5, 5, 5), (9, 4, 9), 1)
    assert palpate.Editor(SCENE.volume).apply(palpate.Fill((5, 5, 5), (5, 5, 5), 1)) is not None


STROKE = dict(latency_s=0.0, failures=0.0, speed_mm_s=50.0, coarse_first=False, seconds=0.01, rate=1000.0, memory_bytes=1 << 26)


@pytest.mark.parametrize("name, wrong", [("latency_s", float("inf")), ("latency_s", -1), ("failures", 1), ("speed_mm_s", float("nan")),
                                         ("rate", 0), ("seconds", -1)])
def test_a_stroke_that_would_have_no_end_is_refused(name, wrong):
    with pytest.raises(ValueError, match=f"{name} = "):
        palpate.streaming_stroke(**{**STROKE, name: wrong})


def test_a_loop_that_would_not_fit_into_memory_is_refused():
    for seconds, rate in ((0.1, 2.0**31), (1e7, 1000), (0, 1000)):
        with pytest.raises(ValueError, match="= "):
            palpate.closed_loop(palpate.Renderer(FIELD, 100), "simulated", seconds, rate)


@pytest.mark.parametrize("read", [palpate.load, palpate.open_store])
def test_a_wrong_spacing_is_no_fault_of_the_file(tmp_path, read):
    palpate.write(SCENE.volume, tmp_path / "v.nrrd")
    with pytest.raises(ValueError, match="spacing = 0.0: must be from 1e-30 to 1e30") as refused:
        read(tmp_path / "v.nrrd", spacing=(1, 0, 1))
    assert not isinstance(refused.value, palpate.InputError)


def test_a_plot_says_which_axes_it_needs():
    trace = palpate.replay(FIELD, 100, TIMES, HIPS)
    with pytest.raises(ValueError, match="axes: two are needed"):
        trace.plot(3)


@pytest.mark.parametrize("values, words", [
    (numpy.linspace(0, 1, 216) * 1e-300, "changed them by up to 1e-300"), (1e9 + numpy.linspace(0, 1, 216), "subtract an offset"),
    (numpy.where(numpy.arange(216) < 9, 312782574, 312782578).astype("uint32"), "216 whole numbers"), (2**53 + numpy.arange(216), "whole numbers"),
    (numpy.where(numpy.arange(216) < 9, 1e300, 1), "9 samples were not finite (NaN, infinity or beyond 3.4e38)")])
def test_values_that_float32_cannot_tell_apart_are_warned_of(values, words):
    assert words in warned(lambda: palpate.as_volume(values.reshape(6, 6, 6)))


def test_samples_all_beyond_float32_are_not_called_nan():
    with pytest.raises(ValueError, match="beyond 3.4e38"):
        palpate.as_volume(numpy.full((6, 6, 6), 1e300))


@pytest.mark.parametrize("values", [numpy.linspace(-1000, 3000, 216), numpy.full(216, 0.1), numpy.arange(216, dtype="int64"),
                                    numpy.linspace(0, 1, 216, dtype="float16"), numpy.arange(216, dtype=">i4")])
def test_values_that_float32_holds_bring_no_warning(values):
    assert warned(lambda: palpate.as_volume(values.reshape(6, 6, 6))) == ""


def test_coordinates_of_dimensions_that_are_not_used_are_warned_of():
    class Named:
        dims, shape = ("x", "y", "z"), (6, 7, 8)
        coords = {"x": numpy.arange(6) * 0.5, "y": numpy.arange(7), "z": 3.0 * numpy.arange(8)}

        def __array__(self, dtype=None, copy=None):
            return numpy.zeros(self.shape, dtype or "float32")

    named = Named()
    assert "the coordinates of x, z were not used" in warned(lambda: palpate.as_volume(named))
    assert warned(lambda: palpate.as_volume(named, spacing=(0.5, 1, 3), origin=(0, 0, 0))) == ""
    named.coords = {"y": numpy.arange(7)}
    assert warned(lambda: palpate.as_volume(named)) == ""
