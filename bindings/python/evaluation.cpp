// The parts of the experiments in C++: subjects by name, the hand that explores, the explicit
// surface, and a stroke through a volume that is read meanwhile.
#include <cmath>

#include "bindings/python/arrays.hpp"
#include "bindings/python/bindings.hpp"
#include "bindings/python/hands.hpp"
#include "bindings/python/progress.hpp"
#include "bindings/python/record.hpp"
#include "evaluation/explicit_surface.hpp"
#include "evaluation/exploring_hand.hpp"
#include "evaluation/stroke.hpp"
#include "evaluation/subject.hpp"
#include "palpate/baselines/methods.hpp"

namespace palpate::python {
namespace {

using evaluation::Subject;
using Wanted = std::optional<std::pair<double, double>>;

/// That an exploring hand may take in all [s].
constexpr double most_seconds = 24 * 3600;
constexpr const char* on_smooth_field = "smooth";  // a contestant that is no method

py::dict explore(const Subject& subject, evaluation::ExploringHand hand, const Wanted& wanted,
                 const ProgressFunction& progress) {
    constexpr double attempts = 24;  // at most, to come near to what is wanted
    const double ticks = hand.trajectories * hand.trajectory_s * hand.rate_hz;
    ReportedItems slices(progress_of(progress),
                         static_cast<std::size_t>(ticks * (wanted ? attempts : 1)),
                         updates_in_slice);
    const auto alive = [&] { slices.done(); };
    const auto tuned = without_gil([&]() -> evaluation::TunedHand {
        if (!wanted) return {evaluation::explore(subject, hand, alive), {}, hand};
        return evaluation::tuned_hand(subject, hand, {wanted->first, wanted->second}, alive);
    });
    std::vector<Vec3> hips;
    std::vector<std::int64_t> first;
    for (const evaluation::Trajectory& one : tuned.trajectories) {
        first.push_back(std::ssize(hips));
        hips.insert(hips.end(), one.begin(), one.end());
    }
    return py::dict(py::arg("hips") = array_from(std::move(hips)),
                    py::arg("first") = array_from(std::move(first)),
                    py::arg("speed_mm_s") = tuned.behaviour.speed_mm_s,
                    py::arg("constrained_share") = tuned.behaviour.constrained_share,
                    py::arg("depth_mm") = tuned.hand.depth_mm);
}

void bind_explore(py::module_& module) {
    module.def(
        "explore",
        [](const Field& field, double isovalue, const std::string& name, double speed,
           double touching, double depth, int trajectories, double seconds, std::uint64_t seed,
           const Wanted& wanted, const ProgressFunction& progress) {
            if (!(speed > 0 && std::isfinite(speed)) || !(touching >= 0 && touching <= 1) ||
                !(depth >= 0 && std::isfinite(depth)) || trajectories < 1 ||
                !(seconds * evaluation::ExploringHand{}.rate_hz >= 2 &&
                  seconds * trajectories <= most_seconds)) {
                throw std::invalid_argument(
                    "a hand has a speed above 0, touches for 0 to 1 of its time, presses 0 mm or "
                    "more deep, and follows a trajectory or more for 2 ms to a day");
            }
            felt_level(field, isovalue, "exact");
            return explore({name, field, isovalue},
                           {.speed_mm_s = speed,
                            .touching = touching,
                            .depth_mm = depth,
                            .trajectories = trajectories,
                            .trajectory_s = seconds,
                            .seed = seed},
                           wanted, progress);
        },
        py::arg("field"), py::arg("isovalue"), py::kw_only(), py::arg("name") = "the volume",
        py::arg("speed_mm_s") = 50.0, py::arg("touching") = 0.6, py::arg("depth_mm") = 0.5,
        py::arg("trajectories") = 20, py::arg("trajectory_s") = 5.0, py::arg("seed") = 1,
        py::arg("wanted") = py::none(), py::arg("progress") = py::none(),
        "A simulated hand at 1 kHz that explores free space, comes back to the surface and slides\n"
        "along it, again and again: hips and first as for follow_each(). speed_mm_s: its mean;\n"
        "touching: the part of its time that it means to touch; depth_mm: below the surface.\n"
        "wanted: (mean speed, share of updates in contact), to which speed and touching are\n"
        "tuned; speed_mm_s and constrained_share say how near it comes, and depth_mm how deep it\n"
        "presses then. progress: called with the part that is done. Raises ValueError for a level\n"
        "that nothing meets, which calls the volume `name`.");
}

py::dict explicit_surface(const Field& field, double isovalue, const Doubles& starts,
                          const Doubles& ends, int repeats, const ProgressFunction& progress) {
    const std::vector<Vec3> from = points_from(starts, "starts"), to = points_from(ends, "ends");
    if (from.size() != to.size()) throw std::invalid_argument("as many starts as ends are needed");
    for (const Vec3& one : from) check_numbers("starts", one, ranges::finite);
    for (const Vec3& one : to) check_numbers("ends", one, ranges::finite);
    check_numbers("isovalue", isovalue, ranges::finite);
    check_numbers("repeats", repeats, ranges::at_least_1);
    std::vector<evaluation::Segment> segments(from.size());
    for (std::size_t i = 0; i < segments.size(); ++i) segments[i] = {from[i], to[i]};
    auto answer = without_gil([&] {
        return evaluation::explicit_surface({"", field, isovalue}, segments, repeats,
                                            progress_of(progress));
    });
    if (!answer.failure.empty()) throw std::runtime_error(answer.failure);
    const evaluation::ExplicitCost& cost = answer.cost;
    using py::arg;
    return py::dict(arg("hits") = array_from(std::move(answer.hits)),
                    arg("vertices") = cost.vertices, arg("triangles") = cost.triangles,
                    arg("extraction_s") = cost.extraction_s, arg("tree_s") = cost.tree_s,
                    arg("cpu_s") = cost.cpu_s, arg("mesh_bytes") = cost.mesh_bytes,
                    arg("tree_bytes") = cost.tree_bytes, arg("peak_bytes") = cost.peak_bytes,
                    arg("segment_ns") = cost.query_ns);
}

void bind_explicit_surface(py::module_& module) {
    module.def(
        "explicit_surface", &explicit_surface, py::arg("field"), py::arg("isovalue"),
        py::arg("starts"), py::arg("ends"), py::kw_only(), py::arg("repeats") = 1,
        py::arg("progress") = py::none(),
        "The explicit approach in a process of its own: the whole isosurface (VTK, flying edges),\n"
        "a bounding volume hierarchy on it (Embree), and where segments [mm, physical] first meet\n"
        "it. A dict: hits, from 0 to 1 along each, NaN for none; vertices, triangles;\n"
        "extraction_s, tree_s and cpu_s of all threads, the least of the repeats; mesh_bytes,\n"
        "tree_bytes, and peak_bytes without the samples; segment_ns, the mean. Raises\n"
        "RuntimeError where the program palpate-explicit-helper fails or is missing.");
}

py::dict streaming_stroke(double latency, double failures, double speed, bool coarse_first,
                          double seconds, double rate, std::uint64_t memory, std::uint64_t seed,
                          const ProgressFunction& progress) {
    check_numbers("latency_s", latency, {0, 60, false, "from 0 to 60"});
    check_numbers("failures", failures, {0, 0.99, false, "from 0 to 0.99"});
    check_numbers("speed_mm_s", speed, ranges::positive);
    check_numbers("rate", rate, ranges::rate);
    check_numbers("seconds", seconds, {0, 86400, true, "above 0, at most a day"});
    const auto felt = without_gil([&] {
        return evaluation::feel({.network = {latency, failures},
                                 .speed = speed,
                                 .coarse_first = coarse_first,
                                 .seconds = seconds,
                                 .rate = rate,
                                 .memory = memory,
                                 .seed = seed},
                                progress_of(progress));
    });
    using py::arg;
    return py::dict(arg("ticks") = felt.ticks, arg("touching") = felt.touching,
                    arg("waiting") = felt.waiting, arg("coarse") = felt.coarse,
                    arg("deepest_voxel") = felt.deepest, arg("beyond_voxel") = felt.beyond,
                    arg("first_contact_s") = felt.first_contact_s,
                    arg("most_bytes") = felt.most_bytes, arg("requests") = felt.traffic.requests,
                    arg("retries") = felt.traffic.retries, arg("read_bytes") = felt.traffic.bytes);
}

void bind_streaming_stroke(py::module_& module) {
    module.attr("BALL_VOXEL") = evaluation::ball_voxel;
    module.def(
        "streaming_stroke", &streaming_stroke, py::kw_only(), py::arg("latency_s"),
        py::arg("failures"), py::arg("speed_mm_s"), py::arg("coarse_first"), py::arg("seconds"),
        py::arg("rate"), py::arg("memory_bytes"), py::arg("seed") = 1,
        py::arg("progress") = py::none(),
        "In real time, a hand goes to and fro through a row of balls of 256 voxels of BALL_VOXEL\n"
        "[mm], in a volume of 12288^3 computed samples, while they are read as over a network of\n"
        "this latency, of whose requests a share fails. A dict: ticks, and of those touching,\n"
        "waiting and coarse; the greatest depth of the path in a ball, deepest_voxel, and\n"
        "beyond_voxel, the same less what the rounding and the interpolation of the samples may\n"
        "take; first_contact_s (negative: none), most_bytes, requests, retries and read_bytes.");
}

Subject subject(const std::string& text, const std::optional<std::string>& contestant) {
    Subject made = evaluation::subject_from(text);
    if (!contestant) return made;
    if (*contestant == on_smooth_field) {
        made.field.set_interpolation(Interpolation::cubic);
    } else {
        baselines::method_named(*contestant);  // throws for another
        made.field.set_interpolation(Interpolation::linear);
    }
    return made;
}

void bind_subject(py::module_& module) {
    py::class_<Subject>(module, "Subject", "A volume for an experiment, with an isovalue.")
        .def_readonly("name", &Subject::name)
        .def_property_readonly("field", [](const Subject& s) { return s.field; })
        .def_readonly("isovalue", &Subject::isovalue, "[data units]")
        .def("__repr__", [](const Subject& s) {
            return py::str("Subject({!r}, isovalue={:g})").format(s.name, s.isovalue);
        });
    module.def(
        "subject", &subject, py::arg("text"), py::arg("contestant") = py::none(),
        py::call_guard<GilReleased>(),
        "'synthetic:NAME[:WxHxD]' or a file or folder, '@ISOVALUE' behind it: 'head.nrrd@500'.\n"
        "With a contestant, the field that it feels. Raises ValueError, InputError.");
    module.def(
        "contestants",
        [] {
            std::vector<std::string> names;
            for (const auto& method : baselines::methods()) names.push_back(method.name);
            names.emplace_back(on_smooth_field);
            return names;
        },
        "What experiments compare: all methods on the linear field, and 'smooth'.");
}

}  // namespace

void bind_evaluation(py::module_& module) {
    bind_subject(module);
    bind_explore(module);
    bind_explicit_surface(module);
    bind_streaming_stroke(module);
}

}  // namespace palpate::python
