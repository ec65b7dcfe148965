// Renders whole trajectories offline: arrays in, arrays out, without the GIL.
#include "palpate/run/offline.hpp"

#include "bindings/python/arrays.hpp"
#include "bindings/python/bindings.hpp"
#include "bindings/python/hands.hpp"
#include "bindings/python/progress.hpp"
#include "bindings/python/renderer.hpp"
#include "bindings/python/trace_table.hpp"

namespace palpate::python {

py::dict columns_of(const std::vector<io::TraceRow>& rows) {
    using Row = io::TraceRow;
    py::dict table;
    table["t"] = column(rows, [](const Row& r) { return r.t; });
    table["hip"] = column(rows, [](const Row& r) { return r.hip; });
    table["scp"] = column(rows, [](const Row& r) { return r.scp; });
    table["force"] = column(rows, [](const Row& r) { return r.force; });
    table["density"] = column(rows, [](const Row& r) { return r.density; });
    table["isovalue"] = column(rows, [](const Row& r) { return r.isovalue; });
    table["constrained"] = column(rows, [](const Row& r) { return r.constrained; });
    table["tetrahedra"] = column(rows, [](const Row& r) { return r.tetrahedra; });
    table["update_ns"] = column(rows, [](const Row& r) { return r.update_ns; });
    table["layer"] = column(rows, [](const Row& r) { return int{r.layers.touched}; });
    table["inside"] = column(rows, [](const Row& r) { return int{r.layers.inside}; });
    table["torque"] = column(rows, [](const Row& r) { return r.torque; });
    table["hand_orientation_xyzw"] = column(rows, [](const Row& r) { return xyzw(r.tool.hand); });
    table["proxy_orientation_xyzw"] = column(rows, [](const Row& r) { return xyzw(r.tool.proxy); });
    table["contacts"] = column(rows, [](const Row& r) { return r.tool.contacts; });
    return table;
}

namespace {

/// The columns of a palpate.Trace.
class Table {
  public:
    explicit Table(py::dict columns)
        : columns_(std::move(columns)), rows_(columns_["t"].cast<Doubles>().size()) {}

    py::ssize_t rows() const { return rows_; }
    /// Throws std::invalid_argument for another shape than (rows, width), or (rows,).
    Doubles column(const char* name, py::ssize_t width) const {
        const auto array = numbers_from<double>(columns_[name]);
        if (!array) throw std::invalid_argument(std::string(name) + ": numbers are needed");
        if (array.size() != rows_ * width) {
            throw std::invalid_argument(std::string(name) + ": the shape is " +
                                        std::string(py::str(array.attr("shape"))) +
                                        ", the trace has " + std::to_string(rows_) + " ticks");
        }
        return array;
    }

  private:
    py::dict columns_;
    py::ssize_t rows_;
};

void write_trace(const std::filesystem::path& path, const py::dict& columns,
                 const std::vector<std::string>& layer_names, std::size_t nested_layers,
                 bool tool) {
    const Table table(columns);
    const auto numbers = [&](const char* name) {
        return [array = table.column(name, 1)](py::ssize_t i) { return array.data()[i]; };
    };
    const auto vectors = [&](const char* name) {
        return
            [array = table.column(name, 3)](py::ssize_t i) { return Vec3(array.data() + 3 * i); };
    };
    const auto turns = [&](const char* name) {
        return [array = table.column(name, 4)](py::ssize_t i) {
            const double* q = array.data() + 4 * i;
            return Quaternion(q[3], q[0], q[1], q[2]);
        };
    };
    const auto t = numbers("t"), density = numbers("density"), isovalue = numbers("isovalue"),
               constrained = numbers("constrained"), tetrahedra = numbers("tetrahedra"),
               update_ns = numbers("update_ns"), touched = numbers("layer"),
               inside = numbers("inside"), contacts = numbers("contacts");
    const auto hip = vectors("hip"), scp = vectors("scp"), force = vectors("force"),
               torque = vectors("torque");
    const auto hand = turns("hand_orientation_xyzw"), proxy = turns("proxy_orientation_xyzw");
    io::TraceWriter writer(path, {}, {layer_names, nested_layers, tool});
    for (py::ssize_t i = 0; i < table.rows(); ++i) {
        io::TraceRow row{t(i), hip(i), scp(i), force(i), density(i), isovalue(i)};
        row.constrained = constrained(i) != 0;
        row.tetrahedra = static_cast<int>(tetrahedra(i));
        row.update_ns = static_cast<std::int64_t>(update_ns(i));
        row.layers.touched = static_cast<std::int8_t>(touched(i));
        row.layers.inside = static_cast<std::int8_t>(inside(i));
        const auto count = static_cast<int>(layer_names.size());
        if (count > 0 && (row.layers.touched >= count || row.layers.inside > count)) {
            throw std::invalid_argument("layer or inside is more than there are layer_names");
        }
        row.tool = {hand(i), proxy(i), static_cast<int>(contacts(i))};
        row.torque = torque(i);
        writer.add(row);
    }
    writer.commit();
}

/// A table with a column of ticks.
template <class Value>
struct OfTicks {
    std::vector<std::int64_t> ticks;
    std::vector<Value> values;

