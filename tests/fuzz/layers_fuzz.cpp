// Any text gives layers that read back as the same, or a one-line InputError.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "fuzz/require.hpp"
#include "palpate/io/layers_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace palpate;
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    try {
        const io::LayersFile file = io::layers_from_text(text, "text");
        const std::string written = io::text_of(file);
        require(io::text_of(io::layers_from_text(written, "again")) == written);
        const int count = static_cast<int>(file.layers.layers.size());
        for (int layer = -1; layer < count; ++layer) {
            for (int p = 0; p < haptic_property_count; ++p) {
                const double value =
                    property_of(file.layers, layer, static_cast<HapticProperty>(p), 0.5, 0.5, 0);
                require(value >= 0);
            }
        }
    } catch (const io::InputError& error) {
        require_one_line(error.what(), "text");
    }
    return 0;
}
