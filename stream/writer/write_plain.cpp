// Writes a level of a store as one file. See convert.hpp.
#include <algorithm>
#include <atomic>
#include <charconv>

#include "palpate/io/output.hpp"
#include "palpate/io/written_formats.hpp"
#include "palpate/stream/convert.hpp"
#include "stream/box_bytes.hpp"
#include "stream/formats/content.hpp"
#include "stream/objects/objects.hpp"
#include "stream/while_telling.hpp"

namespace palpate::stream {
namespace {

/// A number with the digits that read back the same.
std::string exact(double number) {
    std::array<char, 32> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), number).ptr;
    return {text.data(), end};
}

std::string in_brackets(const Vec3& v) {
    return "(" + exact(v[0]) + "," + exact(v[1]) + "," + exact(v[2]) + ")";
}

std::string nrrd_head(const Geometry& grid, SampleType type) {
    std::string directions;
    for (int a = 0; a < 3; ++a) {
        directions += " " + in_brackets(grid.direction.col(a) * grid.spacing[a]);
    }
    const std::string name = type == SampleType::float32 ? "float" : std::string(name_of(type));
    const std::string space = grid.oriented ? "left-posterior-superior" : "3D-right-handed";
    return "NRRD0004\ntype: " + name + "\ndimension: 3\nspace: " + space +
           "\nsizes: " + std::to_string(grid.size[0]) + " " + std::to_string(grid.size[1]) + " " +
           std::to_string(grid.size[2]) + "\nspace directions:" + directions +
           "\nkinds: domain domain domain\nendian: little\nencoding: raw\nspace origin: " +
           in_brackets(grid.origin) + "\n\n";
}

/// Slabs as thick as a stored chunk, so that each chunk is read once, but of at most 64 MiB.
int slab_of(const Level& level, SampleType type) {
    const double row = static_cast<double>(level.geometry.size[0]) * level.geometry.size[1] *
                       static_cast<double>(size_of(type));
    constexpr double most = 64 << 20;
    return std::clamp(static_cast<int>(most / row), 1, std::max(1, level.chunk[2]));
}

void write_slabs(const Store& from, int level, io::PendingFile& file, std::atomic<double>& made,
                 const std::stop_token& stop) {
    const Level& grid = level_of(from, level);
    const Index3& size = grid.geometry.size;
    const int slab = slab_of(grid, from.info().type);
    Bytes samples;
    for (int z = 0; z < size[2]; z += slab) {
        const SampleBox box{Index3(0, 0, z),
                            Index3(size[0] - 1, size[1] - 1, std::min(z + slab, size[2]) - 1)};
        samples.resize(bytes_of(box, from.info().type));
        from.read(level, box, samples, stop);
        file.write({reinterpret_cast<const char*>(samples.data()), samples.size()});
        made = static_cast<double>(box.high[2] + 1) / size[2];
    }
}

}  // namespace

void write_plain(const Store& from, int level, const std::filesystem::path& out,
                 const io::WriteOptions& options) {
    const Geometry& grid = level_of(from, level).geometry;
    const std::string problem = io::why_not_written(out, grid, options.compress);
    if (!problem.empty()) throw io::OutputError(problem);
    const std::string_view extension = io::written_extension_of(out);
    const bool raw = extension == ".raw";
    if (raw || (extension == ".nrrd" && !options.compress)) {
        io::PendingFile file(out);
        if (!raw) file.write(nrrd_head(grid, from.info().type));
        const auto files_now = [&](const std::stop_token& stop) {
            return files_at(from.info().address, stop);
        };
        std::uint64_t files = 0;
        while_telling(options.progress, [&](const std::stop_token& stop, auto& made) {
            files = files_now(stop);
            write_slabs(from, level, file, made, stop);
        });
        io::Progress at_end;
        if (options.progress) at_end = [&](double) { options.progress(1); };
        if (while_telling(at_end, files_now) != files) fail_changed(from);
        file.commit();
        return;
    }
    io::write_volume(read_level(from, level, options.progress), out, options);
}

}  // namespace palpate::stream