    void add(std::int64_t tick, const Value& value) {
        ticks.push_back(tick);
        values.push_back(value);
    }
};

py::dict dict_of(const run::OfflineSummary& s) {
    using py::arg;
    return py::dict(
        arg("ticks") = s.ticks, arg("constrained") = s.constrained,
        arg("out_of_budget") = s.out_of_budget, arg("recovering") = s.recovering,
        arg("refused") = s.refused, arg("worst_surface_error") = s.worst_surface_error,
        arg("largest_force") = s.largest_force, arg("largest_torque") = s.largest_torque,
        arg("most_contacts") = s.most_contacts, arg("mean_tetrahedra") = s.mean_tetrahedra,
        arg("mean_ns") = s.mean_ns, arg("p50_ns") = s.p50_ns, arg("p99_ns") = s.p99_ns,
        arg("p999_ns") = s.p999_ns, arg("max_ns") = s.max_ns);
}

py::dict replay(const Field& field, const io::Level& isovalue, const Doubles& time,
                const Doubles& position, const std::optional<Doubles>& orientation,
                const RenderSetup& setup, bool path, bool poses, const ProgressFunction& progress) {
    const io::Trajectory trajectory = trajectory_from(time, position, orientation);
    Renderer renderer = offline_renderer(field, isovalue, setup);
    if (poses && !renderer.settings.tool) {
        throw std::invalid_argument("poses are those of a tool: give one");
    }
    std::vector<io::TraceRow> rows;
    rows.reserve(trajectory.time.size());
    OfTicks<Vec3> corners;
    OfTicks<Pose> ways;
    run::OfflineSinks sinks;
    sinks.row = [&](const io::TraceRow& row) { rows.push_back(row); };
    if (path) sinks.corner = [&](std::int64_t tick, const Vec3& at) { corners.add(tick, at); };
    if (poses) sinks.pose = [&](std::int64_t tick, const Pose& pose) { ways.add(tick, pose); };
    sinks.progress = progress_of(progress);
    const auto summary =
        without_gil([&] { return run::render_offline(renderer, trajectory, sinks); });
    py::dict table = columns_of(rows);
    table["summary"] = dict_of(summary);
    if (renderer.settings.layers) {
        py::list names;
        for (const Layer& layer : renderer.settings.layers->layers) names.append(layer.name);
        table["layer_names"] = py::tuple(names);
        table["nested_layers"] = level_count(*renderer.settings.layers);
    }
    table["has_tool"] = renderer.settings.tool != nullptr;
    if (path) {
        table["path"] = py::make_tuple(array_from(std::move(corners.ticks)),
                                       array_from(std::move(corners.values)));
    }
    if (poses) {
        table["poses"] = py::make_tuple(
            array_from(std::move(ways.ticks)),
            column(ways.values, [](const Pose& pose) { return pose.position; }),
            column(ways.values, [](const Pose& pose) { return xyzw(pose.orientation); }));
    }
    return table;
}

}  // namespace

void bind_offline(py::module_& module) {
    module.def("_replay", &replay, py::arg("field"), py::arg("isovalue"), py::arg("time"),
               py::arg("position"), py::arg("orientation_xyzw"), py::arg("setup"), py::arg("path"),
               py::arg("poses"), py::arg("progress"));
    module.def(
        "_read_trajectory",
        [](const std::filesystem::path& file) {
            const io::Trajectory t = io::read_trajectory(file);
            py::object turns = py::none();
            if (!t.orientation.empty()) {
                turns = column(t.orientation, [](const Quaternion& q) { return xyzw(q); });
            }
            return py::make_tuple(column(t.time, [](double s) { return s; }),
                                  column(t.position, [](const Vec3& p) { return p; }), turns);
        },
        py::arg("path"));
    module.def("_write_trace", &write_trace);
    module.def(
        "_read_trace",
        [](const std::filesystem::path& file) { return columns_of(io::read_trace(file)); },
        py::arg("path"));
}

}  // namespace palpate::python
