// Any text in the options that we parse ourselves (raw layout, spacing, level, synthetic volume)
// gives a valid value or a std::invalid_argument. Four lines: dims, type, spacing, level.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string_view>

#include "fuzz/require.hpp"
#include "palpate/io/level.hpp"
#include "palpate/io/raw_options.hpp"

namespace {

std::array<std::string_view, 4> lines_of(std::string_view text) {
    std::array<std::string_view, 4> lines;
    for (auto& line : lines) {
        const auto end = text.find('\n');
        line = text.substr(0, end);
        text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
    }
    return lines;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace palpate;
    const auto [dims, type, spacing, level] = lines_of({reinterpret_cast<const char*>(data), size});
    try {
        const io::RawLayout layout = io::raw_layout_from(dims, type, spacing, 0);
        Geometry geometry;
        geometry.size = layout.size;
        geometry.spacing = layout.spacing;
        check(geometry);
        require(sample_count(geometry) > 0);
    } catch (const std::invalid_argument&) {
    }
    static const Volume volume(Geometry{.size = {2, 1, 1}}, std::vector<float>{-100, 300});
    try {
        require(std::isfinite(io::level_from_text(level, volume)));
    } catch (const std::invalid_argument&) {
    }
    return 0;
}
