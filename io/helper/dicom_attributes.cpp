// Reads the properties of a DICOM slice. See the header.
#include "io/helper/dicom_attributes.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>
#include <sstream>
#include <utility>

#include "io/file_grid.hpp"
#include "io/helper/dicom_time.hpp"
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
        if (!is_file_spacing(size.x()) || !is_file_spacing(size.y())) continue;
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

constexpr DicomTag intercept_tag{0x0028, 0x1052}, slope_tag{0x0028, 0x1053},
    dose_tag{0x3004, 0x000e};
constexpr const char* unspecified = "US";  // units

/// The number of a tag that has one, or one again and again; nothing if it is not there.
std::vector<double> one_number(const DicomGroup& group, DicomTag tag, const std::string& name) {
    const auto numbers = group.numbers(tag);
    if (std::ranges::adjacent_find(numbers, std::ranges::not_equal_to()) == numbers.end()) {
        return numbers;
    }
    throw Failure("its DICOM tag " + name + " has " + std::to_string(numbers.size()) +
                  " numbers instead of 1; correct it");
}

/// Puts `with` in place of a number that makes no sense.
void check_number(DicomSlice& s, double& number, bool is_good, const char* name, double with) {
    if (is_good) return;
    add_note(s.notes, "its " + std::string(name) + " is " + text_of(number) +
                          ", which makes no sense: " + text_of(with) + " was taken");
    number = with;
}

/// In the place of slope and intercept: of a dose, and of segmentations that have fractions of a
/// greatest value (PS3.3 C.8.20.2.3).
void set_scaling(DicomSlice& s, const DicomGroup& data) {
    const auto most = data.counts({0x0062, 0x000e});
    if (data.text({0x0062, 0x0001}) == "FRACTIONAL" && most.size() == 1 && most[0] > 0) {
        s.slope = 1.0 / most[0];
    }
    if (!data.has(dose_tag)) return;
    if (s.slope != 1 || s.intercept != 0) {
        add_note(s.notes, "its slope and intercept are not those of a dose: they were ignored");
    }
    const auto told = one_number(data, dose_tag, "DoseGridScaling");
    s.slope = told.empty() ? std::nan("") : told[0];
    s.intercept = 0;
    check_number(s, s.slope, s.slope > 0 && std::isfinite(s.slope), "DoseGridScaling", 1);
    s.has_rescale = true;
    s.values.units = data.text({0x3004, 0x0002});  // GY
}

/// The table that stands in place of slope and intercept (PS3.3 C.11.1).
void set_table(DicomSlice& s, const DicomGroup& data) {
    const auto items = data.items({0x0028, 0x3000});
    if (items.empty()) return;
    const auto told = items.front().counts({0x0028, 0x3002});
    const auto values = items.front().counts({0x0028, 0x3006});
    const auto bytes = items.front().binary<std::uint8_t>({0x0028, 0x3006});
    const std::size_t count = told.size() == 3 && told[0] == 0 ? 65536 : told.empty() ? 0 : told[0];
    // Entries of 8 bits have a byte each, or, of some writers, two, which their length tells.
    const bool are_bytes = told.size() == 3 && told[2] == 8 && values.size() < count;
    if (told.size() != 3 || count == 0 || (are_bytes ? bytes.size() : values.size()) < count) {
        throw Failure("its Modality LUT is damaged; export it again");
    }
    ValueTable table;
    const bool is_signed = data.counts({0x0028, 0x0103}) == std::vector<std::uint32_t>{1};
    table.first =
        is_signed ? static_cast<std::int16_t>(told[1]) : static_cast<std::int32_t>(told[1]);
    for (std::size_t i = 0; i < count; ++i) {
        table.values.push_back(are_bytes ? bytes[i] : static_cast<std::uint16_t>(values[i]));
    }
    s.table = std::make_shared<const ValueTable>(std::move(table));
    s.has_rescale = true;
    const std::string units = items.front().text({0x0028, 0x3004});
    s.values.units = units.empty() ? unspecified : units;
    s.notes.emplace_back("the table of values in its header (Modality LUT) was applied");
}

/// PixelPaddingValue, in units.
void set_padding(DicomSlice& s, const DicomGroup& data) {
    const auto stored = data.counts({0x0028, 0x0120});
    if (stored.size() != 1 || data.has({0x0028, 0x3000})) return;
    const bool is_signed = data.counts({0x0028, 0x0103}) == std::vector<std::uint32_t>{1};
    const double value = is_signed ? static_cast<std::int16_t>(stored[0]) : double(stored[0]);
    s.values.padding = s.slope * value + s.intercept;
}

