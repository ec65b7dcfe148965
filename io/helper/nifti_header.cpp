// Reads headers of NIfTI-1 and NIfTI-2 in either byte order, packed or not, whatever the file's
// name. Formats: https://nifti.nimh.nih.gov/pub/dist/src/niftilib/nifti1.h and nifti2.h. nibabel
// decides what they leave open (docs/io.md).
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>

#include "io/byte_order.hpp"
#include "io/file_grid.hpp"
#include "io/helper/headers.hpp"
#include "io/inflate.hpp"
#include "io/straightened.hpp"

namespace palpate::io {
namespace {

/// Place of a field in NIfTI-1 and in NIfTI-2, whose numbers are wider.
struct NiftiField {
    std::size_t first, second;
};
constexpr NiftiField dim{40, 16}, datatype{70, 12}, bitpix{72, 14}, pixdim{76, 104},
    vox_offset{108, 168}, slope_field{112, 176}, intercept_field{116, 184}, xyzt_units{123, 500},
    toffset{136, 216}, qform_code{252, 344}, sform_code{254, 348}, quatern{256, 352},
    qoffset{268, 376}, srow{280, 400}, magic_field{344, 4};

/// The header's bytes, and numbers from them.
struct Header {
    std::array<std::byte, 544> bytes{};  // with those that tell of extensions
    std::size_t size = 0;                ///< [bytes] that the file has of these
    bool swapped = false;
    bool is_second = false;   ///< NIfTI-2
    bool is_analyze = false;  ///< of the format before NIfTI, which has no place in the body
    bool is_pair = false;     ///< the samples are in another file

