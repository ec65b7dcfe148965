"""The parts of the experiments layers, tools, streaming, notice, stability, performance, scaling and needle, and long calls that stop."""

import _thread
import functools
import itertools
import operator
import os
import pathlib
import signal
import subprocess

import numpy
import palpate
import pytest

from palpate.evaluate import bodies, figures, heads, layers, needle, notice, performance, scaling, stability, streaming, tissues, tools
from palpate.evaluate.experiment import GRANTED, Options, Table
from palpate.evaluate.subjects import Subject, of_text


def test_an_svg_keeps_its_words_and_its_lines_to_a_hundredth_of_a_point():
    line = '   <path d="M 1.123456 1 \nL 1.2 2.004 \nL 9 9 \n" style="fill: none"/>\n'
    text = ' <text x="0.123456" style="stroke-width: 0.125" transform="translate(0.001 -0.001) rotate(0.125)">0.123456</text>'
    assert figures.compact("<svg>\n" + line + text) == (
        '<svg>\n<path d="M 1.12 1 L 1.2 2 L 9 9 " style="fill: none"/>\n'
        '<text x="0.12" style="stroke-width: 0.125" transform="translate(0 0) rotate(0.125)">0.123456</text>')


def test_phantoms_have_their_depth_as_density():
    random, depth = numpy.random.default_rng(3), numpy.arange(5, tissues.DEEPEST, 0.37)
    # Linear interpolation of a radius between samples 0.125 mm apart is off by 0.125^2 / 8 times its two curvatures.
    interpolated = 0.125**2 / 8 * 2 / (tissues.BALL_RADIUS - depth)
    for body, off in ((tissues.flat(), 0 * depth), (tissues.balls(), interpolated)):
        field = body.felt("linear")
        for _ in range(50):
            way = body.way(random)
            assert numpy.linalg.norm(way.inward) == pytest.approx(1, abs=1e-12)
            assert (abs(field.value(way.at(depth)) - depth) <= off + 1e-5).all()


def stepped_spring(depth):
    """A hand that goes in by tiny steps: the surface that holds it, and where it last gave way."""
    gone, force = 0, 0
    for at in numpy.arange(0, depth + 1e-9, 1e-3):
        force = 0
        while gone < len(tissues.LEVEL) and at > tissues.LEVEL[gone]:
            force = tissues.STIFFNESS[gone] * (at - tissues.LEVEL[gone])
            if force < tissues.PUNCTURE[gone]:
                break
            gone, force = gone + 1, 0
    return force


def test_the_closed_form_is_that_of_a_hand_that_goes_in_by_tiny_steps():
    depths = numpy.array([9.0, 10.5, 12.9, 13.1, 16.1, 19.4, 19.6, 31.0, 32.3, 33.6, 35.6, 35.7, 59.0, 62.0])
    for depth, force in zip(depths, tissues.spring(depths)):
        assert force == pytest.approx(stepped_spring(depth), abs=1e-9), depth


def test_drag_is_drag_times_length_in_what_gave_way():
    assert tissues.drag(numpy.array([12.9]))[0] == 0  # the skin still holds
    assert tissues.drag(numpy.array([13.1]))[0] == pytest.approx(0.03 * 3.1)
    held_by_bone = 0.03 * 6 + 0.01 * 14 + 0.05 * 3.5 + 0.03 * 26.5
    assert tissues.drag(numpy.array([61.0]))[0] == pytest.approx(held_by_bone)


def test_a_drill_meets_bone_after_the_skin_and_again_from_behind():
    head, = heads.heads_of(Options(quick=True))
    rows = Table(heads.press_into(head, "drilling", 0.5))
    assert [row["order"] for row in rows.where(part="head event")] == [
        "on skin", "through skin", "on bone", "through bone", "on bone from behind", "through bone from behind"]


def test_real_heads_that_are_missing_are_named():
    notes = []
    assert len(heads.heads_of(Options(note=notes.append))) == 1
    assert "ct-head" in notes[0] and "visible-human" in notes[1]


