// Reads and writes volumes in every format, and pushes frames to other programs.
#include "bindings/python/bindings.hpp"
#include "bindings/python/own_process.hpp"
#include "bindings/python/progress.hpp"
#include "bindings/python/record.hpp"
#include "io/tiff_peek.hpp"
#include "palpate/io/address.hpp"
#include "palpate/io/live_file.hpp"
#include "palpate/io/raw_options.hpp"
#include "palpate/io/sample_volume.hpp"
#include "palpate/io/trajectory.hpp"
#include "palpate/io/volume_file.hpp"
#include "palpate/io/written_formats.hpp"
#include "palpate/run/no_effect.hpp"
#include "palpate/run/source.hpp"
#include "palpate/run/statistics.hpp"
#include "palpate/stream/store.hpp"

namespace palpate::python {
namespace {

namespace fs = std::filesystem;

struct LoadOptions {
    std::optional<io::RawLayout> raw;
    std::optional<Vec3> spacing;
    std::string series, orientation;
    std::optional<int> frame;
    std::optional<double> frame_interval;
    int smooth = 0, dequantize = 0;
    bool prefilter = false;
};

/// Throws std::invalid_argument for an option that this kind of source does not have.
run::Source source_of(const fs::path& name, const LoadOptions& options) {
    run::Source source = run::source_named(name.string());
    check_numbers("spacing", options.spacing, ranges::spacing);
    if (auto* file = std::get_if<run::FileSource>(&source.from)) {
        file->raw = options.raw;
        file->spacing = options.spacing;
        file->series = options.series;
        file->orientation = options.orientation;
    } else if (options.raw || options.spacing || !options.series.empty() ||
               !options.orientation.empty()) {
        throw std::invalid_argument(
            name.string() + ": raw, spacing, orientation and series are for files and folders");
    }
    source.frame = options.frame;
    source.frame_interval = options.frame_interval;
    source.smooth = options.smooth;
    source.dequantize = options.dequantize;
    source.prefilter = options.prefilter;
    return source;
}

/// A tiled TIFF is read whole too.
bool is_for_store(const fs::path& name) {
    const auto kind = name.extension();
    return kind == ".zarr" || kind == ".n5" ||
           (stream::is_chunked(name.string()) && !io::peek_tiff(name));
}

run::LoadedVolume load(const fs::path& name, const LoadOptions& options,
                       const ProgressFunction& progress) {
    const run::Source source = source_of(name, options);
    if (!options.raw && is_for_store(name)) {
        throw io::InputError(io::without_secrets(name.string()) +
                             ": is read by the box: open it with open_store(); read() gives a "
                             "Volume, and Run(open_store(...)) feels it");
    }
    const auto tell = progress_of(progress);
    const GilReleased unlocked;
    run::LoadedVolume loaded = run::load(source, tell);
    run::refuse_without_effect(run::without_effect(loaded),
                               {{"series", !options.series.empty()},
                                {"frame_interval", options.frame_interval.has_value()}});
    if (loaded.streamed) loaded.streamed->store = destroyed_here_only(loaded.streamed->store);
    return loaded;
}

std::vector<double> suggested(const run::LoadedVolume& loaded) {
    constexpr int bins = 256;
    return run::suggested_isovalues(run::histogram_of(
        loaded.volume, bins, run::padding_of(loaded.volume, loaded.values.padding)));
}

py::dict values_of(const run::LoadedVolume& loaded) {
    const io::ValueInfo& values = loaded.values;
    py::dict labels;
    for (const io::LabelName& label : values.labels) labels[py::int_(label.value)] = label.name;
    py::object window = py::none();
    if (values.window) window = py::make_tuple(values.window->centre, values.window->width);
    return py::dict(py::arg("modality") = values.modality, py::arg("units") = values.units,
                    py::arg("window") = window, py::arg("padding") = values.padding,
                    py::arg("labels") = labels);
}

run::LoadedVolume loaded_as(const Volume& volume, const fs::path& name,
                            std::optional<double> isovalue) {
    run::LoadedVolume loaded{volume, run::source_named(name.string()), name.string()};
    check_numbers("isovalue", isovalue, ranges::finite);
    loaded.isovalue = isovalue;
    return loaded;
}

using Label = std::tuple<int, std::string, std::array<double, 3>>;

/// For pickling: the volume and what is known about it; of a sequence, a store or a live source
/// only its names, under which it is opened again.
py::tuple state_of(const run::LoadedVolume& loaded) {
    const auto names = run::to_names(loaded.source);
    if (loaded.streamed || loaded.live || loaded.sequence.count() > 1) {
        return py::make_tuple(py::none(), names);
    }
    const io::ValueInfo& v = loaded.values;
    std::optional<std::pair<double, double>> window;
    if (v.window) window.emplace(v.window->centre, v.window->width);
    std::vector<Label> labels;
    for (const io::LabelName& l : v.labels) labels.emplace_back(l.value, l.name, l.colour);
    return py::make_tuple(loaded.volume, names, loaded.name, loaded.format, loaded.notes,
                          loaded.isovalue, loaded.time_steps, v.modality, v.units, window,
                          v.padding, labels);
}

run::LoadedVolume loaded_again(const py::tuple& state) {
    const auto source = run::source_from(state[1].cast<std::map<std::string, std::string>>());
    if (state[0].is_none()) {
        const GilReleased unlocked;
        run::LoadedVolume loaded = run::load(source, ctrl_c());
        if (loaded.streamed) loaded.streamed->store = destroyed_here_only(loaded.streamed->store);
        return loaded;
    }
    run::LoadedVolume loaded{state[0].cast<Volume>(), source, state[2].cast<std::string>()};
    loaded.format = state[3].cast<std::string>();
    loaded.notes = state[4].cast<std::vector<std::string>>();
    loaded.isovalue = state[5].cast<std::optional<double>>();
    loaded.time_steps = state[6].cast<int>();
    loaded.values.modality = state[7].cast<std::string>();
    loaded.values.units = state[8].cast<std::string>();
    if (const auto window = state[9].cast<std::optional<std::pair<double, double>>>()) {
        loaded.values.window = {window->first, window->second};
    }
    loaded.values.padding = state[10].cast<std::optional<double>>();
    for (const auto& [value, name, colour] : state[11].cast<std::vector<Label>>()) {
        loaded.values.labels.push_back({value, name, colour});
    }
    return loaded;
}

void bind_loaded(py::module_& module) {
    py::class_<run::LoadedVolume> loaded(module, "LoadedVolume",
                                         "A volume and what is known about it: from load().");
    copied_as_itself(loaded)
        .def(py::init(&loaded_as), py::arg("volume"), py::arg("name") = "array",
             py::arg("isovalue") = py::none(),
             "A volume of yours, for Run. name: what recordings call it; to validate them, write\n"
             "the volume to a file of that name. isovalue: a good one [data units].")
        .def_property_readonly(
            "volume", [](const run::LoadedVolume& l) { return l.volume; },
            "The Volume; of a sequence its first frame.")
        .def_property_readonly("name",
                               [](const run::LoadedVolume& l) { return text_of_path(l.name); })
        .def_readonly("format", &run::LoadedVolume::format, "For people: 'NRRD', 'DICOM series'.")
        .def_readonly("notes", &run::LoadedVolume::notes,
                      "Sentences on how it was read: conversions, gaps, missing spacing.")
        .def_readonly("isovalue", &run::LoadedVolume::isovalue,
                      "A good level [data units] of a synthetic volume; else None.")
        .def_readonly("time_steps", &run::LoadedVolume::time_steps,
                      "Number of frames of a sequence.")
        .def_property_readonly("values", &values_of,
                               "What the header says of values: modality, units, window (centre,\n"
                               "width), padding, labels (number to name).")
        .def_property_readonly("suggested_isovalues", &suggested,
                               "Levels that are likely worth feeling [data units], the best first.")
        .def(py::pickle(&state_of, &loaded_again))
        .def("__repr__", [](const run::LoadedVolume& l) {
            return py::str("LoadedVolume({!r}, {!r})")
                .format(text_of_path(l.name), py::cast(l.volume));
        });
}

void bind_load(py::module_& module) {
    Record<io::RawLayout>(module, "RawLayout", "Layout of a file without a header, x fastest.")
        .field("size", &io::RawLayout::size, {"Samples along x, y, z.", ranges::not_negative})
        .field("type", &io::RawLayout::type, "'uint8', 'int16', 'uint16' or 'float32'.")
        .field("spacing", &io::RawLayout::spacing, {"[mm]", ranges::spacing})
        .field("skip", &io::RawLayout::skip, {"Bytes before the first sample.", ranges::any})
        .field("big_endian", &io::RawLayout::big_endian, "The highest byte of a sample is first.")
        .done();
    module.def(
        "load",
        [](const fs::path& source, std::optional<io::RawLayout> raw, std::optional<Vec3> spacing,
           std::string orientation, std::string series, std::optional<int> frame,
           std::optional<double> frame_interval, int smooth, int dequantize, bool prefilter,
           const ProgressFunction& progress) {
            return load(source,
                        {raw, spacing, std::move(series), std::move(orientation), frame,
                         frame_interval, smooth, dequantize, prefilter},
                        progress);
        },
        py::arg("source"), py::kw_only(), py::arg("raw") = py::none(),
        py::arg("spacing") = py::none(), py::arg("orientation") = "", py::arg("series") = "",
        py::arg("frame") = py::none(), py::arg("frame_interval") = py::none(),
        py::arg("smooth") = 0, py::arg("dequantize") = 0, py::arg("prefilter") = false,
        py::arg("progress") = py::none(),
        "Reads a volume: a file or folder (NRRD, MetaImage, NIfTI, DICOM, TIFF, VTI, raw), a\n"
        "numbered series ('heart_%03d.nrrd'), 'synthetic:NAME[:WxHxD]', or 'live:FILE'.\n"
        "spacing [mm] and orientation (the sides that the axes run to: 'LPS', 'RAS') instead of\n"
        "the file's; frame: of a sequence this one alone; smooth: passes;\n"
        "dequantize: rounds; prefilter: sharpened(). progress(fraction) may raise to stop.\n"
        "Raises InputError, SeriesChoice.");
}

void write(const Volume& volume, const fs::path& path, bool compress,
           const ProgressFunction& progress) {
    const std::string why = io::why_not_compressed(path);
    if (!why.empty()) run::refuse_without_effect({{{"compress"}, why}}, {{"compress", compress}});
    io::WriteOptions options;
    options.compress = compress;
    options.progress = progress_of(progress);
    const GilReleased unlocked;
    io::write_volume(volume, path, options);
}

void bind_live_writer(py::module_& module) {
    py::class_<io::LiveWriter>(module, "LiveWriter",
                               "Writes frames to a file that other programs feel as 'live:FILE'\n"
                               "(docs/sequences.md). Never waits for them.")
        .def(py::init([](const fs::path& path, const Geometry& geometry, SampleType type,
                         double interval, int slots) {
                 return std::make_unique<io::LiveWriter>(path, geometry, type, interval, slots);
             }),
             py::arg("path"), py::arg("geometry"), py::arg("type"), py::arg("interval") = 0.0,
             py::arg("slots") = 4, "interval [s] from frame to frame, nominal; 0: unknown.")
        .def("push", py::overload_cast<const Volume&, double>(&io::LiveWriter::push),
             py::arg("volume"), py::arg("time"), py::call_guard<GilReleased>(),
             "The next frame, on the same grid and of the same type, taken at `time` [s].");
}

}  // namespace

void bind_files(py::module_& module) {
    bind_loaded(module);
    py::implicitly_convertible<Volume, run::LoadedVolume>();
    bind_load(module);
    bind_live_writer(module);
    module.def(
        "write", &write, py::arg("volume"), py::arg("path"), py::kw_only(),
        py::arg("compress") = false, py::arg("progress") = py::none(),
        "Writes a volume in the format of the path's extension (written_extensions()), whole\n"
        "or not at all. Raises OutputError.");
    module.def(
        "written_extensions",
        [] {
            const auto known = io::written_extensions();
            return std::vector<std::string>(known.begin(), known.end());
        },
        "The extensions that write() knows, with their dots.");
    module.def("sample_volume", &io::sample_volume_path,
               "The path of the volume that comes with Palpate: the CT scan of a head.");
    module.attr("SAMPLE_SKIN") = io::sample_volume_skin;
    module.attr("SAMPLE_BONE") = io::sample_volume_bone;
}

}  // namespace palpate::python
