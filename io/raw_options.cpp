// Parses the options that describe a raw file.
#include "palpate/io/raw_options.hpp"

#include <cmath>
#include <stdexcept>

#include "io/file_grid.hpp"
#include "io/system/number.hpp"
#include "palpate/io/written_formats.hpp"

namespace palpate::io {

Vec3 three_numbers_from(std::string_view text, char separator, std::string_view what) {
    Vec3 numbers = Vec3::Zero();
    const char* at = text.data();
    const char* const end = at + text.size();
    bool good = true;
    for (int i = 0; i < 3 && good; ++i) {
        if (i > 0) good = at != end && *at++ == separator;
        const auto [next, error] = read_number(at, end, numbers[i]);
        good = good && error == std::errc{} && std::isfinite(numbers[i]);
        at = next;
    }
    if (good && at == end) return numbers;
    throw std::invalid_argument(std::string(what) + " " + std::string(text) +
                                ": three numbers with '" + separator + "' between are needed");
}

Vec3 spacing_from(std::string_view text) {
    const Vec3 spacing = three_numbers_from(text, ',', "spacing");
    if (is_file_spacing(spacing[0]) && is_file_spacing(spacing[1]) && is_file_spacing(spacing[2])) {
        return spacing;
    }
    throw std::invalid_argument("spacing " + std::string(text) +
                                ": every spacing must be above 0 mm (1e-9 to 1e9)");
}

RawLayout raw_layout_from(std::string_view dims, std::string_view type, std::string_view spacing,
                          std::uint64_t skip) {
    if (dims.empty() || type.empty()) {
        throw std::invalid_argument(
            "a raw volume needs both dims (WxHxD) and type (uint8, int16, uint16 or float32)");
    }
    const Vec3 size = three_numbers_from(dims, 'x', "dims");
    for (int a = 0; a < 3; ++a) {
        if (size[a] < 1 || size[a] > 1 << 20 || size[a] != std::floor(size[a])) {
            throw std::invalid_argument("dims " + std::string(dims) +
                                        ": three whole numbers from 1 to 1048576, as in "
                                        "256x256x113");
        }
    }
    RawLayout layout;
    layout.size = size.cast<int>();
    layout.type = sample_type_from(type);
    if (!spacing.empty()) layout.spacing = spacing_from(spacing);
    layout.skip = skip;
    return layout;
}

std::string opening_words(const std::filesystem::path& saved, const Volume& volume) {
    if (written_extension_of(saved) != ".raw") return {};
    const Geometry& geometry = volume.geometry();
    std::string dims, spacing;
    for (int a = 0; a < 3; ++a) {
        dims += (a > 0 ? "x" : "") + std::to_string(geometry.size[a]);
        if (a > 0) spacing += ",";
        append_number(spacing, geometry.spacing[a]);
    }
    return " (open it with dims " + dims + ", type " + std::string(name_of(volume.type())) +
           ", spacing " + spacing + ")";
}

}  // namespace palpate::io
