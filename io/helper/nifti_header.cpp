// Checks NIfTI-1 files: the 348-byte header in either byte order, packed or not, and the data's
// size.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>

#include "io/helper/headers.hpp"
#include "io/inflate.hpp"

namespace palpate::io {
namespace {

constexpr std::size_t header_bytes = 348;
constexpr std::uint64_t extra_allowed = 4096;

/// The header's bytes, and numbers from them.
struct Header {
    std::array<std::byte, header_bytes> bytes{};
    bool swapped = false;

    template <class T>
    T number(std::size_t offset) const {
        std::array<std::byte, sizeof(T)> raw;
        std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(offset), sizeof(T), raw.begin());
        if (swapped) std::reverse(raw.begin(), raw.end());
        return std::bit_cast<T>(raw);
    }
    std::string magic() const {
        const auto* text = reinterpret_cast<const char*>(bytes.data()) + 344;
        return {text, strnlen(text, 4)};
    }
};

Header read_header(const std::filesystem::path& path) {
    Header header;
    std::vector<std::byte> start;
    if (is_gzip(path)) {
        try {
            start = inflate_start(path, header_bytes);
        } catch (const DamagedStream& e) {
            throw Failure(std::string(e.what()) + "; copy or download it again");
        }
    } else {
        start.resize(header_bytes);
        std::ifstream in(path, std::ios::binary);
        in.read(reinterpret_cast<char*>(start.data()), header_bytes);
        start.resize(static_cast<std::size_t>(in.gcount()));
    }
    if (start.size() < header_bytes) {
        throw Failure("is too short for a NIfTI header (" + std::to_string(start.size()) +
                      " bytes); copy or download it again");
    }
    std::copy(start.begin(), start.end(), header.bytes.begin());
    return header;
}

/// Bytes of the whole file, unpacked up to its checksum, or up to the first one that is too many.
std::uint64_t unpacked_bytes(const std::filesystem::path& path, std::uint64_t at_most) {
    if (!is_gzip(path)) return std::filesystem::file_size(path);
    try {
        return inflate_checked(path, {0, UINT64_MAX, at_most}, {});
    } catch (const DamagedStream& e) {
        throw Failure(std::string(e.what()) + "; copy or download it again");
    }
}

void check_kind(Header& header) {
    const auto either_way = [&](std::int32_t number) {
        for (const bool swapped : {false, true}) {
            header.swapped = swapped;
            if (header.number<std::int32_t>(0) == number) return true;
        }
        return false;
    };
    if (either_way(540)) {
        throw Failure("is a NIfTI-2 file, which is not read; save it as NIfTI-1 or NRRD");
    }
    if (!either_way(348)) {
        throw Failure("is not a NIfTI file (its first number is not 348); check its name");
    }
    if (header.magic() == "ni1") {
        throw Failure("is one half of a .hdr/.img pair; save it as one .nii file");
    }
    if (header.magic() != "n+1") {
        throw Failure("has no NIfTI magic (perhaps an Analyze file); save it as .nii");
    }
}

Stored stored_from(std::int16_t type) {
    static const std::map<int, Stored> types = {
        {2, Stored::uint8},    {4, Stored::int16},    {8, Stored::int32},    {16, Stored::float32},
        {64, Stored::float64}, {256, Stored::int8},   {512, Stored::uint16}, {768, Stored::uint32},
        {1024, Stored::int64}, {1280, Stored::uint64}};
    const auto found = types.find(type);
    if (found == types.end()) {
        const std::string what = type == 128 || type == 2304 ? "colours"
                                 : type == 32 || type == 1792
                                     ? "complex numbers"
                                     : "samples of type " + std::to_string(type);
        throw Failure("it has " + what + ", which cannot be felt; save it as int16 or float32");
    }
    return found->second;
}

/// pixdim[4], toffset and the time bits of xyzt_units.
FrameTimes times_of(const Header& header, std::vector<std::string>& notes) {
    static const std::map<int, std::string> units = {{0, ""}, {8, "s"}, {16, "ms"}, {24, "us"}};
    const auto unit = units.find(header.number<std::uint8_t>(123) & 0x38);
    return frame_times(header.number<float>(92), header.number<float>(136),
                       unit == units.end() ? "no time" : unit->second, notes);
}

/// The numbers that ITK decomposes into spacing and directions.
void check_placement(const Header& header, std::vector<std::string>& notes) {
    for (const std::size_t axis : {1U, 2U, 3U}) {  // also of axes that are one sample thick
        const auto spacing = header.number<float>(76 + 4 * axis);
        if (std::abs(spacing) <= greatest_length) continue;
        throw Failure("its header field 'pixdim' has the number " + text_of(double{spacing}) +
                      "; correct the header");
    }
    if (header.number<std::int16_t>(252) > 0) {
        for (const std::size_t at : {256U, 260U, 264U}) {
            if (std::abs(header.number<float>(at)) <= 1.01F) continue;
            throw Failure("its header field 'quatern' is no rotation; correct the header");
        }
        for (const std::size_t at : {268U, 272U, 276U}) {
            check_coordinate(header.number<float>(at), "header field 'qoffset'");
        }
    }
    if (header.number<std::int16_t>(254) <= 0) return;
    const auto entry = [&](std::size_t row, std::size_t column) {
        return static_cast<double>(header.number<float>(280 + 16 * row + 4 * column));
    };
    for (std::size_t row = 0; row < 3; ++row)
        check_coordinate(entry(row, 3), "header field 'srow'");
    for (std::size_t column = 0; column < 3; ++column) {
        const double length = std::hypot(entry(0, column), entry(1, column), entry(2, column));
        const bool measures = header.number<std::int16_t>(42 + 2 * column) > 1;
        if (measures || length != 0) check_spacing(length, "header field 'srow'");
        const double spacing = header.number<float>(80 + 4 * column);
        if (!measures || std::abs(length - spacing) <= 0.01 * spacing) continue;
        notes.push_back("its header gives two spacings along axis " + std::to_string(column + 1) +
                        ": " + text_of(spacing) + " mm (pixdim) was taken, not " + text_of(length) +
                        " mm (srow)");
    }
}

/// As ITK takes it: a slope of 0 means none.
void take_scaling(const Header& header, NiftiHeader& facts) {
    const double slope = header.number<float>(112), intercept = header.number<float>(116);
    if (!std::isfinite(slope) || !std::isfinite(intercept) || slope == 0) return;
    facts.slope = slope;
    facts.intercept = intercept;
}

}  // namespace

