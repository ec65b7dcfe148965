// The proxy alone, without forces: whole trajectories in, arrays out, without the GIL. Experiments
// are made of it.
#include "palpate/proxy.hpp"

#include <malloc.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <thread>

#include "bindings/python/arrays.hpp"
#include "bindings/python/bindings.hpp"
#include "bindings/python/hands.hpp"
#include "bindings/python/moving.hpp"
#include "bindings/python/progress.hpp"
#include "bindings/python/setup.hpp"
#include "palpate/baselines/methods.hpp"
#include "palpate/run/no_effect.hpp"

namespace palpate::python {
namespace {

using Clock = std::chrono::steady_clock;
/// Largest number of threads of follow_each(), whatever the caller asks for.
constexpr std::size_t most_threads = 256;
using Firsts = Numbers<std::int64_t>;

/// Arrays with a row per tick.
struct ProxyTrace {
    explicit ProxyTrace(py::ssize_t ticks)
        : scp({ticks, py::ssize_t{3}}),
          density(ticks),
          isovalue(ticks),
          constrained(ticks),
          unfinished(ticks),
          tetrahedra(ticks),
          update_ns(ticks) {}

    py::array_t<double> scp, density, isovalue;
    py::array_t<bool> constrained, unfinished;
    py::array_t<int> tetrahedra;
    py::array_t<std::int64_t> update_ns;
    std::optional<py::dict> steps = {};
};

/// Destination of the rows of a ProxyTrace. Can be used without the GIL.
struct Rows {
    explicit Rows(ProxyTrace& trace)
        : scp(trace.scp.mutable_data()),
          density(trace.density.mutable_data()),
          isovalue(trace.isovalue.mutable_data()),
          constrained(trace.constrained.mutable_data()),
          unfinished(trace.unfinished.mutable_data()),
          tetrahedra(trace.tetrahedra.mutable_data()),
          update_ns(trace.update_ns.mutable_data()) {}

    void put(std::size_t i, const ProxyUpdate& update, Clock::duration took) const {
        std::copy_n(update.scp.data(), 3, scp + 3 * i);
        density[i] = update.density;
        isovalue[i] = update.isovalue;
        constrained[i] = update.mode == Mode::constrained;
        unfinished[i] =
            update.status != UpdateStatus::done && update.status != UpdateStatus::refused;
        tetrahedra[i] = update.tetrahedra;
        update_ns[i] = std::chrono::duration_cast<std::chrono::nanoseconds>(took).count();
    }

    double *scp, *density, *isovalue;
    bool *constrained, *unfinished;
    int* tetrahedra;
    std::int64_t* update_ns;
};

struct NumberedStep {
    std::int64_t tick;
    Step step;
};

py::dict dict_of(const std::vector<NumberedStep>& steps) {
    const auto of = [&](const auto& value) {
        return column(steps, [&](const NumberedStep& s) { return value(s.step); });
    };
    const auto three = [&](const auto& value) {
        return of([&](const Step& s) {
            const auto v = value(s.tetrahedron);
            return Vec3(v[0], v[1], v[2]);
        });
    };
    return py::dict(py::arg("tick") = column(steps, [](const NumberedStep& s) { return s.tick; }),
                    py::arg("kind") = of([](const Step& s) { return static_cast<int>(s.kind); }),
                    py::arg("point") = of([](const Step& s) { return s.point; }),
                    py::arg("goal") = of([](const Step& s) { return s.goal; }),
                    py::arg("cell") = three([](const Tetrahedron& t) { return t.cell; }),
                    py::arg("axis") = three([](const Tetrahedron& t) { return t.axis; }),
                    py::arg("sign") = three([](const Tetrahedron& t) { return t.sign; }));
}

/// The field in which a proxy moves, and its method.
struct Way {
    Field field;
    double isovalue;
    ProxyMethod method;
    Penetrability penetrability = no_penetrability();
    double scale = 1;  ///< [mm of volume per mm of hand]

    /// Throws std::invalid_argument where there is no free space.
    Proxy placed(const Vec3& start) const {
        Proxy proxy;
        if (!place(proxy, field, start, isovalue)) {
            throw std::invalid_argument("all of space is solid at this isovalue");
        }
        return proxy;
    }