    std::size_t header_bytes() const { return is_second ? 540 : 348; }
    template <class First, class Second>
    Second number(NiftiField field, std::size_t index = 0) const {
        const std::span all(bytes);
        return is_second
                   ? number_in<Second>(all.subspan(field.second + index * sizeof(Second)), swapped)
                   : static_cast<Second>(number_in<First>(
                         all.subspan(field.first + index * sizeof(First)), swapped));
    }
    double real(NiftiField field, std::size_t index = 0) const {
        return number<float, double>(field, index);
    }
    /// Code of a transform.
    int code(NiftiField field) const {
        return is_analyze ? 0 : number<std::int16_t, std::int32_t>(field);
    }
    int type(NiftiField field) const { return number<std::int16_t, std::int16_t>(field); }
    int unit() const { return is_analyze ? 0 : number<std::uint8_t, std::int32_t>(xyzt_units); }
    std::string magic() const {
        const std::size_t at = is_second ? magic_field.second : magic_field.first;
        const auto* text = reinterpret_cast<const char*>(bytes.data()) + at;
        return {text, strnlen(text, 4)};
    }
};

Header read_header(const std::filesystem::path& path) {
    Header header;
    const std::vector<std::byte> start = start_of(path, header.bytes.size());
    header.size = start.size();
    std::copy(start.begin(), start.end(), header.bytes.begin());
    return header;
}

/// `is_pair`: by its name, the file is one of a pair.
void check_kind(Header& header, bool is_pair) {
    const auto either_way = [&](std::int32_t number) {
        for (const bool swapped : {false, true}) {
            header.swapped = swapped;
            if (number_in<std::int32_t>(header.bytes, swapped) == number) return true;
        }
        return false;
    };
    if (is_pair && std::memcmp(header.bytes.data(), "ENVI", 4) == 0) {
        throw Failure(
            "its header is of ENVI, which is not read; read the other file as raw samples with "
            "--dims and --type");
    }
    header.is_second = either_way(540);
    const std::string number = header.is_second ? "2" : "1";
    if (header.size < header.header_bytes()) {
        throw Failure("is too short for a NIfTI-" + number + " header (" +
                      std::to_string(header.size) + " bytes); copy or download it again");
    }
    if (!header.is_second && !either_way(348)) {
        throw Failure("is not a NIfTI file (its first number is not 348); check its name");
    }
    const bool is_half = header.magic() == "ni" + number;
    header.is_analyze = is_pair && !header.is_second && header.magic() != "n+1" && !is_half;
    header.is_pair = header.is_analyze || (is_pair && is_half);
    if (header.is_pair) return;
    if (is_half) {
        throw Failure("is one half of a .hdr/.img pair; name the header .hdr and the samples .img");
    }
    if (header.magic() != "n+" + number) {
        throw Failure("has no magic of NIfTI-" + number +
                      " (perhaps an Analyze file); save it as .nii");
    }
}

Stored stored_from(int type) {
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
        throw Failure("it has " + what + ", which cannot be touched; save it as int16 or float32");
    }
    return found->second;
}

/// pixdim[4], toffset and the time bits of xyzt_units.
FrameTimes times_of(const Header& header, std::vector<std::string>& notes) {
    static const std::map<int, std::string> units = {{0, ""}, {8, "s"}, {16, "ms"}, {24, "us"}};
    const auto unit = units.find(header.unit() & 0x38);
    return frame_times(header.real(pixdim, 4), header.real(toffset),
                       unit == units.end() ? "no time" : unit->second, notes);
}

std::int64_t axes_of(const Header& header) {
    return header.number<std::int16_t, std::int64_t>(dim);
}

/// The size of an axis, counted from 0; 1 for those that the file does not have. From the second
/// one on, 0 means 1, as the reference library takes it.
std::int64_t size_of_axis(const Header& header, std::int64_t axis) {
    if (axis >= axes_of(header)) return 1;
    const auto size =
        header.number<std::int16_t, std::int64_t>(dim, static_cast<std::size_t>(axis) + 1);
    return size == 0 && axis > 0 ? 1 : size;
}

/// How long the header's unit of length is [mm].
double unit_of_length(const Header& header, std::vector<std::string>& notes) {
    static const std::array<std::string, 8> names = {"", "m", "mm", "um", "4", "5", "6", "7"};
    const std::string& name = names[static_cast<std::size_t>(header.unit() & 7)];
    if (name.empty()) add_note(notes, "its header names no unit of length: mm were taken");
    return length_unit(name, notes);
}

/// Index to physical space (LPS) [mm]: a column for the step along each axis, and one for the place
/// of the first sample.
using Transform = Eigen::Matrix<double, 3, 4>;

Transform in_lps(Transform ras, double unit) {
    ras.topRows<2>() *= -1;
    return unit * ras;
}

/// pixdim [mm], where nibabel corrects signs and zeros. No distance is measured along an axis of
/// one sample, which may have no spacing.
Vec3 spacings_of(const Header& header, double unit, std::vector<std::string>& notes) {
    Vec3 spacings;
    for (std::size_t a = 0; a < 3; ++a) {
        const double stored = header.real(pixdim, a + 1);
        const double given = stored == 0 ? 1 : std::abs(stored);
        const bool measures = size_of_axis(header, static_cast<std::int64_t>(a)) > 1;
        if (measures) check_spacing(given * unit, "header field 'pixdim'");
        if (measures && stored <= 0) {
            notes.push_back("its header field 'pixdim' gives the spacing " + text_of(stored) +
                            " along axis " + std::to_string(a + 1) + ": " + text_of(given * unit) +
                            " mm was taken");
        }
        if (!(given <= greatest_length)) {
            throw Failure("its header field 'pixdim' has the number " + text_of(given) +
                          "; correct the header");
        }
        const bool sensible = is_file_spacing(given * unit);
        spacings[static_cast<Eigen::Index>(a)] = sensible ? given * unit : 1;
    }
    return spacings;
}

/// Method 2 of the format: a quaternion, pixdim and an offset.
Transform qform_of(const Header& header, double unit, std::vector<std::string>& notes) {
    const Vec3 vector(header.real(quatern, 0), header.real(quatern, 1), header.real(quatern, 2));
    const double square = vector.squaredNorm();
    if (!(square <= 1.002)) {
        throw Failure("its header field 'quatern' is no rotation; correct the header");
    }
    // What rounding leaves of a half turn is 0, as in the reference library: its root would be an
    // angle. The limit is that of nibabel, as three rounded numbers may leave more than 1e-7.
    constexpr double rounding = 3 * std::numeric_limits<float>::epsilon();
    const double rest = 1 - square;
    const Eigen::Quaterniond rotation(rest < rounding ? 0 : std::sqrt(rest), vector[0], vector[1],
                                      vector[2]);
    const double handed = header.real(pixdim) < 0 ? -1 : 1;
    Transform ras;
    ras.leftCols<3>() = rotation.normalized().toRotationMatrix() * Vec3(1, 1, handed).asDiagonal();
    for (const std::size_t a : {0U, 1U, 2U}) {
        const double offset = header.real(qoffset, a);
        check_coordinate(offset * unit, "header field 'qoffset'");
        ras(static_cast<Eigen::Index>(a), 3) = offset;
    }
    Transform lps = in_lps(ras, unit);
    lps.leftCols<3>() =
        in_lps(ras, 1).leftCols<3>() * spacings_of(header, unit, notes).asDiagonal();
    return lps;
}

/// Method 3 of the format: twelve numbers.
Transform sform_of(const Header& header, double unit) {
    Transform ras;
    for (std::size_t i = 0; i < 12; ++i) {
        ras(static_cast<Eigen::Index>(i / 4), static_cast<Eigen::Index>(i % 4)) =
            header.real(srow, i);
    }
    Transform lps = in_lps(ras, unit);
    for (int row = 0; row < 3; ++row) check_coordinate(lps(row, 3), "header field 'srow'");
    for (int axis = 0; axis < 3; ++axis) {
        const double length = lps.col(axis).norm();
        const bool measures = size_of_axis(header, axis) > 1;
        if (measures || length != 0) check_spacing(length, "header field 'srow'");
    }
    // If only an axis of one sample has no direction, the other two determine it.
    for (int axis = 0; axis < 3; ++axis) {
        if (!lps.col(axis).isZero(0)) continue;
        const Vec3 across = lps.col((axis + 1) % 3).cross(Vec3(lps.col((axis + 2) % 3)));
        lps.col(axis) = across.normalized();
    }
    return lps;
}

/// False if the header does not give the grid's place in the body.
bool is_placed(const Header& header) {
    return header.code(qform_code) > 0 || header.code(sform_code) > 0;
}

Geometry nifti_grid(const Transform& lps, const Header& header) {
    Geometry g;
    for (int axis = 0; axis < 3; ++axis) {
        g.size[axis] = static_cast<int>(size_of_axis(header, axis));
        g.spacing[axis] = lps.col(axis).norm();
        g.direction.col(axis) = (lps.col(axis) / g.spacing[axis]).array() + 0.0;  // no -0
    }
    g.origin = lps.col(3).array() + 0.0;
    g.oriented = is_placed(header);
    return g;
}

/// A tenth of the smallest spacing is what two rounded descriptions of one grid may differ by.
void note_disagreement(const Transform& taken, const Header& header, double unit,
                       std::vector<std::string>& notes) {
    try {
        std::vector<std::string> of_qform;
        const Transform qform = qform_of(header, unit, of_qform);
        const double distance =
            distance_between(nifti_grid(taken, header), nifti_grid(qform, header));
        if (distance <= 0.1 * taken.leftCols<3>().colwise().norm().minCoeff()) return;
        notes.push_back("its sform and qform place it differently (" + text_of(distance) +
                        " mm apart): the sform was taken");
    } catch (const Failure&) {
        notes.emplace_back("its qform makes no sense: the sform was taken");
    }
}

void note_spacings(const Transform& sform, const Header& header, double unit,
                   std::vector<std::string>& notes) {
    for (int a = 0; a < 3; ++a) {
        const double taken = sform.col(a).norm();
        const double given = unit * header.real(pixdim, static_cast<std::size_t>(a) + 1);
        if (size_of_axis(header, a) <= 1 || std::abs(taken - given) <= 0.01 * taken) continue;
        notes.push_back("its header gives two spacings along axis " + std::to_string(a + 1) + ": " +
                        text_of(taken) + " mm (sform) was taken, not " + text_of(given) +
                        " mm (pixdim)");
    }
}

/// Whether its directions are all zero, or a number of it is not finite.
bool is_empty_sform(const Header& header) {
    bool has_direction = false, is_finite = true;
    for (std::size_t i = 0; i < 12; ++i) {
        has_direction = has_direction || (i % 4 != 3 && header.real(srow, i) != 0);
        is_finite = is_finite && std::isfinite(header.real(srow, i));
    }
    return !has_direction || !is_finite;
}

/// Whether its axes are of length 1 where the header gives other spacings and a qform with them:
/// some programs write directions without spacings.
bool has_no_spacings(const Transform& sform, const Header& header, double unit) {
    bool other = false;
    for (int axis = 0; axis < 3; ++axis) {
        const double given = std::abs(header.real(pixdim, static_cast<std::size_t>(axis) + 1));
        if (std::abs(sform.col(axis).norm() - unit) > 1e-4 * unit) return false;
        other =
            other || (size_of_axis(header, axis) > 1 && given > 0 && std::abs(given - 1) > 0.01);
    }
    return other && header.code(qform_code) > 0;
}

/// The sform goes before the qform, unless no grid can be as it says.
Transform transform_of(const Header& header, std::vector<std::string>& notes) {
    const double unit = unit_of_length(header, notes);
    const bool has_qform = header.code(qform_code) > 0;
    bool has_sform = header.code(sform_code) > 0;
    if (has_sform && has_qform && is_empty_sform(header)) {
        notes.emplace_back("its sform is all zeros or not finite: its qform was taken");
        has_sform = false;
    }
    if (!is_placed(header)) {
        notes.push_back(
            "its header says nothing of its orientation in the body (no sform, no "
            "qform): its axes were taken as those of LPS");
        Transform plain = Transform::Zero();
        plain.leftCols<3>() = spacings_of(header, unit, notes).asDiagonal();
        return plain;
    }
    if (!has_sform) return qform_of(header, unit, notes);
    const Transform sform = sform_of(header, unit);
    if (has_no_spacings(sform, header, unit)) {
        notes.emplace_back(
            "its sform has axes of length 1, but its header gives other spacings: its qform was "
            "taken");
        return qform_of(header, unit, notes);
    }
    if (straightened(nifti_grid(sform, header))) {
        note_spacings(sform, header, unit, notes);
        if (has_qform) note_disagreement(sform, header, unit, notes);
        return sform;
    }
    if (!has_qform) {
        throw Failure(
            "its sform is sheared (its axes are not at right angles) and it has no qform; resample "
            "it to a grid with axes at right angles");
    }
    notes.push_back(
        "its sform is sheared (its axes are not at right angles), which a grid cannot be: its "
        "qform was taken");
    return qform_of(header, unit, notes);
}

/// SPM writes an origin where Analyze has none, but not which side is left.
void note_origin(const Header& header, std::vector<std::string>& notes) {
    constexpr std::size_t originator = 253;
    bool is_told = false;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto bytes = std::span(header.bytes).subspan(originator + 2 * axis);
        is_told = is_told || number_in<std::int16_t>(bytes, header.swapped) != 0;
    }
    if (header.is_analyze && is_told) {
        notes.emplace_back("its header gives an origin (of SPM), which was ignored");
    }
}

