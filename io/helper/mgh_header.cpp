// Reads headers of FreeSurfer's MGH, packed (MGZ) or not, whatever the file's name. Format:
// https://surfer.nmr.mgh.harvard.edu/fswiki/FsTutorial/MghFormat. Numbers are big-endian.
#include <cmath>
#include <map>

#include "io/byte_order.hpp"
#include "io/helper/headers.hpp"

namespace palpate::io {
namespace {

constexpr std::size_t first_sample = 284;

using Bytes = std::span<const std::byte>;

Stored stored_as(std::int32_t type) {
    static const std::map<std::int32_t, Stored> types = {{0, Stored::uint8},
                                                         {1, Stored::int32},
                                                         {3, Stored::float32},
                                                         {4, Stored::int16},
                                                         {10, Stored::uint16}};
    const auto found = types.find(type);
    if (found != types.end()) return found->second;
    throw Failure("it has samples of type " + std::to_string(type) +
                  ", which is not read; save it as float (mri_convert -odt float)");
}

/// The header gives the distances of samples, the directions of the axes, and the place of the
/// sample in the middle, counted from 0: that of half the size. All are in RAS.
Geometry grid_of(Bytes header, std::vector<std::string>& notes) {
    const auto real = [&](std::size_t at) {
        return static_cast<double>(big_endian<float>(header.subspan(at)));
    };
    Geometry g;
    for (int axis = 0; axis < 3; ++axis) {
        g.size[axis] =
            big_endian<std::int32_t>(header.subspan(4 + 4 * static_cast<std::size_t>(axis)));
    }
    if (big_endian<std::int16_t>(header.subspan(28)) <= 0) {
        g.oriented = g.measured = false;
        g.direction << 1, 0, 0, 0, 0, -1, 0, -1, 0;
        g.origin = -0.5 * (g.direction * g.size.cast<double>());
        notes.emplace_back(
            "its header does not give its place (goodRASFlag): 1 mm was taken along every axis, "
            "and coronal slices around the origin, as FreeSurfer does");
        return g;
    }
    const Vec3 to_lps(-1, -1, 1);
    g.origin = to_lps.cwiseProduct(Vec3(real(78), real(82), real(86)));
    for (int axis = 0; axis < 3; ++axis) {
        const std::size_t at = 42 + 12 * static_cast<std::size_t>(axis);
        const Vec3 direction = to_lps.cwiseProduct(Vec3(real(at), real(at + 4), real(at + 8)));
        const double length = direction.norm();
        g.spacing[axis] = real(30 + 4 * static_cast<std::size_t>(axis)) * length;
        check_spacing(g.spacing[axis], "header");
        g.direction.col(axis) = (direction / length).array() + 0.0;  // no -0
        g.origin -= g.direction.col(axis) * (g.spacing[axis] * g.size[axis] / 2);
    }
    g.origin.array() += 0.0;
    g.oriented = true;
    return g;
}

}  // namespace

VolumeHeader mgh_header(const Request& request) {
    const std::vector<std::byte> start = start_of(request.path, first_sample);
    const Bytes bytes(start);
    // Since FreeSurfer 7.3, the version has its two middle bytes for the intent (labels, ...).
    constexpr std::uint32_t intent = 0x00ffff00;
    if (start.size() < first_sample || (big_endian<std::uint32_t>(bytes) & ~intent) != 1) {
        throw Failure(
            "is no MGH file (it does not begin with version 1), or is cut off; check its "
            "name or copy it again");
    }
    VolumeHeader header;
    header.format = "MGH";
    header.stored = stored_as(big_endian<std::int32_t>(bytes.subspan(20)));
    for (std::size_t axis = 0; axis < 4; ++axis) {
        header.sizes.push_back(big_endian<std::int32_t>(bytes.subspan(4 + 4 * axis)));
    }
    checked_bytes(header.sizes, size_of(header.stored), std::filesystem::file_size(request.path),
                  request);
    DataPlace& place = header.places.front();
    place.file = request.path;
    place.skip = first_sample;
    place.swapped = std::endian::native == std::endian::little;
    place.footer = DataPlace::Footer::tags;
    if (is_gzip(request.path)) place.encoding = DataPlace::Encoding::compressed;
    header.geometry = grid_of(bytes, header.notes);
    header.steps = header.sizes[3];
    header.together = static_cast<std::int64_t>(header.samples()) / header.steps;
    return header;
}

}  // namespace palpate::io
