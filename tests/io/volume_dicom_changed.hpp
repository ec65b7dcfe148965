// Changes the bytes of small DICOM files, as unusual writers have them.
#pragma once

#include <cstring>
#include <functional>
#include <string>

#include "volume_dicom_slice.hpp"

namespace palpate::io::test {

inline TestSlice usual_slice(int number) {
    TestSlice slice;
    slice.number = number;
    slice.position = "10\\20\\" + std::to_string(2 * number);
    return slice;
}

inline std::string tag_bytes(std::uint16_t group, std::uint16_t element) {
    return little(group) + little(element);
}

inline std::string element(std::uint16_t group, std::uint16_t element, const char* vr,
                           const std::string& value) {
    DicomBytes one;
    one.text(group, element, vr, value);
    return one.bytes();
}

inline std::string long_element(std::uint16_t group, std::uint16_t element, const char* vr,
                                const std::string& value) {
    DicomBytes one;
    one.long_value(group, element, vr, value);
    return one.bytes();
}

/// The data set with `what` before the element of this tag.
inline std::string with(std::string data, std::uint16_t group, std::uint16_t element,
                        const std::string& what) {
    return data.insert(data.find(tag_bytes(group, element)), what);
}

/// Without an element of a short type.
inline std::string without(std::string data, std::uint16_t group, std::uint16_t element) {
    const std::size_t at = data.find(tag_bytes(group, element));
    std::uint16_t length = 0;
    std::memcpy(&length, data.data() + at + 6, 2);
    return data.erase(at, 8 + length);
}

inline std::string file_of(const TestSlice& slice, const std::string& data) {
    return dicom_start(slice, "1.2.840.10008.1.2.1") + data;
}

/// Four slices, each changed.
inline VolumeFile read_changed(const ScratchFolder& folder,
                               const std::function<std::string(const TestSlice&)>& change) {
    for (int i = 0; i < 4; ++i) {
        put_bytes(folder / (std::to_string(i) + ".dcm"), change(usual_slice(i)));
    }
    return read_volume(folder.path());
}

inline void expect_usual(const VolumeFile& file) {
    const Geometry& g = file.volume.geometry();
    ASSERT_EQ(g.size, Index3(4, 3, 4));
    EXPECT_EQ(g.spacing, Vec3(0.25, 0.5, 2));
    EXPECT_EQ(g.origin, Vec3(10, 20, 0));
    EXPECT_EQ(file.volume.type(), SampleType::uint16);
    for (int z = 0; z < 4; ++z) {
        EXPECT_EQ(file.volume.sample({0, 0, z}), 100 * z);
        EXPECT_EQ(file.volume.sample({3, 2, z}), 100 * z + 11);
    }
}

/// An item of a sequence.
inline std::string item_of(const std::string& content) {
    return tag_bytes(0xfffe, 0xe000) + little(static_cast<std::uint32_t>(content.size())) + content;
}

/// The same elements without their types (implicit little endian), also in sequences.
inline std::string implicit_of(const std::string& elements) {
    std::string bytes;
    for (std::size_t at = 0; at < elements.size();) {
        const std::string type = elements.substr(at + 4, 2);
        const bool is_long = type == "OB" || type == "OW" || type == "SQ" || type == "UT";
        const std::size_t value = at + (is_long ? 12 : 8);
        std::uint32_t length = 0;
        std::memcpy(&length, elements.data() + value - (is_long ? 4 : 2), is_long ? 4 : 2);
        std::string content = elements.substr(value, length);
        if (type == "SQ") {
            std::string items;
            for (std::size_t i = 0; i < content.size();) {
                std::uint32_t size = 0;
                std::memcpy(&size, content.data() + i + 4, 4);
                items += item_of(implicit_of(content.substr(i + 8, size)));
                i += 8 + size;
            }
            content = items;
        }
        bytes +=
            elements.substr(at, 4) + little(static_cast<std::uint32_t>(content.size())) + content;
        at = value + length;
    }
    return bytes;
}

}  // namespace palpate::io::test
