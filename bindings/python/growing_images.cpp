// Images that grow chunk by chunk, folders of unfinished results, and whole files, for the commands
// that are written in Python. Reading and writing runs without the GIL.
#include "palpate/stream/growing_image.hpp"

#include "bindings/python/bindings.hpp"
#include "io/system/growing_folder.hpp"
#include "io/system/result_folder.hpp"
#include "palpate/io/output.hpp"

namespace palpate::python {
namespace {

namespace fs = std::filesystem;
using Unlocked = py::call_guard<GilReleased>;

std::unique_ptr<stream::GrowingImage> growing_image(const fs::path& folder, SampleType type,
                                                    const Geometry& finest,
                                                    const std::string& ome_version, int chunk,
                                                    stream::Compression compression,
                                                    const std::string& temporary) {
    if (ome_version != "0.4" && ome_version != "0.5") {
        throw std::invalid_argument("no OME-Zarr " + ome_version + "; there are 0.4 and 0.5");
    }
    stream::ConvertOptions options;
    options.zarr_version = ome_version == "0.4" ? 2 : 3;
    options.chunk = chunk;
    options.compression = compression;
    return std::make_unique<stream::GrowingImage>(folder, type, finest, options, temporary);
}

/// The chunks of a box of samples; its corners are borders of chunks, or of the grid.
template <class Work>
void for_chunks(const stream::GrowingImage& image, int level, const Index3& low, const Index3& high,
                Work&& work) {
    const Index3 edge = image.box(level, Index3::Zero()).high + Index3::Ones();
    const Index3& size = image.geometry(level).size;
    bool whole_chunks = true;
    for (int a = 0; a < 3; ++a) {
        whole_chunks = whole_chunks && low[a] >= 0 && low[a] % edge[a] == 0 && high[a] <= size[a] &&
                       (high[a] == size[a] || high[a] % edge[a] == 0);
    }
    if (!whole_chunks) {
        throw std::invalid_argument("a block ends where chunks end");
    }
    const Index3 first = low.array() / edge.array();
    const Index3 last = (high.array() - 1) / edge.array();
    for (int z = first[2]; z <= last[2]; ++z) {
        for (int y = first[1]; y <= last[1]; ++y) {
            for (int x = first[0]; x <= last[0]; ++x) work(Index3(x, y, z));
        }
    }
}

/// A box out of a volume whose first sample has the index `low`, x fastest.
std::vector<std::byte> part_of(const Volume& volume, const Index3& low, const SampleBox& box) {
    const std::size_t each = size_of(volume.type());
    const Index3 size = box.high - box.low + Index3::Ones();
    const std::size_t row = static_cast<std::size_t>(size[0]) * each;
    const auto* const all = static_cast<const std::byte*>(volume.data());
    const Index3& whole = volume.geometry().size;
    std::vector<std::byte> samples;
    samples.reserve(row * static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(size[2]));
    for (int z = box.low[2]; z <= box.high[2]; ++z) {
        for (int y = box.low[1]; y <= box.high[1]; ++y) {
            const auto line = std::int64_t{z - low[2]} * whole[1] + (y - low[1]);
            const auto* const at =
                all + static_cast<std::size_t>(line * whole[0] + box.low[0] - low[0]) * each;
            samples.insert(samples.end(), at, at + row);
        }
    }
    return samples;
}

void write_block(const stream::GrowingImage& image, const Index3& low, const Volume& block) {
    for_chunks(image, 0, low, low + block.geometry().size, [&](const Index3& chunk) {
        image.write(0, chunk, part_of(block, low, image.box(0, chunk)));
    });
}

void make_coarser(const stream::GrowingImage& image, int level, const Index3& low,
                  const Index3& high) {
    for_chunks(image, level, low, high, [&](const Index3& chunk) {
        image.write(level, chunk, image.means(level, chunk, {}));
    });
}

/// Python does not say when an object is deleted, so a folder is released explicitly.
template <class Folder>
struct OpenFolder {
    std::unique_ptr<Folder> folder;

    Folder& open() const {
        if (!folder) throw std::invalid_argument("this folder is closed");
        return *folder;
    }
    void close() { folder.reset(); }
};
using Growing = OpenFolder<io::GrowingFolder>;
using Results = OpenFolder<io::ResultFolder>;

Growing resumable(const fs::path& out, const std::string& job) {
    return {std::unique_ptr<io::GrowingFolder>(
        new io::GrowingFolder(io::GrowingFolder::resumable(out, job)))};
}

void bind_folders(py::module_& module) {
    module.def("_check_resumable", &io::GrowingFolder::check_resumable, py::arg("out"),
               py::arg("job"));
    py::class_<Growing>(module, "_GrowingFolder")
        .def(py::init(&resumable), py::arg("out"), py::arg("job"))
        .def_property_readonly("note", [](const Growing& folder) { return folder.open().note(); })
        .def(
            "put_in_place", [](const Growing& folder) { folder.open().put_in_place(); }, Unlocked())
        .def("close", &Growing::close);
    py::class_<Results>(module, "_ResultFolder")
        .def(py::init([](const fs::path& folder) {
                 return Results{std::make_unique<io::ResultFolder>(folder)};
             }),
             py::arg("folder"))
        .def_property_readonly("part", [](const Results& results) { return results.open().part(); })
        .def(
            "complete", [](const Results& results) { results.open().complete(); }, Unlocked())
        .def("close", &Results::close);
    module.def(
        "_write_file",
        [](const fs::path& path, const std::string& bytes) { io::write_file(path, bytes); },
        py::arg("path"), py::arg("bytes"), Unlocked());
}

}  // namespace

void bind_growing_images(py::module_& module) {
    using stream::GrowingImage;
    module.attr("_COMPRESSIONS") = py::tuple(py::cast(all_names<stream::Compression>()));
    py::class_<GrowingImage>(module, "_GrowingImage")
        .def(py::init(&growing_image), py::arg("folder"), py::arg("type"), py::arg("finest"),
             py::arg("ome_version"), py::arg("chunk"), py::arg("compression"), py::arg("temporary"))
        .def_property_readonly("levels",
                               [](const GrowingImage& image) {
                                   std::vector<Geometry> grids;
                                   for (int l = 0; l < image.levels(); ++l)
                                       grids.push_back(image.geometry(l));
                                   return grids;
                               })
        .def(
            "write_metadata",
            [](const GrowingImage& image, std::optional<std::pair<double, double>> range) {
                image.write_metadata(range
                                         ? std::optional(stream::Range{range->first, range->second})
                                         : std::nullopt);
            },
            py::arg("range") = py::none(), Unlocked())
        .def("write", &write_block, py::arg("low"), py::arg("block"), Unlocked())
        .def("make_coarser", &make_coarser, py::arg("level"), py::arg("low"), py::arg("high"),
             Unlocked());
    bind_folders(module);
}

}  // namespace palpate::python
