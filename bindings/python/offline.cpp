// Renders whole trajectories offline: arrays in, arrays out, without the GIL.
#include "palpate/run/offline.hpp"

#include <string>
#include <tuple>
#include <type_traits>

#include "bindings/python/arrays.hpp"
#include "bindings/python/bindings.hpp"
#include "bindings/python/hands.hpp"
#include "bindings/python/progress.hpp"
#include "bindings/python/renderer.hpp"
#include "bindings/python/trace_table.hpp"
#include "palpate/io/csv.hpp"
#include "palpate/names.hpp"

namespace palpate::python {
namespace {

/// A column of palpate.Trace: its name, and the path to the part of a row that it has.
template <class... Path>
struct TraceColumn {
    const char* name;
    std::tuple<Path...> path;

    constexpr TraceColumn(const char* its_name, Path... its_path)
        : name(its_name), path(its_path...) {}
    auto& part(auto& row) const {
        const auto follow = [&](auto... step) { return &(row.*....*step); };
        return *std::apply(follow, path);
    }
};

using Row = io::TraceRow;
constexpr std::tuple trace_columns{
    TraceColumn("t", &Row::t),
    TraceColumn("hip", &Row::hip),
    TraceColumn("scp", &Row::scp),
    TraceColumn("force", &Row::force),
    TraceColumn("density", &Row::density),
    TraceColumn("isovalue", &Row::isovalue),
    TraceColumn("constrained", &Row::constrained),
    TraceColumn("tetrahedra", &Row::tetrahedra),
    TraceColumn("update_ns", &Row::update_ns),
    TraceColumn("layer", &Row::layers, &LayersFelt::touched),
    TraceColumn("inside", &Row::layers, &LayersFelt::inside),
    TraceColumn("torque", &Row::torque),
    TraceColumn("hand_orientation_xyzw", &Row::tool, &ToolFelt::hand),
    TraceColumn("proxy_orientation_xyzw", &Row::tool, &ToolFelt::proxy),
    TraceColumn("contacts", &Row::tool, &ToolFelt::contacts)};

void for_each_column(auto&& visit) {
    std::apply([&](const auto&... each) { (visit(each), ...); }, trace_columns);
}

/// Throws std::invalid_argument for an array that does not fit the rows, or numbers that do not fit
/// the column.
template <class... Path>
void read_column(const TraceColumn<Path...>& one, const py::object& given, std::vector<Row>& rows) {
    using Value = std::remove_cvref_t<decltype(one.part(rows.front()))>;
    constexpr py::ssize_t width = std::same_as<Value, Vec3>         ? 3
                                  : std::same_as<Value, Quaternion> ? 4
                                                                    : 1;
    const std::string name = one.name;
    const auto array = numbers_from<double>(given);
    if (!array) throw std::invalid_argument(name + ": numbers are needed");
    if (array.size() != std::ssize(rows) * width) {
        throw std::invalid_argument(name + ": the shape is " +
                                    std::string(py::str(array.attr("shape"))) + ", the trace has " +
                                    std::to_string(rows.size()) + " ticks");
    }
    const double* from = array.data();
    const GilReleasedForRows unlocked(rows.size());
    for (Row& row : rows) {
        if constexpr (width == 3) {
            one.part(row) = Vec3(from);
        } else if constexpr (width == 4) {
            one.part(row) = Quaternion(from);  // x, y, z, w
        } else {
            if (std::is_integral_v<Value> && !holds<Value>(*from)) {
                throw std::invalid_argument(name + " = " + number_text(*from) +
                                            ": is not whole, or too large");
            }
            one.part(row) = static_cast<Value>(*from);
        }
        from += width;
    }
}

void write_trace(const std::filesystem::path& path, const py::dict& columns,
                 const std::vector<std::string>& layer_names, std::size_t nested_layers,
                 bool tool) {
    const auto ticks = columns["t"].cast<Doubles>().size();
    std::vector<Row> rows(static_cast<std::size_t>(ticks));
    for_each_column([&](const auto& one) { read_column(one, columns[one.name], rows); });
    ReportedItems slices(ctrl_c(), rows.size(), updates_in_slice);
    const GilReleased unlocked;
    io::TraceWriter writer(path, {}, {layer_names, nested_layers, tool});
    const auto count = static_cast<int>(layer_names.size());
    for (const Row& row : rows) {
        const int touched = row.layers.touched, inside = row.layers.inside;
        if (count > 0 && (touched < -1 || touched >= count || inside < 0 || inside > count)) {
            throw std::invalid_argument("layer or inside is not that of one of the layer_names");
        }
        writer.add(row);
        slices.done();
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
    warn_of_level(setup, field, renderer.proxy.isovalue, 3);
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
    add_extras(table, extras_of(renderer.settings));
    if (path) {
        table["path"] = py::make_tuple(array_from(std::move(corners.ticks)),
                                       array_from(std::move(corners.values)));
    }
    if (poses) {
        table["poses"] =
            py::make_tuple(array_from(std::move(ways.ticks)),
                           column(ways.values, [](const Pose& pose) { return pose.position; }),
                           column(ways.values, [](const Pose& pose) { return pose.orientation; }));
    }
    return table;
}

}  // namespace

py::dict columns_of(const std::vector<io::TraceRow>& rows) {
    py::dict table;
    for_each_column([&](const auto& one) {
        table[one.name] = column(rows, [&](const Row& row) { return one.part(row); });
    });
    return table;
}

io::TraceExtras extras_of(const RendererSettings& settings) {
    io::TraceExtras extras{.tool = settings.tool != nullptr};
    if (!settings.layers) return extras;
    for (const Layer& layer : settings.layers->layers) extras.layer_names.push_back(layer.name);
    extras.nested_layers = static_cast<std::size_t>(level_count(*settings.layers));
    return extras;
}

void add_extras(py::dict& table, const io::TraceExtras& extras) {
    table["layer_names"] = py::tuple(py::cast(extras.layer_names));
    table["nested_layers"] = extras.nested_layers;
    table["has_tool"] = extras.tool;
}

void bind_offline(py::module_& module) {
    module.def("_replay", &replay, py::arg("field"), py::arg("isovalue"), py::arg("time"),
               py::arg("position"), py::arg("orientation_xyzw"), py::arg("setup"), py::arg("path"),
               py::arg("poses"), py::arg("progress"));
    module.def(
        "_read_trajectory",
        [](const std::filesystem::path& file) {
            io::Trajectory t;
            {
                const GilReleased unlocked;
                t = io::parse_trajectory(io::read_text(file, ctrl_c()), file.string());
            }
            py::object turns = py::none();
            if (!t.orientation.empty()) {
                turns = column(t.orientation, [](const Quaternion& q) { return q; });
            }
            return py::make_tuple(column(t.time, [](double s) { return s; }),
                                  column(t.position, [](const Vec3& p) { return p; }), turns);
        },
        py::arg("path"));
    module.def("_write_trace", &write_trace, py::arg("path"), py::arg("columns"),
               py::arg("layer_names"), py::arg("nested_layers"), py::arg("has_tool"));
    module.def(
        "_read_trace",
        [](const std::filesystem::path& file) {
            std::vector<io::TraceRow> rows;
            io::TraceExtras extras;
            {
                const GilReleased unlocked;
                rows = io::parse_trace(io::read_text(file, ctrl_c()), file.string(), &extras);
            }
            py::dict table = columns_of(rows);
            add_extras(table, extras);
            return table;
        },
        py::arg("path"));
}

}  // namespace palpate::python