def test_a_volume_of_the_user_takes_the_place_of_heads():
    subject = of_text("synthetic:sphere:24x24x24")
    head, = heads.heads_of(Options(quick=True, subjects=(subject,)))
    table = Table(row for name in heads.SETS for row in heads.press_into(head, name, 0.5))
    assert head.subject.name == "sphere" and all(claim.held for claim in heads.claims_of_heads(table))
    with pytest.raises(ValueError, match="level"):
        heads.heads_of(Options(subjects=(of_text("synthetic:sphere:16x16x16@1000"),)))


def test_rendering_many_ticks_is_rendering_each():
    field, ticks = tissues.flat().felt("linear"), 400
    made, hand = tissues.renderer(field, tissues.layers()), numpy.array([4, 4, 0]) + numpy.outer(9 + numpy.arange(ticks) / 90, [0, 0, 1])
    alone, time = made.copy(), tissues.times(ticks)
    middle = made.copy()
    middle.follow(time[:200], hand[:200])
    trace, fork = made.follow(time, hand), middle.follow(time[200:203], hand[200:203], alternatives=True)
    for i, tick in enumerate(alone.render(*of) for of in zip(time, hand)):
        assert (tick.force == trace["force"][i]).all() and tick.punctured == trace["punctured"][i]
        assert (tick.layer, tick.inside) == (trace["layer"][i], trace["inside"][i])
    assert trace["punctured"].sum() == 1
    assert (fork["force"][0] == trace["force"][200]).all()
    assert (fork["force"][1] == middle.copy().render(time[201], hand[201]).force).all()
    assert (made.batch_ns(time + 1, hand, 40) > 0).sum() == 10
    with pytest.raises(ValueError):
        made.follow(time, hand[1:])


def sphere():
    return tools.sampled("ball", 40, lambda x, y, z: -(x * x + y * y + z * z), -144)


def test_the_judge_of_tools_sees_the_greatest_excess_on_chords():
    ball = sphere()
    most = tools.greatest_on_chords(ball, numpy.array([[-15.0, 3, 0], [-15, 14, 0]]), numpy.array([[14.0, 3, 0], [14, 14, 0]]))
    assert most == pytest.approx(ball.excess_at([[0, 3.0, 0]])[0], abs=1e-6)
    assert tools.greatest_on_chords(ball, numpy.array([[-15.0, 14, 0]]), numpy.array([[14.0, 14, 0]])) < 0


def test_pruned_chords_are_judged_as_all_are(monkeypatch):
    noise = next(tools.hostile_scenes(5))
    random = numpy.random.default_rng(2)
    starts = random.uniform(-15, 15, (400, 3))
    ends = starts + random.uniform(-1, 1, (400, 3))
    pruned = tools.greatest_on_chords(noise, starts, ends)
    slopes = numpy.linalg.norm(noise.field.gradient(random.uniform(-16, 16, (20000, 3))), axis=1)
    assert slopes.max() / noise.field.range < tools.steepest(noise.field)
    monkeypatch.setattr(tools, "steepest", lambda field: numpy.inf)
    assert tools.greatest_on_chords(noise, starts, ends) == pruned


def test_the_judge_of_tools_notices_one_in_the_solid():
    scene, tool = tools.sampled("plane", 40, lambda x, y, z: -z, 0), palpate.Tool.named("box:2,2,2", 0.5)
    hands = numpy.outer([10, 5, 5.0], [0, 0, 1])
    turns = tools.Rotation.from_quat(numpy.tile([0, 0, 0, 1.0], (3, 1)))
    path, verdict = tools.judged(scene, tool, hands, turns)
    assert verdict["chords"] > 0 and verdict["worst_excess_of_range"] < 0
    path["pose_position"] = path["pose_position"] - [0, 0, 5.5]  # as no update leads
    assert tools.judge(scene, tool, path)[1] > GRANTED


def test_a_penalty_lets_a_scalpel_through_the_shell_and_the_exact_method_does_not():
    shell = list(tools.hostile_scenes(1))[2]
    scalpel = dict(tools.tools_of())["scalpel"]
    hand = tools.wild_hand(numpy.random.default_rng(1), 90, 28, (0.0, 0, 0))
    assert abs(numpy.linalg.norm(numpy.diff(hand[0], axis=0), axis=1)).max() < 3 + 1e-9
    penalty, exact = (tools.hostile_row(shell, method, "scalpel", scalpel, [hand], [90]) for method in ("penalty", "exact"))
    assert penalty["deepest_voxel"] > 1 > 0.1 > exact["deepest_voxel"]
    assert penalty["through_share"] > 0 == exact["through_share"]
    assert 0 < exact["touching_share"] < 1