/// A slope of 0, NaN or infinity means that the numbers are the values, whatever the intercept.
ValueMap values_of(const Header& header, std::vector<std::string>& notes) {
    const double slope = header.real(slope_field), intercept = header.real(intercept_field);
    if (slope != 0 && std::isfinite(slope)) {
        if (std::isfinite(intercept)) return {slope, intercept};
        throw Failure("its header has the slope " + text_of(slope) + " and the intercept " +
                      text_of(intercept) + "; correct the header");
    }
    const bool unset = (intercept == 0 || std::isnan(intercept)) && !std::isinf(slope);
    if (!unset) {
        notes.push_back(
            "its header has the slope " + text_of(slope) +
            ", which means none: the samples are as they are stored, and the intercept " +
            text_of(intercept) + " was ignored");
    }
    return {};
}

std::vector<std::int64_t> sizes_of(const Header& header) {
    const std::int64_t axes = axes_of(header);
    if (axes < 1 || axes > 7) {
        throw Failure("its header gives " + std::to_string(axes) + " axes; the header is damaged");
    }
    std::vector<std::int64_t> sizes;
    for (std::int64_t a = 0; a < axes; ++a) sizes.push_back(size_of_axis(header, a));
    while (sizes.size() > 3 && sizes.back() == 1) sizes.pop_back();
    return sizes;
}

