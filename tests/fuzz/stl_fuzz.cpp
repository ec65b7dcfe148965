// Any bytes are the corners of an STL mesh, or a failure of one line.
#include <cstdint>
#include <string>
#include <string_view>

#include "fuzz/require.hpp"
#include "io/helper/decode.hpp"
#include "io/helper/stl_mesh.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace palpate::io;
    try {
        const auto corners = stl_corners(std::string(reinterpret_cast<const char*>(data), size));
        // Nothing comes from nowhere: a corner takes 12 bytes or more of the file.
        require(corners.size() % 3 == 0 && corners.size() * 12 <= size);
    } catch (const Failure& failure) {
        require_one_line(failure.what());
    }
    return 0;
}