    ProxyUpdate update(Proxy& proxy, const Vec3& hip, const StepObserver& observer,
                       Clock::duration& took) const {
        const auto begin = Clock::now();
        ProxyUpdate made = method(proxy, field, hip, {}, observer);
        took = Clock::now() - begin;
        apply_penetrability(penetrability, field, 1 / scale, proxy, made);
        return made;
    }
};

Way way_of(const Field& field, const io::Level& level, const std::string& method) {
    return {field, felt_level(field, level, method), baselines::method_named(method)};
}

/// A proxy and what it moves in.
struct PlacedProxy {
    Way way;
    Proxy proxy;
};

ProxyTrace follow(Shared<PlacedProxy>& placed, const Doubles& hips,
                  const std::optional<PressThrough>& press, double scale, bool with_steps,
                  const ProgressFunction& progress) {
    Moving<PlacedProxy> moving(placed, "follow()");
    const std::vector<Vec3> points = hips_from(hips);
    if (!(scale > 0)) throw std::invalid_argument("scale: a number above 0 is needed");
    if (!press) {
        run::refuse_without_effect({{{"scale"}, "it is for the threshold of a penetrability"}},
                                   {{"scale", scale != 1}});
    }
    Way way = placed.way;
    way.scale = scale;
    if (press) way.penetrability = penetrability_for(*press, way.field, placed.proxy.isovalue);
    ProxyTrace trace(static_cast<py::ssize_t>(points.size()));
    const Rows rows(trace);
    std::vector<NumberedStep> steps;
    std::pair<std::int64_t, std::vector<NumberedStep>*> context{0, &steps};
    StepObserver observer;
    if (with_steps) {
        observer = {[](const Step& step, void* to) {
                        const auto& [tick, all] = *static_cast<decltype(context)*>(to);
                        all->push_back({tick, step});
                    },
                    &context};
    }
    ReportedItems slices(progress_of(progress), points.size(), updates_in_slice);
    moving.without_gil([&](PlacedProxy& own) {
        for (std::size_t i = 0; i < points.size(); ++i) {
            context.first = static_cast<std::int64_t>(i);
            Clock::duration took{};
            const ProxyUpdate update = way.update(own.proxy, points[i], observer, took);
            rows.put(i, update, took);
            slices.done();
        }
    });
    if (with_steps) trace.steps = dict_of(steps);
    return trace;
}

/// One trajectory, whose first place is where the proxy is put. each() is called after each update.
template <class Each>
void follow_one(const Way& way, const std::vector<Vec3>& hips, std::size_t from, std::size_t to,
                const Rows& rows, const Each& each) {
    Proxy proxy = way.placed(hips[from]);
    ProxyUpdate start;
    start.scp = proxy.scp_physical;
    start.density = value_at(way.field, proxy.scp_physical);
    start.isovalue = proxy.isovalue;
    rows.put(from, start, {});
    for (std::size_t i = from + 1; i < to; ++i) {
        Clock::duration took{};
        const ProxyUpdate update = way.update(proxy, hips[i], {}, took);
        rows.put(i, update, took);
        each();
    }
}

std::vector<std::size_t> begins_of(const Firsts& firsts, std::size_t rows) {
    std::vector<std::size_t> begins(firsts.data(), firsts.data() + firsts.size());
    begins.push_back(rows);
    if (firsts.size() == 0 || begins.front() != 0 ||
        std::ranges::adjacent_find(begins, std::greater_equal<>{}) != begins.end()) {
        throw std::invalid_argument("first: rows of hips, rising, from 0, are needed");
    }
    return begins;
}

ProxyTrace follow_each(const Field& field, const io::Level& level, const Doubles& hips,
                       const Firsts& firsts, const std::string& method, int threads,
                       const ProgressFunction& progress) {
    if (threads < 0) throw std::invalid_argument("threads: a number from 0 is needed");
    const Way way = way_of(field, level, method);
    const std::vector<Vec3> points = hips_from(hips);
    const std::vector<std::size_t> begins = begins_of(firsts, points.size());
    (void)way.placed(points.front());  // throws here, not in a thread
    ProxyTrace trace(static_cast<py::ssize_t>(points.size()));
    const Rows rows(trace);
    std::atomic<std::size_t> next{0};
    const auto follow_some = [&](const auto& each) {
        for (std::size_t i; (i = next++) + 1 < begins.size();) {
            follow_one(way, points, begins[i], begins[i + 1], rows, each);
        }
    };
    const unsigned usual = std::clamp(std::thread::hardware_concurrency(), 1U, 16U);
    const std::size_t wanted = std::min(
        {threads > 0 ? static_cast<std::size_t>(threads) : usual, begins.size() - 1, most_threads});
    ReportedItems slices(progress_of(progress), points.size() / wanted, updates_in_slice);
    const GilReleased unlocked;
    std::vector<std::jthread> others;
    for (std::size_t t = 1; t < wanted; ++t) others.emplace_back([&] { follow_some([] {}); });
    try {
        follow_some([&] { slices.done(); });
    } catch (...) {
        next = begins.size();  // the others end with the hands that they have
        throw;
    }
    others.clear();
    return trace;
}

/// How a call measures times.
struct Timed {
    std::size_t batch = 1;  ///< updates between two readings of the clock; 0: only the clock
    std::size_t cold = 0;   ///< only every so many updates, after the caches were emptied; 0: all
};

/// [ns] per update, in the order of the hands.
std::vector<double> times_of(const Way& way, const std::vector<Vec3>& hips,
                             const std::vector<std::size_t>& begins, const Timed& timed,
                             ReportedItems& slices) {
    constexpr std::size_t more_than_caches = std::size_t{48} << 20, line = 64;  // bytes
    std::vector<std::uint8_t> memory(timed.cold > 0 ? more_than_caches : 0, 1);
    volatile std::uint8_t* const walked = memory.data();
    std::vector<double> times;
    std::size_t number = 0;
    for (std::size_t hand = 0; hand + 1 < begins.size(); ++hand) {
        Proxy proxy = way.placed(hips[begins[hand]]);
        for (std::size_t i = begins[hand] + 1; i < begins[hand + 1];) {
            const std::size_t end =
                std::min(begins[hand + 1], i + std::max<std::size_t>(1, timed.batch));
            const bool counts = timed.cold == 0 || ++number % timed.cold == 0;
            if (counts) {
                for (std::size_t at = 0; at < memory.size(); at += line) walked[at] = 2;
            }
            const auto begin = Clock::now();
            for (std::size_t k = i; timed.batch > 0 && k < end; ++k) {
                way.method(proxy, way.field, hips[k], {}, {});
            }
            const std::chrono::duration<double, std::nano> taken = Clock::now() - begin;
            if (counts) times.push_back(taken.count() / double(end - i));
            i = end;
            slices.done();
        }
    }
    return times;
}

py::array_t<double> update_times(const Field& field, const io::Level& level, const Doubles& hips,
                                 const Firsts& firsts, const std::string& method, std::size_t batch,
                                 std::size_t cold, const ProgressFunction& progress) {
    const Way way = way_of(field, level, method);
    const std::vector<Vec3> points = hips_from(hips);
    const std::vector<std::size_t> begins = begins_of(firsts, points.size());
    ReportedItems slices(progress_of(progress), points.size() / std::max<std::size_t>(1, batch),
                         updates_in_slice);
    return array_from(without_gil([&] {
        return times_of(way, points, begins, {batch, cold}, slices);
    }));
}

/// Heap memory of the process [bytes].
double heap_in_use() {
    const auto info = mallinfo2();
    return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
}

py::dict follow_levels(const Field& field, const Doubles& hips, const Firsts& firsts,
                       const Doubles& levels) {
    const std::vector<Vec3> points = hips_from(hips);
    const std::vector<std::size_t> begins = begins_of(firsts, points.size());
    if (levels.ndim() != 1 || levels.size() != py::ssize_t(points.size())) {
        throw std::invalid_argument("levels: one for each of hips is needed");
    }
    const double* const level = levels.data();
    if (!std::all_of(level, level + levels.size(), [](double one) { return std::isfinite(one); })) {
        throw std::invalid_argument("levels have to be finite");
    }
    ProxyTrace trace(static_cast<py::ssize_t>(points.size()));
    const Rows rows(trace);
    ReportedItems slices(ctrl_c(), points.size(), updates_in_slice);
    double growth = 0;
    {
        const GilReleased unlocked;
        const double before = heap_in_use();
        for (std::size_t hand = 0; hand + 1 < begins.size(); ++hand) {
            const std::size_t first = begins[hand];
            const Way way{field, level[first], &update_exact};
            Proxy proxy = way.placed(points[first]);
            rows.put(first, {}, {});
            for (std::size_t i = first + 1; i < begins[hand + 1]; ++i) {
                proxy.isovalue = level[i];
                Clock::duration took{};
                const ProxyUpdate update = way.update(proxy, points[i], {}, took);
                rows.put(i, update, took);
                if (level[i] != level[i - 1]) growth = std::max(growth, heap_in_use() - before);
                slices.done();
            }
        }
    }
    return py::dict(py::arg("trace") = std::move(trace), py::arg("heap_growth_bytes") = growth,
                    py::arg("state_bytes") = sizeof(Proxy));
}

struct Rays {
    std::vector<Vec3> from, to;
    Rays(const Doubles& starts, const Doubles& ends)
        : from(points_from(starts, "starts")), to(points_from(ends, "ends")) {
        if (from.size() != to.size()) {
            throw std::invalid_argument("as many starts as ends are needed");
        }
        const auto is_finite = [](const Vec3& end) { return end.allFinite(); };
        if (!std::ranges::all_of(from, is_finite) || !std::ranges::all_of(to, is_finite)) {
            throw std::invalid_argument("the ends of a ray have to be finite");
        }
    }
};

std::pair<py::array_t<double>, py::array_t<double>> cast_rays(const Field& field,
                                                              const io::Level& level,
                                                              const Doubles& starts,
                                                              const Doubles& ends) {
    const Rays rays(starts, ends);
    const double isovalue = io::level_in(field.volume(), level);
    const Vec3 none = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
    std::vector<Vec3> points(rays.from.size(), none), normals(rays.from.size(), none);
    {
        ReportedItems slices(ctrl_c(), points.size(), batches_in_slice);
        const GilReleased unlocked;
        for (std::size_t i = 0; i < points.size(); ++i, slices.done()) {
            const RayHit hit = cast_ray(field, isovalue, rays.from[i], rays.to[i]);
            if (!hit.hit) continue;
            points[i] = hit.point;
            normals[i] = hit.normal;
        }
    }
    return {array_from(std::move(points)), array_from(std::move(normals))};
}

double ray_ns(const Field& field, const io::Level& level, const Doubles& starts,
              const Doubles& ends) {
    const Rays rays(starts, ends);
    if (rays.from.empty()) throw std::invalid_argument("starts: at least one is needed");
    const double isovalue = io::level_in(field.volume(), level);
    const GilReleased unlocked;
    const auto begin = Clock::now();
    for (std::size_t i = 0; i < rays.from.size(); ++i) {
        cast_ray(field, isovalue, rays.from[i], rays.to[i]);
    }
    const std::chrono::duration<double, std::nano> taken = Clock::now() - begin;
    return taken.count() / double(rays.from.size());
}

void bind_trace(py::module_& module) {
    py::class_<ProxyTrace>(module, "ProxyTrace",
                           "Where a proxy went, in arrays with a row per tick.")
        .def_readonly("scp", &ProxyTrace::scp, "Surface contact point [mm, physical], (n, 3).")
        .def_readonly("density", &ProxyTrace::density, "At the SCP [data units].")
        .def_readonly("isovalue", &ProxyTrace::isovalue, "Of the surface felt [data units].")
        .def_readonly("constrained", &ProxyTrace::constrained, "Whether it is on the surface.")
        .def_readonly("unfinished", &ProxyTrace::unfinished,
                      "Whether the next update continues, as after recovery or a used-up budget.")
        .def_readonly("tetrahedra", &ProxyTrace::tetrahedra, "How many the SCP moved through.")
        .def_readonly("update_ns", &ProxyTrace::update_ns,
                      "Time of the update [ns], reading the clock included.")
        .def_readonly("steps", &ProxyTrace::steps,
                      "None, or all steps of all updates, as arrays by name: tick, kind (index in\n"
                      "STEP_KINDS), point and goal [mm, physical]; cell, axis and sign of the\n"
                      "tetrahedron, (n, 3) each.")
        .def(py::pickle(
            [](const ProxyTrace& t) {
                return py::make_tuple(t.scp, t.density, t.isovalue, t.constrained, t.unfinished,
                                      t.tetrahedra, t.update_ns, t.steps);
            },
            [](const py::tuple& state) {
                ProxyTrace made(0);
                std::size_t next = 0;
                const auto take = [&](auto&... parts) {
                    ((parts = state[next++].cast<std::remove_reference_t<decltype(parts)>>()), ...);
                };
                take(made.scp, made.density, made.isovalue, made.constrained, made.unfinished,
                     made.tetrahedra, made.update_ns, made.steps);
                return made;
            }));
}

}  // namespace

void bind_proxies(py::module_& module) {
    module.attr("STEP_KINDS") =
        py::make_tuple("place", "free move", "cross", "goal", "slide", "recover", "press");
    bind_trace(module);
    using P = Shared<PlacedProxy>;
    py::class_<P>(module, "Proxy",
                  "The proxy alone, without forces. A value: a copy goes on exactly as its "
                  "original.")
        .def(py::init([](const Field& field, const io::Level& level, const Vec3& start,
                         const std::string& method) {
                 const Way way = way_of(field, level, method);
                 return P({way, way.placed(start)});
             }),
             py::arg("field"), py::arg("isovalue"), py::arg("start"), py::arg("method") = "exact",
             "Put at `start` [mm, physical], or the nearest free place. method: of methods().")
        .def("follow", &follow, py::arg("hips"), py::kw_only(),
             py::arg("penetrability") = py::none(), py::arg("scale") = 1.0,
             py::arg("steps") = false, py::arg("progress") = py::none(),
             "An update for each place of the hand [mm, physical], shape (n, 3), in order: a\n"
             "ProxyTrace. scale: mm of volume per mm of hand, for the threshold of penetrability.\n"
             "If progress raises, the proxy is as before. RuntimeError while another thread is in\n"
             "follow().")
        .def_property_readonly("scp", [](const P& p) { return p.proxy.scp_physical; })
        .def("__copy__", &P::copied)
        .def("__deepcopy__", [](const P& p, const py::dict&) { return p.copied(); });
    module.def(
        "follow_each", &follow_each, py::arg("field"), py::arg("isovalue"), py::arg("hips"),
        py::arg("first"), py::arg("method") = "exact", py::arg("threads") = 0, py::kw_only(),
        py::arg("progress") = py::none(),
        "Many hands, one behind the other in `hips` [mm, physical], shape (n, 3); `first`: the\n"
        "row in which each begins. A proxy of its own is put there and follows to the next hand's\n"
        "row. On all processors, or `threads`, at most 256; the result does not depend on that.\n"
        "ValueError, as of Proxy and update_times(), for what replay() refuses.");
    module.def(
        "update_times", &update_times, py::arg("field"), py::arg("isovalue"), py::arg("hips"),
        py::arg("first"), py::arg("method") = "exact", py::arg("batch") = 1, py::arg("cold") = 0,
        py::kw_only(), py::arg("progress") = py::none(),
        "[ns] per update of hands as for follow_each(), in one thread, measured in C++ over\n"
        "batches of so many updates. batch=0: the clock's own cost. cold: only every so many\n"
        "updates, after the processor's caches were emptied.");
    module.def("follow_levels", &follow_levels, py::arg("field"), py::arg("hips"), py::arg("first"),
               py::arg("levels"),
               "Hands as for follow_each(), in one thread, each update at a level of its own\n"
               "[data units], shape (n,). A dict: trace, a ProxyTrace; heap_growth_bytes, the\n"
               "most that the process took from the heap until after an update with another\n"
               "level; state_bytes of a proxy.");
    module.def("ray_ns", &ray_ns, py::arg("field"), py::arg("isovalue"), py::arg("starts"),
               py::arg("ends"), "Mean time of a segment of cast_rays() [ns].");
    module.def(
        "cast_rays", &cast_rays, py::arg("field"), py::arg("isovalue"), py::arg("starts"),
        py::arg("ends"),
        "Where straight segments [mm, physical] first meet the isosurface: (points [mm], unit\n"
        "normals out of the solid), shape (n, 3) each, NaN where one meets nothing.");
}

}  // namespace palpate::python
