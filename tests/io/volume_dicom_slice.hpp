// Writes small DICOM files (Part 10, explicit little endian) for the tests: just what a CT slice
// needs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/volume_support.hpp"

namespace palpate::io::test {

struct TestSlice {
    std::string kind = "1.2.840.10008.5.1.4.1.1.2";  ///< SOP class; CT
    std::string image_type = "ORIGINAL\\PRIMARY";
    std::string series = "1.2.3.4";
    std::string description = "TEST";
    int number = 1;
    int acquisition = 1;
    int columns = 4, rows = 3;
    bool is_signed = false;
    int samples_per_pixel = 1;
    int frames = 1;
    std::string slope = "1", intercept = "0";
    std::string pixel_spacing = "0.5\\0.25";  ///< rows first, as DICOM has it
    std::string position = "0\\0\\0";         ///< empty: not given
    std::string orientation = "1\\0\\0\\0\\1\\0";
    std::string location;               ///< SliceLocation; empty: not given
    std::vector<std::uint16_t> pixels;  ///< columns x rows x frames; empty: number * 100 + index
};

class DicomBytes {
  public:
    void text(std::uint16_t group, std::uint16_t element, const char* vr, std::string value,
              char padding = ' ') {
        if (value.size() % 2 == 1) value += padding;
        bytes_ += little(group) + little(element) + vr +
                  little(static_cast<std::uint16_t>(value.size())) + value;
    }
    void number(std::uint16_t group, std::uint16_t element, int value) {
        text(group, element, "US", little(static_cast<std::uint16_t>(value)));
    }
    void long_value(std::uint16_t group, std::uint16_t element, const char* vr,
                    const std::string& value) {
        bytes_ += little(group) + little(element) + vr + std::string(2, '\0') +
                  little(static_cast<std::uint32_t>(value.size())) + value;
    }
    const std::string& bytes() const { return bytes_; }

  private:
    std::string bytes_;
};

inline std::string pixel_bytes(const TestSlice& slice) {
    std::string bytes;
    const int count = slice.columns * slice.rows * slice.samples_per_pixel * slice.frames;
    for (int i = 0; i < count; ++i) {
        bytes += little(slice.pixels.empty() ? static_cast<std::uint16_t>(slice.number * 100 + i)
                                             : slice.pixels[static_cast<std::size_t>(i)]);
    }
    return bytes;
}

inline std::string instance_of(const TestSlice& slice) {
    return slice.series + "." + std::to_string(slice.number) + "." +
           std::to_string(slice.acquisition);
}

/// All up to the data set, which begins behind it.
inline std::string dicom_start(const TestSlice& slice, const std::string& transfer_syntax) {
    DicomBytes meta;
    meta.long_value(2, 1, "OB", std::string("\0\1", 2));
    meta.text(2, 2, "UI", slice.kind, '\0');
    meta.text(2, 3, "UI", instance_of(slice), '\0');
    meta.text(2, 0x10, "UI", transfer_syntax, '\0');
    meta.text(2, 0x12, "UI", "1.2.3", '\0');
    DicomBytes length;
    length.text(2, 0, "UL", little(static_cast<std::uint32_t>(meta.bytes().size())));
    return std::string(128, '\0') + "DICM" + length.bytes() + meta.bytes();
}

/// The data set, explicit little endian.
inline std::string dicom_data_set(const TestSlice& slice) {
    DicomBytes data;
    data.text(8, 8, "CS", slice.image_type);
    data.text(8, 0x16, "UI", slice.kind, '\0');
    data.text(8, 0x18, "UI", instance_of(slice), '\0');
    data.text(8, 0x60, "CS", "CT");
    data.text(8, 0x103e, "LO", slice.description);
    data.text(0x18, 0x50, "DS", "2.5");
    data.text(0x20, 0xd, "UI", "1.2.3.9", '\0');
    data.text(0x20, 0xe, "UI", slice.series, '\0');
    data.text(0x20, 0x12, "IS", std::to_string(slice.acquisition));
    data.text(0x20, 0x13, "IS", std::to_string(slice.number));
    if (!slice.position.empty()) {
        data.text(0x20, 0x32, "DS", slice.position);
        data.text(0x20, 0x37, "DS", slice.orientation);
    }
    if (!slice.location.empty()) data.text(0x20, 0x1041, "DS", slice.location);
    data.number(0x28, 2, slice.samples_per_pixel);
    data.text(0x28, 4, "CS", slice.samples_per_pixel == 3 ? "RGB" : "MONOCHROME2");
    if (slice.samples_per_pixel == 3) data.number(0x28, 6, 0);
    if (slice.frames > 1) data.text(0x28, 8, "IS", std::to_string(slice.frames));
    data.number(0x28, 0x10, slice.rows);
    data.number(0x28, 0x11, slice.columns);
    if (!slice.pixel_spacing.empty()) data.text(0x28, 0x30, "DS", slice.pixel_spacing);
    data.number(0x28, 0x100, 16);
    data.number(0x28, 0x101, 16);
    data.number(0x28, 0x102, 15);
    data.number(0x28, 0x103, slice.is_signed ? 1 : 0);
    data.text(0x28, 0x1052, "DS", slice.intercept);
    data.text(0x28, 0x1053, "DS", slice.slope);
    data.long_value(0x7fe0, 0x10, "OW", pixel_bytes(slice));
    return data.bytes();
}

inline std::string dicom_bytes(const TestSlice& slice) {
    return dicom_start(slice, "1.2.840.10008.1.2.1") + dicom_data_set(slice);
}

inline void put_slice(const std::filesystem::path& path, const TestSlice& slice) {
    put_bytes(path, dicom_bytes(slice));
}

}  // namespace palpate::io::test
