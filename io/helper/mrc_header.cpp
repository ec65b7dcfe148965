// Reads headers of MRC files (cryo-electron microscopy, tomography), in either byte order. Format:
// https://www.ccpem.ac.uk/mrc_format/mrc2014.php, and that of IMOD for bytes without a sign.
// Lengths are in Angstrom.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "io/byte_order.hpp"
#include "io/helper/headers.hpp"

namespace palpate::io {
namespace {

constexpr std::size_t mrc_header_bytes = 1024;
constexpr double angstrom = 1e-7;  // [mm]

/// The header's numbers, by the place of their first byte.
class MrcNumbers {
  public:
    /// A stamp tells the order of the bytes. Older files have none, and some programs write that
    /// of another machine: the order is one in which the numbers make sense.
    MrcNumbers(std::span<const std::byte> bytes, std::vector<std::string>& notes) : bytes_(bytes) {
        const auto stamp = std::to_integer<int>(bytes[212]);
        swapped_ = (stamp == 0x11) == (std::endian::native == std::endian::little);
        if (makes_sense()) return;
        swapped_ = !swapped_;
        if (!makes_sense()) {
            swapped_ = !swapped_;
        } else if (stamp == 0x11 || stamp == 0x44) {
            notes.emplace_back(
                "its machine stamp gives the wrong order of bytes: that in which its header makes "
                "sense was taken");
        }
    }
    std::int32_t whole(std::size_t at) const {
        return number_in<std::int32_t>(bytes_.subspan(at), swapped_);
    }
    double real(std::size_t at) const { return number_in<float>(bytes_.subspan(at), swapped_); }
    bool swapped() const { return swapped_; }
    bool has_letters() const { return std::memcmp(bytes_.data() + 208, "MAP", 3) == 0; }

  private:
    bool makes_sense() const {
        return whole(12) >= 0 && whole(12) <= 101 && whole(0) > 0 && whole(0) < 1 << 20;
    }

