// Dequantizing by parts, for palpate.distributed: what parts say of the whole, and rounds on a
// part.
#include "palpate/filters/dequantize_parts.hpp"

#include <pybind11/functional.h>

#include <algorithm>
#include <tuple>

#include "bindings/python/arrays.hpp"
#include "bindings/python/bindings.hpp"

namespace palpate::python {
namespace {

py::tuple sites_of(const Volume& part, const Index3& low, const Index3& whole,
                   const Index3& core_low, const Index3& core_high, int step) {
    const auto sites = without_gil([&] {
        return filters::sites_of({part, low, whole}, {core_low, core_high - Index3::Ones()}, step);
    });
    return py::make_tuple(
        column(sites, [](const filters::SurfaceSite& s) -> Vec3 { return s.at.cast<double>(); }),
        column(sites, [](const filters::SurfaceSite& s) { return s.slope; }),
        column(sites, [](const filters::SurfaceSite& s) { return s.bend; }));
}

/// `sites(step)`: slopes and bends of the whole volume's sites, in the order of the samples.
filters::DequantizePlan plan_of(double level, double minimum, double maximum, int rounds,
                                const std::function<std::pair<Doubles, Doubles>(int)>& sites) {
    filters::DequantizeOptions options;
    options.rounds = rounds;
    return filters::plan_of(level, minimum, maximum, options, [&](int step) {
        const auto [slopes, bends] = sites(step);
        std::vector<filters::SurfaceSite> all(static_cast<std::size_t>(slopes.size()));
        for (std::size_t i = 0; i < all.size(); ++i) {
            all[i].slope = slopes.data()[i];
            all[i].bend = bends.data()[i];
        }
        return all;
    });
}

/// How far the samples of a part have been moved: of a state, which is what such a call returned.
std::vector<std::int16_t> moved_of(const Volume& samples, const std::optional<Volume>& state) {
    std::vector<std::int16_t> moved(static_cast<std::size_t>(sample_count(samples.geometry())));
    if (!state) return moved;
    const auto own = state->samples<std::int16_t>();
    if (own.size() != moved.size()) {
        throw std::invalid_argument("state and samples are of one box");
    }
    std::ranges::copy(own, moved.begin());
    return moved;
}

using Rounds = std::tuple<int, int, int>;  // step, count, way

filters::DequantizePlan::Rounds rounds_from(const Rounds& rounds) {
    const auto& [step, count, way] = rounds;
    return {step, count, filters::DequantizePlan::Rounds::Way(way)};
}

/// The state after some rounds; without one, of samples that were not moved.
Volume rounds_of(const Volume& samples, const std::optional<Volume>& state, const Index3& low,
                 const Index3& whole, const filters::DequantizePlan& plan,
                 const std::vector<Rounds>& rounds) {
    std::vector<std::int16_t> moved = moved_of(samples, state);
    std::vector<filters::DequantizePlan::Rounds> all;
    for (const Rounds& some : rounds) all.push_back(rounds_from(some));
    filters::run_rounds({samples, low, whole}, moved, plan, all, 1);
    return {samples.geometry(), std::move(moved)};
}

Volume moved_samples(const Volume& samples, const Volume& state,
                     const filters::DequantizePlan& plan) {
    return filters::moved_samples(samples, state.samples<std::int16_t>(), plan);
}

}  // namespace

void bind_dequantize_parts(py::module_& module) {
    using filters::DequantizePlan;
    py::class_<DequantizePlan>(module, "_DequantizePlan")
        .def(py::init(&plan_of))
        .def_property_readonly("rounds",
                               [](const DequantizePlan& plan) {
                                   std::vector<Rounds> rounds;
                                   for (const auto& r : plan.rounds)
                                       rounds.emplace_back(r.step, r.count, int(r.way));
                                   return rounds;
                               })
        .def(py::pickle(
            [](const DequantizePlan& plan) {
                return py::make_tuple(plan.level, plan.minimum, plan.maximum, plan.mask);
            },
            [](const py::tuple& state) {
                return DequantizePlan{state[0].cast<double>(),
                                      state[1].cast<double>(),
                                      state[2].cast<double>(),
                                      state[3].cast<bool>(),
                                      {}};
            }));
    module.def("_values_of", [](const Volume& part) {
        return array_from(without_gil([&] { return filters::values_of(part); }));
    });
    module.def("_level_of", [](const std::vector<double>& values, bool whole_numbers) {
        return filters::level_of(values, whole_numbers);
    });
    module.def("_sites_of", &sites_of);
    module.def("_rounds_of", &rounds_of, py::call_guard<GilReleased>());
    module.def("_moved_samples", &moved_samples, py::call_guard<GilReleased>());
    module.def("_reach_of", [](const Rounds& rounds) { return rounds_from(rounds).reach(); });
    module.attr("_DOWN") = int(filters::DequantizePlan::Rounds::Way::down);
    module.attr("_STAY") = int(filters::DequantizePlan::Rounds::Way::stay);
    module.attr("_TERRACE_REACH") = filters::terrace_reach;
}

}  // namespace palpate::python
