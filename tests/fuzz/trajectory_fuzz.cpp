// Any text gives a valid trajectory or a one-line InputError. The same holds for a trace.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "fuzz/require.hpp"
#include "palpate/io/trace.hpp"
#include "palpate/io/trajectory.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    try {
        const auto trajectory = palpate::io::parse_trajectory(text, "text");
        require(!trajectory.time.empty());
        require(trajectory.time.size() == trajectory.position.size());
        for (std::size_t i = 0; i < trajectory.time.size(); ++i) {
            require(std::isfinite(trajectory.time[i]) && trajectory.position[i].allFinite());
            require(i == 0 || trajectory.time[i] > trajectory.time[i - 1]);
        }
    } catch (const palpate::io::InputError& error) {
        require_one_line(error.what(), "text");
    }
    try {
        for (const auto& row : palpate::io::parse_trace(text, "text")) require(row.tetrahedra >= 0);
    } catch (const palpate::io::InputError& error) {
        require_one_line(error.what(), "text");
    }
    return 0;
}