/// `bytes`: of the samples.
DataPlace place_of(const Header& header, const std::filesystem::path& path, std::uint64_t bytes,
                   std::vector<std::string>& notes) {
    const std::uint64_t header_bytes = header.header_bytes();
    const std::uint64_t whole_header = header_bytes + 4;  // with those that tell of extensions
    const double offset = header.is_second
                              ? static_cast<double>(header.number<float, std::int64_t>(vox_offset))
                              : header.real(vox_offset);
    const bool within =
        !header.is_pair && (offset == 0 || (offset >= header_bytes && offset < whole_header));
    const double least = header.is_pair ? 0 : static_cast<double>(header_bytes);
    if (!(within || (offset >= least && offset < 1e9)) || offset != std::floor(offset)) {
        throw Failure("its header puts the samples at byte " + text_of(offset) +
                      "; the header is damaged");
    }
    DataPlace place;
    place.file = path;
    place.skip = static_cast<std::uint64_t>(offset);
    place.swapped = header.swapped;
    if (is_gzip(path)) place.encoding = DataPlace::Encoding::compressed;
    if (within) {
        const bool is_short = std::filesystem::file_size(path) == header_bytes + bytes &&
                              place.encoding == DataPlace::Encoding::raw;
        place.skip = is_short ? header_bytes : whole_header;
        if (!is_short && header.bytes[header_bytes] != std::byte{0}) {
            throw Failure("its header puts the samples at byte " + text_of(offset) +
                          ", within itself, and has extensions behind it: where the samples begin "
                          "is not known; correct vox_offset");
        }
        notes.push_back("its header puts the samples at byte " + text_of(offset) +
                        ", within itself: those behind it were taken");
    }
    return place;
}

}  // namespace