@pytest.mark.parametrize("seeds", [1, 3, 61, 1000])
def test_each_hand_has_ticks_and_in_the_shell_enough_to_get_to_the_wall(seeds):
    noise, _, shell = tools.hostile_scenes(1)
    free, enclosed = (tools.counts_of(scene, 60, seeds) for scene in (noise, shell))
    assert sum(free) == 60 and min(free) > 0 and len(free) == min(seeds, 60)
    assert enclosed == [tools.LEAST] * seeds and sum(tools.counts_of(shell, 100_000, seeds)) == 100_000


@pytest.mark.parametrize("broken", [{}, {"through_share": 0.5}, {"touching_share": 0}])
def test_a_tool_that_gets_through_the_shell_or_never_touches_it_breaks_the_claim(broken):
    rows = [{"part": "equilibrium", "force_off_share": 0, "torque_off_share": 0},
            {"part": "fit", "lowest_mm": -4, "end_mm": 20, "worst_excess_of_range": 0}]
    rows += [{"part": "hostile", "method": "exact", "scene": "shell", "ticks": 300, "chords": 7, "worst_excess_of_range": 0,
              "worst_growth_voxel": 0, "through_share": 0, "touching_share": 0.1, **change} for change in ({}, broken)]
    claims = list(tools.claims_of(Table(rows)))
    assert [claim.held for claim in claims] == [True, True, True, not broken, True]
    assert not any("confidence" in claim.measured for claim in claims) and "of 600 ticks" in claims[3].measured


def test_the_claim_of_streaming_is_about_the_strokes_that_were_judged():
    judged = {"ticks": 1000, "waiting_share": 0.25, "beyond_allowed_voxel": -1.5, "most_mb": 1}
    for others, left in (([], ""), ([{**judged, "beyond_allowed_voxel": numpy.nan}, {"ticks": 1000, "waiting_share": 1}], "In the other 2")):
        claim = next(streaming.claims_of(Table([judged, judged, *others])))
        assert claim.held and f"1.50 voxel less deep than allowed, in 2 of {2 + len(others)} strokes, with 1,500 ticks" in claim.measured
        assert (left in claim.measured) and ("In the other" in claim.measured) == bool(others)
    for rows in ([judged, {**judged, "beyond_allowed_voxel": 0.1}], [{"ticks": 1000, "waiting_share": 1, "most_mb": 1}]):
        assert not next(streaming.claims_of(Table(rows))).held


def test_the_title_of_streaming_is_true_of_the_stroke_that_coarser_levels_spare_least():
    def strokes(latency, finest, coarse):
        return [{"levels": levels, "latency_ms": latency, "speed_voxel_s": 100, "waiting_share": share}
                for levels, share in zip(streaming.LEVELS, (finest, coarse))]

    without_latency, half, quarter, more = strokes(0, 0.1, 0.1), strokes(20, 0.8, 0.4), strokes(100, 0.04, 0.03), strokes(200, 0.1, 0.2)
    assert "at least 50 %" in streaming.title_of(Table(without_latency + half + strokes(50, 0, 0)))
    assert "at least 25 %" in streaming.title_of(Table(half + quarter))
    assert "not spare every hand" in streaming.title_of(Table(half + more))


def test_the_page_of_scaling_names_the_calm_and_the_calmest_noise():
    rows = [{"part": "noise", "method": "exact", "tetrahedra_per_update": moved} for moved in (1.9, 0.04, 0.1)]
    rows += [{"part": "speed", "method": "exact", "tetrahedra": 7, "updates": 1, "path_voxel": 1, "mean_ns": 1},
             {"part": "size", "size": "8x8x8"}, {"part": "explicit", "state_bytes": 1, "explicit_segment_ns": numpy.nan}]
    text = " ".join(scaling.text_of(Table(rows), True, 5))
    assert "1.9 tetrahedra per update, and with noise through as few as 0.04." in text and "median of 5 passes" in text