    std::span<const std::byte> bytes_;
    bool swapped_ = false;
};

/// Bytes have a sign, unless IMOD's flags say otherwise, or the header's greatest value.
bool has_unsigned_bytes(const MrcNumbers& header, std::vector<std::string>& notes) {
    constexpr std::int32_t stamp_of_imod = 1146047817;
    if (header.whole(152) == stamp_of_imod) return (header.whole(156) & 1) == 0;
    const double most = header.real(80);
    if (!(most > 127 && most <= 255)) return false;
    notes.push_back("its header's greatest value is " + text_of(most) +
                    ": its bytes were taken as unsigned");
    return true;
}

Stored sample_type(const MrcNumbers& header, std::vector<std::string>& notes) {
    const std::int32_t mode = header.whole(12);
    if (mode == 0) return has_unsigned_bytes(header, notes) ? Stored::uint8 : Stored::int8;
    if (mode == 1) return Stored::int16;
    if (mode == 2) return Stored::float32;
    if (mode == 6) return Stored::uint16;
    if (mode == 12) return Stored::float16;
    throw Failure("it has samples of mode " + std::to_string(mode) +
                  " (complex, colours or half bytes), which is not read; save it with mode 1 or 2");
}

/// The axes of the cell (0: x) along columns, rows and sections.
std::array<int, 3> cell_axes(const MrcNumbers& header) {
    std::array<int, 3> axes{header.whole(64) - 1, header.whole(68) - 1, header.whole(72) - 1};
    if (axes == std::array{-1, -1, -1}) return {0, 1, 2};  // of files before MRC 2000
    if (std::array sorted = axes; std::ranges::sort(sorted), sorted != std::array{0, 1, 2}) {
        throw Failure("its header's MAPC, MAPR and MAPS are no order of its axes; correct them");
    }
    return axes;
}

/// The first sample lies at the origin, or if that is 0, at the header's start of the map.
Geometry mrc_grid(const MrcNumbers& header, std::vector<std::string>& notes) {
    Geometry g;
    g.oriented = false;
    for (const std::size_t at : {52U, 56U, 60U}) {
        const double angle = header.real(at);
        if (angle == 0 || std::abs(angle - 90) < 0.01) continue;
        throw Failure("its cell is not at right angles (" + text_of(angle) +
                      " degrees); resample it on a rectangular grid");
    }
    const Vec3 told(header.real(196), header.real(200), header.real(204));
    const bool has_origin = told.allFinite() && !told.isZero(0);
    const std::array<int, 3> axes = cell_axes(header);
    g.direction.setZero();
    for (int column = 0; column < 3; ++column) {
        const auto field = 4 * static_cast<std::size_t>(column);
        const int axis = axes[static_cast<std::size_t>(column)];
        const auto along = 4 * static_cast<std::size_t>(axis);
        const double cell = header.real(40 + along), samples = header.whole(28 + along);
        const double spacing = angstrom * cell / samples;
        g.measured = g.measured && samples > 0 && cell > 0 && std::isfinite(spacing);
        if (g.measured) g.spacing[column] = spacing;
        g.size[column] = header.whole(field);
        g.direction(axis, column) = 1;
        const double start = header.whole(16 + field) * g.spacing[column];
        g.origin[axis] = has_origin ? angstrom * told[axis] : start;
    }
    if (!g.measured) {
        g.spacing = Vec3::Ones();
        g.origin = Vec3::Zero();
        notes.emplace_back("its header gives no size of its cell: 1 mm was taken along every axis");
    }
    return g;
}

/// Whether the header of a scan of Philips lies beside it, whose samples may begin as anything.
bool is_of_par(std::filesystem::path file) {
    if (extension_of(file) != ".rec") return false;
    std::error_code error;
    return std::ranges::any_of(std::array{".par", ".PAR"}, [&](const char* extension) {
        return std::filesystem::exists(file.replace_extension(extension), error);
    });
}

}  // namespace

VolumeHeader mrc_header(const Request& request) {
    const std::vector<std::byte> start = start_of(request.path, mrc_header_bytes);
    if (start.size() < mrc_header_bytes) {
        throw Failure(
            "is too short for the header of an MRC file; check its name or copy it again");
    }
    VolumeHeader header;
    const MrcNumbers numbers(start, header.notes);
    if (!numbers.has_letters() && is_of_par(request.path)) throw Failure(parrec_advice);
    // Older files have no letters, but the order of their axes.
    if (!numbers.has_letters() && (numbers.whole(64) < 0 || numbers.whole(64) > 3)) {
        throw Failure("is no MRC file (it has no letters MAP at byte 208); check its name");
    }
    header.format = "MRC";
    header.stored = sample_type(numbers, header.notes);
    for (const std::size_t at : {0U, 4U, 8U}) header.sizes.push_back(numbers.whole(at));
    checked_bytes(header.sizes, size_of(header.stored), std::filesystem::file_size(request.path),
                  request);
    const std::int32_t extended = numbers.whole(92), kind = numbers.whole(88);
    if (extended < 0) throw Failure("its header's NSYMBT is below 0; correct it");
    DataPlace& place = header.places.front();
    place.file = request.path;
    place.skip = mrc_header_bytes + static_cast<std::uint64_t>(extended);
    place.swapped = numbers.swapped();
    if (is_gzip(request.path)) place.encoding = DataPlace::Encoding::compressed;
    header.geometry = mrc_grid(numbers, header.notes);
    // Volumes behind each other (ISPG 401 and later) have as many sections as the cell samples.
    const std::int32_t sections = numbers.whole(36);
    if (kind >= 401 && sections > 0 && header.sizes[2] % sections == 0) {
        header.steps = header.sizes[2] / sections;
        header.geometry.size[2] = sections;
    }
    header.together = static_cast<std::int64_t>(header.samples()) / header.steps;
    return header;
}

}  // namespace palpate::io
