// Stores: samples that are read by the box, of files, chunked formats and web addresses. All
// reading runs without the GIL.
#include "bindings/python/bindings.hpp"
#include "bindings/python/own_process.hpp"
#include "bindings/python/progress.hpp"
#include "bindings/python/record.hpp"
#include "palpate/io/error.hpp"
#include "palpate/run/no_effect.hpp"
#include "palpate/run/source.hpp"
#include "palpate/stream/store.hpp"
#include "stream/formats/content.hpp"

namespace palpate::python {
namespace {

namespace fs = std::filesystem;
using Unlocked = py::call_guard<GilReleased>;

struct OpenStore {
    std::shared_ptr<const stream::Store> store;
    std::string address;  ///< these two open it again
    stream::StoreOptions options;

    const stream::StoreInfo& info() const { return store->info(); }
    Volume read(const Index3& low, const Index3& high, int number) const {
        Geometry grid = stream::level_of(*store, number).geometry;
        const SampleBox box{low, high - Index3::Ones()};  // as NumPy's slices
        if ((low.array() < 0).any() || (high.array() > grid.size.array()).any() || box.empty()) {
            throw std::invalid_argument(
                "a box lies in the grid, and its low corner is below its "
                "high one");
        }
        grid.origin = physical_from_index(grid, low.cast<double>());
        grid.size = high - low;
        return with_type(info().type, [&](auto zero) {
            std::vector<decltype(zero)> samples(static_cast<std::size_t>(sample_count(grid)));
            until_ctrl_c([&](std::stop_token stop) {
                store->read(number, box, std::as_writable_bytes(std::span(samples)), stop);
            });
            return Volume(grid, std::move(samples));
        });
    }
};

void bind_store(py::module_& module) {
    py::class_<OpenStore>(
        module, "Store",
        "Samples that are read by the box, at one or more levels of detail: from\n"
        "open_store(). Nothing is held but what is asked for.")
        .def_property_readonly("address", [](const OpenStore& s) { return s.info().address; })
        .def_property_readonly(
            "format", [](const OpenStore& s) { return s.info().format; },
            "For people: 'OME-Zarr 0.5', 'NRRD', 'raw'.")
        .def_property_readonly(
            "type", [](const OpenStore& s) { return s.info().type; },
            "'uint8', 'int16', 'uint16' or 'float32'.")
        .def_property_readonly(
            "levels",
            [](const OpenStore& s) {
                std::vector<Geometry> grids;
                for (const stream::Level& level : s.info().levels) grids.push_back(level.geometry);
                return grids;
            },
            "The Geometry of each level, the finest first.")
        .def_property_readonly(
            "range",
            [](const OpenStore& s) -> std::optional<std::pair<double, double>> {
                if (!s.info().range) return std::nullopt;
                return std::pair(s.info().range->minimum, s.info().range->maximum);
            },
            "(least, greatest) sample of the finest level, where the store says it; else None.")
        .def_property_readonly("channels", [](const OpenStore& s) { return s.info().channels; })
        .def_property_readonly("notes", [](const OpenStore& s) { return s.info().notes; })
        .def("read", &OpenStore::read, py::arg("low"), py::arg("high"), py::arg("level") = 0,
             Unlocked(),
             "The samples from index low (x, y, z) to before high, as a Volume in its place.\n"
             "Raises InputError where a piece is damaged or cannot be had.")
        .def("__repr__", [](const OpenStore& s) {
            const Index3& size = s.info().levels.front().geometry.size;
            return py::str("Store({!r}, {}, {}x{}x{} {}, {} levels)")
                .format(text_of_path(s.info().address), s.info().format, size[0], size[1], size[2],
                        std::string(name_of(s.info().type)), s.info().levels.size());
        });
}

std::string content_of(const OpenStore& from, int level) {
    (void)stream::level_of(*from.store, level);  // throws where there is none
    return until_ctrl_c(
        [&](const std::stop_token& stop) { return stream::content_of(*from.store, level, stop); });
}

void bind_open_store(py::module_& module) {
    module.def(
        "open_store",
        [](const fs::path& place, std::optional<io::RawLayout> raw, std::optional<Vec3> spacing,
           std::string orientation, int channel, int time, const fs::path& cache,
           bool forbidden_is_missing) {
            check_numbers("spacing", spacing, ranges::spacing);
            stream::StoreOptions options;
            options.raw = raw;
            options.spacing = spacing;
            options.orientation = std::move(orientation);
            options.channel = channel;
            options.time = time;
            options.forbidden_is_missing = forbidden_is_missing;
            options.cache_folder = cache;
            if (!cache.empty()) options.cache_bytes = std::uint64_t{4} << 30;
            const std::string address = place.string();
            run::StoreSource from;
            from.address = address;
            from.options = options;
            run::Source source;
            source.from = from;
            run::refuse_without_effect(
                run::without_effect(source),
                {{"cache", !cache.empty()}, {"forbidden_is_missing", forbidden_is_missing}});
            const OpenStore opened{
                destroyed_here_only(stream::open_store(address, options, ctrl_c())), address,
                options};
            if (opened.info().format != "raw") {
                run::refuse_without_effect({{{"raw"}, address + " describes its own samples"}},
                                           {{"raw", raw.has_value()}});
            }
            return opened;
        },
        py::arg("address"), py::kw_only(), py::arg("raw") = py::none(),
        py::arg("spacing") = py::none(), py::arg("orientation") = "", py::arg("channel") = 0,
        py::arg("time") = 0, py::arg("cache") = "", py::arg("forbidden_is_missing") = false,
        Unlocked(),
        "Opens what is read by the box: OME-Zarr and other chunked formats, folders or http://,\n"
        "https:// and s3:// addresses, and plain files whose samples are not compressed\n"
        "(docs/streaming.md). cache: a folder that keeps what came over the network.\n"
        "forbidden_is_missing: chunks for which the server answers 403 are not stored, as with\n"
        "S3. Reads headers only. Raises InputError.");
    // For palpate.distributed.
    module.def("_content_of", &content_of, Unlocked());
    module.def(
        "_files_at",
        [](const std::string& address) {
            return until_ctrl_c(
                [&](const std::stop_token& stop) { return stream::files_at(address, stop); });
        },
        Unlocked());
}

/// A store as what a Run feels, which brings its samples into memory as they are needed.
run::LoadedVolume loaded_from(const OpenStore& store, int level, std::uint64_t memory_bytes) {
    (void)stream::level_of(*store.store, level);  // throws where there is none
    run::StoreSource from;
    from.address = store.address;
    from.options = store.options;
    from.loader.level = level;
    from.loader.memory = memory_bytes;
    run::Source source;
    source.from = from;
    source.frame = from.options.time;
    run::LoadedVolume loaded = run::load(source, ctrl_c());
    if (loaded.streamed) loaded.streamed->store = destroyed_here_only(loaded.streamed->store);
    return loaded;
}

void bind_loaded_store(py::module_& module) {
    py::class_<run::LoadedVolume>(module.attr("LoadedVolume"))
        .def(py::init(&loaded_from), py::arg("store"), py::kw_only(), py::arg("level") = 0,
             py::arg("memory_bytes") = stream::BrickLoaderSettings{}.memory, Unlocked(),
             "A Store, for Run: felt at this level while it is read. memory_bytes: most that its\n"
             "samples take.");
}

}  // namespace

void bind_stores(py::module_& module) {
    bind_store(module);
    bind_open_store(module);
    bind_loaded_store(module);
}

}  // namespace palpate::python