def test_a_vibration_is_that_of_the_mean_force_in_contact():
    ball = bodies.ball_by("circle", 48, "float32")
    lifts = ball._replace(hand=lambda parts: ball.hand(parts) * numpy.where(numpy.asarray(parts) % 0.5 < 0.25, 1, 2)[:, None])
    row = notice.row_of(lifts, "smooth")
    assert 0.3 < row["contact_share"] < 0.7
    trace, hands, pull = notice.stroke(lifts, notice.CONTESTANTS["smooth"], row["ticks"] + notice.RATE // 10)
    strength = numpy.linalg.norm(pull[notice.RATE // 10:], axis=1)
    jump = numpy.linalg.norm(numpy.diff(pull[notice.RATE // 10:], axis=0), axis=1)
    assert row["change_rms_percent"] == pytest.approx(100 * numpy.sqrt((jump**2).mean()) / strength[strength > 0].mean())


def test_loops_that_gain_energy_or_none_at_all_break_claims_that_give_no_bound():
    kept = {"part": "energy", "most_gained_j": 1e-9, "least_lost_with_puncture_j": 0.1, "runs": 3, "loops_with_punctures": 2}
    none = {"most_gained_j": -numpy.inf, "least_lost_with_puncture_j": numpy.nan, "runs": 0, "loops_with_punctures": 0}
    for row, held in ((kept, True), ({**kept, "most_gained_j": 1, "least_lost_with_puncture_j": -1}, False),
                      ({**kept, **none}, False)):
        for claim in layers.claims_of_energy(Table([row])):
            assert claim.held == held and ("confidence" in claim.measured) == held


def test_each_case_of_the_closed_loops_draws_loops_of_its_own(monkeypatch):
    begun = []
    monkeypatch.setattr(layers, "gained", lambda made, path: begun.append(tuple(path[0])) or (0.0, 0, 1))
    name, volume, *rest = next(layers.loop_bodies())
    for number in range(2):
        layers.energy_row(number, name, palpate.Field(volume), *rest, numpy.inf, Options(quick=True))
    assert len(set(begun)) == len(begun) == 6


def test_a_loop_at_rest_pushes_against_the_surface():
    subject = of_text("synthetic:sphere")
    row = stability.pressed(subject, "map", "touch", False, "linear", 0, 1000, 0.5)
    assert (row["at_rest"], row["in_contact"]) == ("yes", "yes") and row["push_N"] > 0.05
    assert stability.turned(subject, "rotation, ideal", "premium6dof", 1000, 0.5)["torque_N_mm"] > 5
    with pytest.raises(ValueError, match="simulated"):
        stability.loop_of(subject.field, subject.isovalue, "none", 1000, 1)


def test_the_hand_is_the_same_for_a_seed_and_comes_near_to_what_is_wanted():
    subject = of_text("synthetic:torus:40x40x20")
    once, again, other = (palpate.explore(subject.field, subject.isovalue, seed=seed, trajectories=2, trajectory_s=1, wanted=(50, 0.6))
                          for seed in (1, 1, 2))
    assert (once["hips"] == again["hips"]).all() and not numpy.array_equal(once["hips"], other["hips"])
    assert once["speed_mm_s"] == pytest.approx(50, rel=0.15) and once["constrained_share"] == pytest.approx(0.6, rel=0.15)
    with pytest.raises(ValueError, match="some volume: a hand from outside"):
        palpate.explore(subject.field, 1e9, name="some volume")


def test_a_volume_of_the_user_has_our_target_and_no_row_of_the_paper():
    rows = Table(performance.rows_of(of_text("synthetic:torus:40x40x20"), None, "LR", performance.Effort(1, 0.5, 2, 0), 1))
    assert rows.distinct("target_from") == ["ours"] and numpy.isnan(rows["paper_mean_us"]).all()
    assert not list(performance.summary_of(rows))


def test_a_hand_far_from_its_target_breaks_a_claim_or_on_a_users_volume_gives_a_note():
    rows = Table({"method": name, "unfinished_updates": 0, "speed_mm_s": 30, "target_speed_mm_s": 50, "constrained_share": 0.6,
                  "target_constrained_share": 0.6} for name in performance.METHODS)
    notes = []
    own, users = (list(performance.claims_of(rows, Options(subjects=subjects, note=notes.append))) for subjects in ((), (None,)))
    assert [claim.held for claim in own] == [True, True, False]
    assert len(users) == 2 and len(notes) == 1 and "very small" in notes[0]


def test_times_of_updates_are_in_order_and_each_is_measured():
    subject = of_text("synthetic:sphere:32x32x32")
    hand = palpate.explore(subject.field, subject.isovalue, trajectories=2, trajectory_s=0.503)
    of = (subject.field, subject.isovalue, hand["hips"], hand["first"])
    assert len(hand["hips"]) == 1008 and list(hand["first"]) == [0, 504]
    weights = performance.weights_of(hand)
    assert list(weights) == 2 * ([50] * 10 + [3]) and len(palpate.update_times(*of, batch=50)) == len(weights)
    assert len(palpate.update_times(*of)) == 1006 and len(palpate.update_times(*of, cold=100)) == 10
    taken = performance.timed(subject, ["exact"], hand, 3, 5)["exact"]
    found = performance.numbers_of(taken, hand, 20)
    assert 0 < found["p50_ns"] <= found["p99_ns"] <= found["p999_ns"] <= found["max_ns"] <= found["interrupted_max_ns"]
    assert found["updates"] == 1006 and found["cold_p50_ns"] > 0


def inline_functions(path, kinds):
    """Sizes of compiled copies, by name."""
    sizes = {}
    for line in subprocess.run(["nm", "-S", path], capture_output=True, text=True, check=True).stdout.splitlines():
        words = line.split()
        if len(words) == 4 and words[2] in kinds:
            sizes.setdefault(words[3], set()).add(words[1])
    return sizes


def test_times_in_dev_builds_are_those_of_optimized_code():
    build = pathlib.Path(os.environ["PALPATE_BUILD"])
    if "CMAKE_BUILD_TYPE:STRING=RelWithDebInfo" not in (build / "CMakeCache.txt").read_text():
        pytest.skip("the module is compiled like the core")
    core, module = inline_functions(build / "src/libpalpate.a", "W"), inline_functions(palpate._palpate.__file__, "tW")
    both = core.keys() & module.keys()
    assert len(both) > 100 and [name for name in both if not module[name] <= core[name]] == []


def test_a_ball_has_the_same_samples_around_its_centre_in_a_grid_of_any_size():
    small, large = (scaling.Ball(size).sampled() for size in (64, 80))
    samples = large.field.volume.array
    assert (small.field.volume.array == samples[8:72, 8:72, 8:72]).all()
    assert samples[40, 40, 0] == 0 and samples[40, 40, 40] == 255
    point, _ = palpate.cast_rays(small.field, small.isovalue, [[40, 0.3, 0.2]], [[0, 0.3, 0.2]])
    assert numpy.linalg.norm(point) == pytest.approx(22, abs=0.05)


def test_noise_is_seeded_and_as_large_as_asked_for():
    ball = scaling.Ball(32, 10, 8)
    calm, wild, again = (ball.noisy(*how).field.volume.array for how in ((0, 1), (0.4, 1), (0.4, 1)))
    assert 0.19 < abs(wild - calm).max() <= 0.2 + 1e-6 and (wild == again).all()


def oblique_sphere(kind):
    z, y, x = numpy.mgrid[:26, :34, :30]
    depth = 10 - numpy.linalg.norm(numpy.stack([x - 14.5, 0.8 * (y - 16.5), 1.5 * (z - 12.5)]), axis=0)
    volume = palpate.Volume((100 + 10 * depth).clip(0, 255).astype(kind), spacing=[1, 0.8, 1.5], origin=[-7, 30, 12],
                            direction=[[0, -1, 0], [0.6, 0, 0.8], [-0.8, 0, 0.6]])
    return Subject("sphere", palpate.Field(volume, interpolation="linear"), 100.5)


@pytest.mark.parametrize("kind", ["uint8", "int16", "uint16", "float32"])
def test_the_whole_surface_is_the_one_that_is_felt_on_every_type_and_an_oblique_grid(kind):
    sphere = oblique_sphere(kind)
    starts, ends = scaling.segments_of(sphere, scaling.over(sphere, scaling.SPEED, scaling.VOXELS, 1000, 1))
    # A hand that has only just touched may end between the two triangulations.
    deep = numpy.linalg.norm(ends - starts, axis=1) > 0.6
    assert deep.sum() > 500
    found = scaling.explicit_numbers(sphere, (starts[deep], ends[deep]), Options())
    assert found["one_sided_hits_share"] == 0 and found["hit_difference_voxel"] < 0.2
    whole = palpate.explicit_surface(sphere.field, sphere.isovalue, starts, ends)
    # Euler: a closed surface of genus 0 has 2 V - 4 triangles.
    assert whole["triangles"] == 2 * whole["vertices"] - 4 == found["explicit_triangles"] < whole["tree_bytes"]
    assert whole["mesh_bytes"] == 12 * (whole["vertices"] + whole["triangles"]) and len(whole["hits"]) == len(starts)


def test_scaling_goes_on_without_the_explicit_approach_where_its_program_cannot_be_run(monkeypatch):
    monkeypatch.setenv("PALPATE_EXPLICIT_HELPER", "/nonexistent/palpate-explicit-helper")
    notes = []
    result = scaling.run(Options(quick=True, subjects=(of_text("synthetic:sphere:24x24x24"),), note=notes.append))
    assert all(claim.held for claim in result.claims) and len(result.claims) == 1
    assert "left out" in notes[0] and "without the explicit approach on sphere" in notes[1]
    assert result.table.distinct("volume") == ["sphere"] and not result.table.where(part="noise")
    assert numpy.isnan(result.table["explicit_triangles"]).all() and result.table[-1]["change_p50_ns"] > 0


def test_each_update_is_at_the_level_that_it_is_given():
    subject = of_text("synthetic:sphere:32x32x32")
    hand = palpate.explore(subject.field, subject.isovalue, trajectories=2, trajectory_s=0.5)
    levels, jumped = scaling.levels_of(subject, hand)
    assert jumped.sum() == 2 * 20 and set(numpy.round(levels[jumped] - subject.isovalue, 9)) >= {0.0}
    assert len(set(levels)) == 3 and not jumped[hand["first"]].any()
    found = palpate.follow_levels(subject.field, hand["hips"], hand["first"], levels)
    trace, moved = found["trace"], scaling.moved_rows(hand)
    assert (trace.isovalue[moved] == levels[moved]).all() and found["heap_growth_bytes"] == 0
    held = trace.constrained & moved & ~trace.unfinished
    assert held[jumped].any() and abs(trace.density - levels)[held].max() <= GRANTED * subject.field.range
    same = palpate.follow_levels(subject.field, hand["hips"], hand["first"], numpy.full(len(levels), subject.isovalue))["trace"]
    assert (same.scp == palpate.follow_each(subject.field, subject.isovalue, hand["hips"], hand["first"]).scp)[moved].all()
    with pytest.raises(ValueError, match="levels"):
        palpate.follow_levels(subject.field, hand["hips"], hand["first"], levels[1:])


def long_calls():
    """Calls of many updates, by name; each takes `progress`."""
    sphere = of_text("synthetic:sphere:24x24x24")
    of, ticks = (sphere.field, sphere.isovalue), 20_000
    smooth = (palpate.Field(sphere.field.volume), sphere.isovalue)  # for tools
    hips = numpy.linspace([-20, 0, 0], [-6, 2, 1], ticks)
    tool = (palpate.Tool.named("box:2,2,2", 1), hips[::50], numpy.tile([0, 0, 0, 1.0], (400, 1)))
    setup, time = palpate.Renderer(*of, palpate.RenderSetup(rate=1000)), numpy.arange(1, ticks + 1) / 1000
    return {"Proxy.follow": functools.partial(palpate.Proxy(*of, hips[0]).follow, hips),
            "follow_each": functools.partial(palpate.follow_each, *of, hips, [0], threads=2),
            "update_times": functools.partial(palpate.update_times, *of, hips, [0]),
            "follow_tool": functools.partial(palpate.follow_tool, *smooth, *tool),
            "penalty": functools.partial(palpate.follow_tool, *smooth, *tool, "penalty"),
            "Renderer.follow": functools.partial(setup.follow, time, hips),
            "batch_ns": functools.partial(setup.copy().batch_ns, time, hips, 50),
            "closed_loop": functools.partial(palpate.closed_loop, setup, "simulated:touch,hand=hold,depth=0,seconds=20", 20, 1000),
            "explore": functools.partial(palpate.explore, *of),
            "tuned": functools.partial(palpate.explore, *of, wanted=(50, 0.6)),
            "streaming_stroke": functools.partial(palpate.streaming_stroke, latency_s=0, failures=0, speed_mm_s=1, coarse_first=True,
                                                  seconds=2, rate=1000, memory_bytes=64_000_000)}


@pytest.mark.parametrize("name", list(long_calls()))
def test_a_long_call_ends_when_its_progress_raises_and_at_ctrl_c(name):
    call, parts = long_calls()[name], []

    def stop(part):
        parts.append(part)
        raise LookupError("stopped")

    with pytest.raises(LookupError, match="stopped"):
        call(progress=stop)
    assert len(parts) == 1 and 0 <= parts[0] < 1
    # Only C code runs between the signal and the next slice, so that nothing but the call itself can notice it.
    signals = itertools.repeat(signal.SIGINT, 10)
    with pytest.raises(KeyboardInterrupt):
        call(progress=functools.partial(next, map(_thread.interrupt_main, signals)))
    assert operator.length_hint(signals) == 9


def test_a_needle_in_the_wrong_tissue_is_counted_as_an_error():
    made, random = needle.phantom(2.0), numpy.random.default_rng(4)
    assert (made.truth[made.depths[3] > 3] == 175).all()
    assert needle.inside(needle.TISSUES[3], numpy.array([[-14.0, 3, 0]]))[0] == 6
    scans = needle.scans(made, random)
    assert abs(scans[needle.RAW] - made.truth)[made.depths[3] > 4].std() == pytest.approx(0.6 * needle.NOISE, rel=0.2)
    assert {*scans[needle.PARTLY][(made.depths[2] > 0) & (made.depths[3] <= 0)]} == {110} and scans[needle.PARTLY].dtype == numpy.float32
    assert {*scans[needle.PARTLY][made.depths[3] > 0]} == {175} and scans[needle.PARTLY][made.depths[2] <= 0].max() == 55
    truth = made.felt(scans[needle.TRUTH])
    softer = made.felt(numpy.where(made.depths[2] > -9, 55, scans[needle.TRUTH]).astype(numpy.float32))  # without a liver
    table = Table(needle.rows_of([(number, needle.path(random)) for number in range(4)], {needle.TRUTH: truth, needle.RAW: softer}))
    assert (table.where(scan=needle.TRUTH)["rms_n"] == 0).all() and (table.where(scan=needle.RAW)["rms_n"] > 0.02).all()
    assert (table.where(scan=needle.TRUTH)["punctures"] == 4).all() and (table.where(scan=needle.RAW)["punctures"] < 4).all()
    assert (table.where(scan=needle.RAW)["missed"] >= 1).all() and (table.where(scan=needle.RAW)["extra"] == 0).all()
    other = numpy.where(made.depths[3] > -9, 110, scans[needle.TRUTH])  # without the vessel, but with a gap under the skin
    other = made.felt(numpy.where(abs(made.depths[0] - 4) < 2, -1000, other).astype(numpy.float32))
    row = Table(needle.rows_of([(0, needle.path(random))], {needle.TRUTH: truth, needle.RAW: other})).where(scan=needle.RAW)[0]
    assert row["extra"] == 1 and row["missed"] == 1 and row["punctures"] == 4


def test_a_trembling_hand_feels_a_surface_that_is_too_stiff_buzz():
    subject = of_text("synthetic:sphere")
    calm, wild = (stability.trembled(subject, "trembling", "touch", 250, stiffness) for stiffness in (0.4, 20))
    assert calm["in_contact"] == "yes" and calm["above_20_hz_percent"] < 1 < stability.FORCE < wild["above_20_hz_percent"]
    row = {"part": "trembling", "rate_hz": 1000, **{name: calm[name] for name in ("in_contact", "above_20_hz_percent")}}
    for change, held in (({}, True), ({"above_20_hz_percent": 8}, False), ({"in_contact": "no"}, False)):
        claim, = stability.claims_of_trembling(Table([{**row, **change}]))
        assert claim.held == held
    assert not list(stability.claims_of_trembling(Table()))
