// Any bytes from the network give whole messages or a refusal. Any IMAGE gives a volume no larger
// than its message, any STRING a printable line. The first byte chooses the meaning of the others.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "bridge/wire.hpp"
#include "fuzz/require.hpp"

namespace {

using namespace palpate::bridge;

void take(const Received& received) {
    try {
        const palpate::Volume volume = volume_of(received);
        require(volume.bytes() <= 4 * received.content.size());
    } catch (const WireError&) {
    }
    try {
        const std::string text = text_of(received);
        for (const char c : text) require(c >= ' ' && c < 0x7F);
    } catch (const WireError&) {
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
    std::string stream(bytes);
    if (data[0] % 3 == 0) {
        take({"IMAGE", "x", stream});
        return 0;
    }
    if (data[0] % 3 == 1) {  // with the right checksum, as of version 2
        stream = message("IMAGE", "x", bytes, 0);
        stream[1] = 2;
    }
    std::vector<Received> messages;
    Reader reader({1 << 16, 1 << 12});
    try {
        for (std::size_t at = 0; at < stream.size(); at += 7) {
            reader.feed(std::string_view(stream).substr(at, 7), messages);
        }
    } catch (const WireError&) {
    }
    for (const Received& received : messages) {
        require(received.content.size() <= size);
        take(received);
    }
    return 0;
}