VolumeHeader nifti_header(const Request& request) {
    const auto halves = other_halves(request.path);
    const std::filesystem::path other = halves.empty() ? "" : halves.front();
    const bool is_image = !other.empty() && extension_of(request.path).starts_with(".img");
    const std::filesystem::path& file = is_image ? other : request.path;
    Header bytes = read_header(file);
    check_kind(bytes, !other.empty());
    const std::filesystem::path& samples = !bytes.is_pair ? file : is_image ? request.path : other;
    VolumeHeader header;
    header.format = bytes.is_analyze ? "Analyze" : "NIfTI";
    if (bytes.is_pair && halves.size() > 1) {
        header.notes.push_back("both " + quoted(other) + " and " + quoted(halves[1]) +
                               " are beside it: " + quoted(other) + " was taken");
    }
    header.stored = stored_from(bytes.type(datatype));
    const int bits = bytes.type(bitpix);  // some programs leave it out
    if (bits != 0 && bits != static_cast<int>(8 * size_of(header.stored))) {
        header.notes.push_back("its header gives " + std::to_string(bits) +
                               " bits per sample (bitpix), " + name_of(header.stored) + " has " +
                               std::to_string(8 * size_of(header.stored)) + ": the type was taken");
    }
    header.sizes = sizes_of(bytes);
    const std::uint64_t sample_bytes = checked_bytes(header.sizes, size_of(header.stored),
                                                     std::filesystem::file_size(samples), request);
    if (header.sizes.size() > 4) {
        throw Failure("it has " + text_of(header.sizes) +
                      " samples in more than 4 axes (vectors?); save one volume of it");
    }
    header.places = {place_of(bytes, samples, sample_bytes, header.notes)};
    header.geometry = nifti_grid(transform_of(bytes, header.notes), bytes);
    note_origin(bytes, header.notes);
    header.value_map = values_of(bytes, header.notes);
    if (header.sizes.size() == 4) {
        header.steps = header.sizes[3];
        header.times = times_of(bytes, header.notes);
    }
    header.together = static_cast<std::int64_t>(header.samples()) / header.steps;
    return header;
}

}  // namespace palpate::io