constexpr std::size_t most_dimensions =
    64;  // of a frame; keys are compared in time that rises with them

void add_kind(DicomSlice& s, const std::string& kind) {
    s.kind += (s.kind.empty() || kind.empty() ? "" : ", ") + kind;
}

void add_kind(DicomSlice& s, const char* name, double value, const char* unit) {
    if (std::isfinite(value)) add_kind(s, name + text_of(value) + unit);
}

/// Magnitude, phase, real or imaginary part. The files of some scanners say it nowhere else.
void add_component(DicomSlice& s, const DicomGroup& data) {
    const std::string component = lower(data.text({0x0008, 0x9208}));
    if (component != "mixed") add_kind(s, component);
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
    constexpr double most = 0.01, rounding = 0.005;  // of a length, by the files' decimals
    s.row = Vec3(axes[0], axes[1], axes[2]);
    s.column = Vec3(axes[3], axes[4], axes[5]);
    for (const auto& direction : {s.row, s.column}) {
        const double deviation = std::abs(direction->norm() - 1);
        if (!(deviation <= most)) {
            throw Failure(
                "its DICOM tag ImageOrientationPatient has no unit vectors (one of length " +
                text_of(direction->norm()) + "); correct it");
        }
        if (deviation > rounding) {
            add_note(s.notes,
                     "its ImageOrientationPatient has vectors that are not quite of length "
                     "1: their directions were taken");
        }
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

void set_rescale(DicomSlice& s, const DicomGroup& transformation) {
    const auto slope = one_number(transformation, slope_tag, "RescaleSlope"),
               intercept = one_number(transformation, intercept_tag, "RescaleIntercept");
    s.has_rescale = s.has_rescale || !(slope.empty() || intercept.empty());
    if (!slope.empty()) s.slope = slope[0];
    if (!intercept.empty()) s.intercept = intercept[0];
    check_number(s, s.slope, s.slope != 0 && std::isfinite(s.slope), "RescaleSlope", 1);
    check_number(s, s.intercept, std::isfinite(s.intercept), "RescaleIntercept", 0);
    const std::string units = transformation.text({0x0028, 0x1054});
    const bool is_told = !units.empty() && units != unspecified;
    if (is_told || s.values.units.empty()) s.values.units = units;
}

void set_window(DicomSlice& s, const DicomGroup& group) {
    const double centre = group.number({0x0028, 0x1050}, 0);
    const double width = group.number({0x0028, 0x1051}, 0);
    if (width > 0) s.values.window = ValueWindow{centre, width};
}

void note_value_mapping(DicomSlice& s) {
    add_note(s.notes,
             "its Real World Value Mapping was not applied: values are by RescaleSlope and "
             "RescaleIntercept");
}

void set_values(DicomSlice& s, const DicomGroup& data) {
    s.values.modality = data.text({0x0008, 0x0060});
    set_rescale(s, data);
    const std::string of_pet = data.text({0x0054, 0x1001});
    if (!of_pet.empty() && (s.values.units.empty() || s.values.units == unspecified)) {
        s.values.units = of_pet;
    }
    set_scaling(s, data);
    set_window(s, data);
    set_table(s, data);
    if (data.has(value_mapping)) note_value_mapping(s);
}

void finish_values(DicomSlice& s, const DicomGroup& data) {
    set_padding(s, data);
    // PS3.3 C.8.2.1: values of CT are in HU unless their type is given.
    if (s.values.units.empty() && s.values.modality == "CT" && s.has_rescale) s.values.units = "HU";
    if (s.values.units == unspecified) s.values.units.clear();
}

Segments segments_in(const DicomGroup& data) {
    Segments names;
    const std::string set = data.text({0x0008, 0x0005});
    for (const DicomGroup& segment : data.items({0x0062, 0x0002})) {
        const auto number = segment.binary<std::uint16_t>({0x0062, 0x0004});
        if (!number.empty()) names[number[0]] = segment.words({0x0062, 0x0005}, set);
    }
    return names;
}

/// Properties that distinguish images of one place in one series: magnitude or phase (the third
/// value of ImageType), the echo, the weighting by diffusion, and further values of ImageType.
void set_kind(DicomSlice& s, const DicomGroup& data) {
    std::istringstream values(data.text({0x0008, 0x0008}));
    std::string value;
    for (int i = 0; std::getline(values, value, '\\'); ++i) {
        value = trimmed(value);
        if (i == 2) s.kind = value;
        if (i > 2) s.contrast += (s.contrast.empty() ? "" : " ") + value;
    }
    if (const auto echo = data.numbers({0x0018, 0x0081}); !echo.empty()) s.echo = echo[0];
    add_component(s, data);
    add_kind(s, "b-value ", data.real({0x0018, 0x9087}), " s/mm2");
    set_traits(s, data);
}

/// Properties that order the images of one place in one series.
void set_moment(DicomSlice& s, const DicomGroup& data) {
    const double none = std::numeric_limits<double>::quiet_NaN();
    const auto number_of = [&](DicomTag tag) {
        const double number = data.optional_number(tag);
        return std::isnan(number) ? 0 : number;
    };
    const double number = number_of({0x0020, 0x0013});
    s.instance = static_cast<int>(number);
    s.keys.assign(first_dimension, none);
    if (s.frames > 1) s.keys[file_number] = number;
    s.keys[temporal_position] = data.optional_number({0x0020, 0x0100});
    s.keys[trigger_time] = data.optional_number({0x0018, 0x1060});
    s.keys[reference_time] = data.optional_number({0x0054, 0x1300});
    s.clock_offset = data.text({0x0008, 0x0201});
    const auto moment = [&](DicomTag date, DicomTag time) {
        return moment_of(data.text(date), data.text(time), s.clock_offset);
    };
    s.keys[acquisition_time] = moment_of(data.text({0x0008, 0x002a}), s.clock_offset);
    if (std::isnan(s.keys[acquisition_time])) {
        s.keys[acquisition_time] = moment({0x0008, 0x0022}, {0x0008, 0x0032});
    }
    s.keys[content_time] = moment({0x0008, 0x0023}, {0x0008, 0x0033});
    s.keys[acquisition_number] = number_of({0x0020, 0x0012});
    s.keys[frame_number] = number;
}

/// Properties, other than their moment, that distinguish the frames of one place.
void set_kind(DicomSlice& s, const FunctionalGroups& groups, const Segments& segments) {
    s.kind.clear();
    // Frame types of MR, CT, PET, X-ray 3D, parametric maps and ultrasound.
    for (const DicomTag type : {DicomTag{0x0018, 0x9226},
                                {0x0018, 0x9329},
                                {0x0018, 0x9732},
                                {0x0018, 0x9504},
                                {0x0040, 0x9092},
                                {0x0018, 0x9806}}) {
        groups.with(type, [&](const DicomGroup& g) { add_kind(s, g.text({0x0008, 0x9007})); });
    }
    groups.with({0x0018, 0x9226}, [&](const DicomGroup& g) { add_component(s, g); });
    set_traits(s, groups);
    groups.with({0x0018, 0x9114}, [&](const DicomGroup& g) { s.echo = g.real({0x0018, 0x9082}); });
    groups.with({0x0018, 0x9117}, [&](const DicomGroup& g) {
        add_kind(s, "b-value ", g.real({0x0018, 0x9087}), " s/mm2");
    });
    groups.with({0x0062, 0x000a}, [&](const DicomGroup& g) {
        for (const std::uint16_t number : g.binary<std::uint16_t>({0x0062, 0x000b})) {
            const auto name = segments.find(number);
            add_kind(s, "segment " + std::to_string(number) +
                            (name == segments.end() ? "" : " " + name->second));
        }
    });
}

/// Properties that order the frames of one place.
void set_moment(DicomSlice& s, const FunctionalGroups& groups) {
    groups.with({0x0020, 0x9111}, [&](const DicomGroup& g) {
        s.stack = g.text({0x0020, 0x9056});
        const auto place = g.binary<std::uint32_t>({0x0020, 0x9057});
        s.is_numbered = !place.empty();
        if (s.is_numbered) s.order = static_cast<int>(place[0]);
        const auto moment = g.binary<std::uint32_t>({0x0020, 0x9128});
        if (!moment.empty()) s.keys[temporal_position] = moment[0];
        s.keys[reference_time] = moment_of(g.text({0x0018, 0x9151}), s.clock_offset);
        s.keys[acquisition_time] = moment_of(g.text({0x0018, 0x9074}), s.clock_offset);
        const auto dimensions = g.binary<std::uint32_t>({0x0020, 0x9157});
        if (dimensions.size() > most_dimensions) {
            throw Failure("has too many dimensions (DimensionIndexValues); export it again");
        }
        s.keys.insert(s.keys.end(), dimensions.begin(), dimensions.end());
    });
    groups.with({0x0018, 0x9118}, [&](const DicomGroup& g) {
        s.keys[trigger_time] = g.real({0x0020, 0x9153});
        s.keys[cardiac_phase] = g.real({0x0020, 0x9241});
    });
    groups.with({0x0020, 0x9310}, [&](const DicomGroup& g) {
        s.keys[reference_time] = g.real({0x0020, 0x930d});
    });
}

}  // namespace palpate::io
