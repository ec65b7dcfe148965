// Reads the place, the orientation and the size of pixels from DICOM elements. See the header.
#include "io/helper/dicom_place.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "io/helper/headers.hpp"

namespace palpate::io {
namespace {

constexpr DicomTag position_tag{0x0020, 0x0032}, orientation_tag{0x0020, 0x0037},
    pixel_tag{0x0028, 0x0030}, thickness_tag{0x0018, 0x0050};

/// Refuses a list that has some numbers, but not as many as it should.
void check_count(const std::vector<double>& numbers, std::size_t count, const char* name) {
    if (numbers.empty() || numbers.size() == count) return;
    throw Failure("its DICOM tag " + std::string(name) + " has " + std::to_string(numbers.size()) +
                  " numbers instead of " + std::to_string(count) + "; correct it");
}

/// Ultrasound has the size of pixels with each region of the image (PS3.3 C.8.5.5), in cm.
void set_pixel_of_region(DicomSlice& s, const DicomGroup& data) {
    constexpr std::uint32_t centimetres = 3;
    std::optional<Vec3> pixel;
    for (const DicomGroup& region : data.items({0x0018, 0x6011})) {
        const auto along_x = region.counts({0x0018, 0x6024}),
                   along_y = region.counts({0x0018, 0x6026});
        if (along_x != std::vector{centimetres} || along_y != along_x) continue;  // no lengths
        const Vec3 size(10 * std::abs(region.real({0x0018, 0x602c})),
                        10 * std::abs(region.real({0x0018, 0x602e})), 0);
        if (!(size.head<2>().minCoeff() >= least_length && size.maxCoeff() <= greatest_length)) {
            continue;
        }
        if (pixel && *pixel != size) {
            add_note(s.notes, "its regions have pixels of different sizes, which were not used");
            return;
        }
        pixel = size;
    }
    if (!pixel) return;
    s.pixel = pixel;
    add_note(s.notes, "its pixel spacing is that of its ultrasound regions");
}

}  // namespace

void set_place(DicomSlice& s, const std::vector<double>& p, const std::vector<double>& axes) {
    check_count(p, 3, "ImagePositionPatient");
    check_count(axes, 6, "ImageOrientationPatient");
    if (!p.empty()) {
        for (const double c : p) check_coordinate(c, "DICOM tag ImagePositionPatient");
        s.position = Vec3(p[0], p[1], p[2]);
    }
    if (axes.empty()) return;
    if (std::ranges::all_of(axes, [](double component) { return component == 0; })) {
        add_note(s.notes, "its ImageOrientationPatient has only zeros: it was ignored");
        return;
    }
    s.row = Vec3(axes[0], axes[1], axes[2]);
    s.column = Vec3(axes[3], axes[4], axes[5]);
    for (const auto& direction : {s.row, s.column}) {
        if (direction->norm() > 0.5 && direction->norm() < 2) continue;
        throw Failure("its DICOM tag ImageOrientationPatient has no unit vectors; correct it");
    }
}

void set_place(DicomSlice& s, const DicomGroup& group) {
    set_place(s, group.numbers(position_tag), group.numbers(orientation_tag));
}
void set_pixel(DicomSlice& s, const DicomGroup& measures) {
    static constexpr std::array<std::pair<DicomTag, const char*>, 3> tags = {
        {{pixel_tag, ""},
         {{0x0018, 0x1164}, "at the detector (ImagerPixelSpacing)"},
         {{0x0018, 0x2010}, "of a scanned image (NominalScannedPixelSpacing)"}}};
    for (const auto& [tag, where] : tags) {
        auto pixel = measures.numbers(tag);
        if (pixel.empty()) continue;
        if (pixel.size() == 1 && tag == pixel_tag) {
            pixel.push_back(pixel[0]);
            add_note(s.notes,
                     "its PixelSpacing has one number, which was taken for rows and columns");
        }
        if (pixel.size() != 2 && tag != pixel_tag) continue;
        check_count(pixel, 2, "PixelSpacing");
        if (pixel[0] == 0 && pixel[1] == 0) {
            add_note(s.notes, "its pixel spacing of 0 mm was ignored");
            continue;
        }
        check_spacing(pixel[0], "DICOM tag PixelSpacing");
        check_spacing(pixel[1], "DICOM tag PixelSpacing");
        s.pixel = Vec3(pixel[1], pixel[0], 0);  // DICOM gives the distance between rows first
        if (tag != pixel_tag) add_note(s.notes, std::string("its pixel spacing is that ") + where);
        break;
    }
    if (!s.pixel && !measures.has(groups_of_frames)) set_pixel_of_region(s, measures);
    if (const auto shape = measures.numbers({0x0028, 0x0034}); shape.size() == 2) {
        s.aspect = shape[0] / shape[1];
        check_spacing(s.aspect, "DICOM tag PixelAspectRatio");
    }
    const double between = measures.number(between_tag, 0);
    if (between != 0) {
        s.between = between;
        s.thickness = std::abs(between);
    }
    if (!(s.thickness > 0)) s.thickness = measures.number(thickness_tag, 0);
}

}  // namespace palpate::io