NiftiHeader check_nifti(const Request& request) {
    Header header = read_header(request.path);
    check_kind(header);
    NiftiHeader facts;
    facts.stored = stored_from(header.number<std::int16_t>(70));
    if (header.number<std::int16_t>(72) != static_cast<int>(8 * size_of(facts.stored))) {
        throw Failure("its header's bits a sample do not fit its type; the header is damaged");
    }
    const int axes = header.number<std::int16_t>(40);
    if (axes < 1 || axes > 7) {
        throw Failure("its header gives " + std::to_string(axes) + " axes; the header is damaged");
    }
    for (std::size_t a = 1; a <= static_cast<std::size_t>(axes); ++a) {
        const auto size = header.number<std::int16_t>(40 + 2 * a);
        facts.sizes.push_back(size);
        const auto spacing = header.number<float>(76 + 4 * a);
        if (a <= 3 && size > 1) check_spacing(spacing, "header field 'pixdim'");
    }
    check_placement(header, facts.notes);
    const std::uint64_t bytes = checked_bytes(facts.sizes, size_of(facts.stored),
                                              std::filesystem::file_size(request.path), request);
    const float offset = header.number<float>(108);
    if (!(offset >= 348 && offset < 1e9F)) {
        throw Failure("its header puts the samples at byte " + text_of(double{offset}) +
                      "; the header is damaged");
    }
    const auto first = static_cast<std::uint64_t>(offset);
    const std::uint64_t all = unpacked_bytes(request.path, first + bytes + extra_allowed);
    const std::uint64_t start = std::min(first, all);
    if (all - start < bytes || all - start > bytes + extra_allowed) {
        throw Failure("its header asks for " + std::to_string(bytes) +
                      " bytes of samples, there are " + std::to_string(all - start) +
                      "; it is cut off or its header is wrong: copy it again");
    }
    while (facts.sizes.size() > 3 && facts.sizes.back() == 1) facts.sizes.pop_back();
    if (facts.sizes.size() > 4) {
        throw Failure("it has " + text_of(facts.sizes) +
                      " samples in more than 4 axes (vectors?); save one volume of it");
    }
    if (facts.sizes.size() == 4) facts.times = times_of(header, facts.notes);
    facts.place.file = request.path;
    facts.place.offset = first;
    facts.place.swapped = header.swapped;
    take_scaling(header, facts);
    if (header.number<std::int16_t>(252) == 0 && header.number<std::int16_t>(254) == 0) {
        facts.notes.push_back("its header says nothing of its orientation in the body");
    }
    return facts;
}

}  // namespace palpate::io
