// Makes volumes of IMAGE messages.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "bridge/bytes.hpp"
#include "bridge/wire.hpp"

namespace palpate::bridge {
namespace {

constexpr std::size_t image_header_bytes = 72;

struct ImageHeader {
    unsigned scalar = 0;
    bool big_endian = false;
    Geometry geometry;
};

/// Bytes of a scalar type by its number; 0 for one that there is not.
std::size_t bytes_of(unsigned scalar) {
    constexpr std::array<std::size_t, 12> sizes{0, 0, 1, 1, 2, 2, 4, 4, 0, 0, 4, 8};
    return scalar < sizes.size() ? sizes[scalar] : 0;
}

Vec3 vector_at(std::string_view content, std::size_t at) {
    return {double(number_at<float>(content, at)), double(number_at<float>(content, at + 4)),
            double(number_at<float>(content, at + 8))};
}

/// The place of the grid: columns are directions times spacing, the position is that of its centre.
/// (As Slicer reads and writes it.)
void read_place(std::string_view content, bool ras, Geometry& geometry) {
    const Vec3 sign = ras ? Vec3(-1, -1, 1) : Vec3(1, 1, 1);
    Vec3 to_centre = Vec3::Zero();
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3 step = vector_at(content, 12 + 12 * static_cast<std::size_t>(axis));
        geometry.spacing[axis] = step.norm();
        if (!(geometry.spacing[axis] > 0) || !std::isfinite(geometry.spacing[axis])) {
            throw WireError("an IMAGE whose axes have no length");
        }
        geometry.direction.col(axis) = sign.cwiseProduct(step / geometry.spacing[axis]);
        to_centre += 0.5 * (geometry.size[axis] - 1) * sign.cwiseProduct(step);
    }
    geometry.origin = sign.cwiseProduct(vector_at(content, 48)) - to_centre;
}

ImageHeader read_header(std::string_view content) {
    if (content.size() < image_header_bytes) throw WireError("an IMAGE that is cut off");
    ImageHeader header;
    header.scalar = number_at<std::uint8_t>(content, 3);
    const unsigned components = number_at<std::uint8_t>(content, 2);
    const unsigned endian = number_at<std::uint8_t>(content, 4);
    const unsigned space = number_at<std::uint8_t>(content, 5);
    const std::size_t bytes = bytes_of(header.scalar);
    if (components != 1) throw WireError("an IMAGE of several components: only one can be touched");
    if (bytes == 0) throw WireError("an IMAGE of an unknown scalar type");
    if (endian != 1 && endian != 2) throw WireError("an IMAGE of an unknown order of bytes");
    if (space != 1 && space != 2) throw WireError("an IMAGE in an unknown space");
    header.big_endian = endian == 1;
    std::uint64_t count = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const unsigned size = number_at<std::uint16_t>(content, 6 + 2 * axis);
        const bool whole = number_at<std::uint16_t>(content, 60 + 2 * axis) == 0 &&
                           number_at<std::uint16_t>(content, 66 + 2 * axis) == size;
        if (!whole) throw WireError("an IMAGE that is a part of a volume: send it whole");
        header.geometry.size[static_cast<int>(axis)] = static_cast<int>(size);
        count *= size;
    }
    if (count == 0 || count != (content.size() - image_header_bytes) / bytes ||
        count * bytes != content.size() - image_header_bytes) {
        throw WireError("an IMAGE whose size is not that of its samples");
    }
    read_place(content, space == 1, header.geometry);
    return header;
}

template <class From>
From sample_at(const char* at, bool big_endian) {
    std::array<char, sizeof(From)> bytes;
    std::memcpy(bytes.data(), at, sizeof(From));
    if (big_endian != (std::endian::native == std::endian::big)) std::ranges::reverse(bytes);
    return std::bit_cast<From>(bytes);
}

template <class From, class To>
Volume volume_as(const ImageHeader& header, std::string_view samples) {
    std::vector<To> converted(samples.size() / sizeof(From));
    for (std::size_t i = 0; i < converted.size(); ++i) {
        converted[i] =
            static_cast<To>(sample_at<From>(samples.data() + i * sizeof(From), header.big_endian));
    }
    return {header.geometry, std::move(converted)};
}

Volume volume_in(const ImageHeader& header, std::string_view samples) {
    switch (header.scalar) {
        case 2:
            return volume_as<std::int8_t, std::int16_t>(header, samples);
        case 3:
            return volume_as<std::uint8_t, std::uint8_t>(header, samples);
        case 4:
            return volume_as<std::int16_t, std::int16_t>(header, samples);
        case 5:
            return volume_as<std::uint16_t, std::uint16_t>(header, samples);
        case 6:
            return volume_as<std::int32_t, float>(header, samples);
        case 7:
            return volume_as<std::uint32_t, float>(header, samples);
        case 10:
            return volume_as<float, float>(header, samples);
        default:
            return volume_as<double, float>(header, samples);
    }
}

}  // namespace

Volume volume_of(const Received& received) {
    const ImageHeader header = read_header(received.content);
    try {
        return volume_in(header, std::string_view(received.content).substr(image_header_bytes));
    } catch (const std::invalid_argument& e) {
        throw WireError(std::string("an IMAGE that is no volume: ") + e.what());
    }
}

}  // namespace palpate::bridge
