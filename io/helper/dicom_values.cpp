// Reads the meaning of stored numbers from DICOM elements. See the header.
#include "io/helper/dicom_values.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "io/helper/headers.hpp"

namespace palpate::io {
namespace {

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

}  // namespace

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

}  // namespace palpate::io
