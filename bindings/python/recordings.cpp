// Recordings of live sessions: reading and validating them.
#include "palpate/io/recording.hpp"

#include <optional>
#include <string>

#include "bindings/python/arrays.hpp"
#include "bindings/python/bindings.hpp"
#include "bindings/python/progress.hpp"
#include "bindings/python/setup.hpp"
#include "bindings/python/trace_table.hpp"
#include "palpate/io/csv.hpp"
#include "palpate/io/trace.hpp"
#include "palpate/run/replay.hpp"

namespace palpate::python {
namespace {

namespace fs = std::filesystem;

py::dict dict_of(const io::RecordingHead& head) {
    return py::dict(
        py::arg("version") = head.version, py::arg("begun") = head.begun,
        py::arg("volume") = head.volume.options, py::arg("solid") = head.solid,
        py::arg("interpolation") = head.interpolation, py::arg("background") = head.background,
        py::arg("isovalue") = head.isovalue, py::arg("device") = head.device,
        py::arg("rate") = head.rate, py::arg("method") = head.method,
        py::arg("force") = AskedForce(head.settings.force),
        py::arg("friction") = head.settings.proxy.friction,
        py::arg("limits") = head.settings.device, py::arg("transform") = head.settings.transform);
}

py::tuple read(const fs::path& path, int hand) {
    std::optional<io::RecordingReader> reader;
    std::vector<io::TraceRow> rows;
    std::vector<std::int64_t> commands;
    io::TraceExtras extras;
    bool other_layers = false;
    {
        ReportedItems slices(ctrl_c(), 0, updates_in_slice);
        const GilReleased unlocked;
        reader.emplace(io::read_text(path, ctrl_c()), path.string(), hand);
        extras = extras_of(reader->head().settings);
        while (const auto event = reader->next()) {
            slices.done();
            if (const auto* tick = std::get_if<SessionTick>(&*event)) {
                rows.push_back(io::trace_row(tick->tick));
            } else {
                commands.push_back(static_cast<std::int64_t>(rows.size()));
                const auto& command = std::get<Command>(*event);
                if (const auto* use = std::get_if<command::UseTool>(&command)) {
                    extras.tool |= use->tool != nullptr;
                } else if (const auto* use = std::get_if<command::UseLayers>(&command)) {
                    RendererSettings now;
                    now.layers = use->layers;
                    const auto named = extras_of(now);
                    if (rows.empty()) extras.layer_names = named.layer_names;
                    if (rows.empty()) extras.nested_layers = named.nested_layers;
                    other_layers |= use->layers && named.layer_names != extras.layer_names;
                }
            }
        }
    }
    if (other_layers) {
        warn("the layers changed during the recording: trace.layer_names are those at its start",
             3);
    }
    py::dict table = columns_of(rows);
    add_extras(table, extras);
    return py::make_tuple(dict_of(reader->head()), table, array_from(std::move(commands)),
                          reader->complete(), reader->lost(), reader->hands());
}

py::dict validate(const fs::path& path, const fs::path& volume, const ProgressFunction& progress) {
    const auto tell = progress_of(progress);
    const auto hands = without_gil([&] {
        const std::string text = io::read_text(path, tell);
        const io::RecordingReader reader(text, path.string());
        const run::LoadedVolume loaded =
            run::load(run::recorded_source(reader.head(), path, volume.string()), tell);
        return run::validate(text, path.string(), loaded, tell);
    });
    std::int64_t ticks = 0, commands = 0;
    for (const run::ValidatedHand& hand : hands) {
        ticks += hand.ticks;
        commands += hand.commands;
    }
    return py::dict(py::arg("ticks") = ticks, py::arg("commands") = commands,
                    py::arg("complete") = hands.front().complete,
                    py::arg("lost") = hands.front().lost);
}

}  // namespace

void bind_recordings(py::module_& module) {
    module.def("_read_recording", &read, py::arg("path"), py::arg("hand"));
    module.def(
        "validate", &validate, py::arg("path"), py::arg("volume") = "",
        py::arg("progress") = py::none(),
        "Renders every tick of a recording, of all its hands, again and compares it bit for bit, "
        "with\n"
        "`volume` in place of the recorded name where it is given. A dict of ticks, commands,\n"
        "complete (not cut off) and lost events; InputError for the first tick that differs.");
}

}  // namespace palpate::python
