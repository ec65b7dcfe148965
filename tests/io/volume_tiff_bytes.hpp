// Writes small TIFF files for the tests, byte by byte.
#pragma once

#include <zlib.h>

#include <string>
#include <vector>

#include "volume_support.hpp"

namespace palpate::io::test {

struct TestPage {
    int width = 4, height = 3;
    int bits = 8, format = 1;  ///< SampleFormat: 1 unsigned, 2 signed, 3 float
    int samples_per_pixel = 1;
    bool deflate = false;
    int depth = 1;  ///< ImageDepth
    int kind = 0;   ///< NewSubfileType; 1: a thumbnail
    int orientation = 1;
    std::string samples;
    std::string description;           ///< none if empty
    std::uint32_t resolution[2] = {};  ///< pixels a unit, a fraction, along x and y; none if 0
};

inline TestPage counting_page(int first) {
    TestPage page;
    for (int i = 0; i < 12; ++i) page.samples += static_cast<char>(first + i);
    return page;
}

inline std::string deflated(const std::string& bytes) {
    uLongf size = compressBound(bytes.size());
    std::string packed(size, '\0');
    compress(reinterpret_cast<Bytef*>(packed.data()), &size,
             reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
    packed.resize(size);
    return packed;
}

inline std::string tiff_bytes(const std::vector<TestPage>& pages) {
    std::string file = "II" + little<std::uint16_t>(42) + little<std::uint32_t>(0);
    std::size_t link = 4;  // where the offset of the next page goes
    for (const TestPage& page : pages) {
        const std::string data = page.deflate ? deflated(page.samples) : page.samples;
        const auto data_at = static_cast<std::uint32_t>(file.size());
        file += data;
        if (file.size() % 2 == 1) file += '\0';
        const auto description_at = static_cast<std::uint32_t>(file.size());
        if (!page.description.empty()) file += page.description + std::string(2, '\0');
        if (file.size() % 2 == 1) file += '\0';
        const auto resolution_at = static_cast<std::uint32_t>(file.size());
        if (page.resolution[1] > 0) file += little(page.resolution[0]) + little(page.resolution[1]);
        file.replace(link, 4, little(static_cast<std::uint32_t>(file.size())));
        std::string entries;
        std::uint16_t count = 0;
        const auto entry = [&](std::uint16_t tag, std::uint32_t value, std::uint16_t type = 4,
                               std::uint32_t values = 1) {
            entries += little(tag) + little(type) + little(values) + little(value);
            ++count;
        };
        entry(254, static_cast<std::uint32_t>(page.kind));
        entry(256, static_cast<std::uint32_t>(page.width));
        entry(257, static_cast<std::uint32_t>(page.height));
        entry(258, static_cast<std::uint32_t>(page.bits));
        entry(259, page.deflate ? 8 : 1);
        entry(262, page.samples_per_pixel == 3 ? 2 : 1);
        if (!page.description.empty()) {
            entry(270, description_at, 2, static_cast<std::uint32_t>(page.description.size() + 1));
        }
        entry(273, data_at);
        entry(274, static_cast<std::uint32_t>(page.orientation));
        entry(277, static_cast<std::uint32_t>(page.samples_per_pixel));
        entry(278, static_cast<std::uint32_t>(page.height));
        entry(279, static_cast<std::uint32_t>(data.size()));
        if (page.resolution[1] > 0) {
            entry(282, resolution_at, 5);
            entry(283, resolution_at, 5);
        }
        entry(339, static_cast<std::uint32_t>(page.format));
        if (page.depth > 1) entry(32997, static_cast<std::uint32_t>(page.depth));
        file += little(count) + entries;
        link = file.size();
        file += little<std::uint32_t>(0);
    }
    return file;
}

}  // namespace palpate::io::test
