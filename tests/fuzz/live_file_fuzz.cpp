// Any bytes give a live source whose frames lie within the file, or a one-line InputError.
#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "fuzz/require.hpp"
#include "palpate/io/live_file.hpp"

namespace {

/// All that a reader does with such a file.
void read_frames(const std::string& path) {
    using namespace palpate::io;
    LiveReader reader(path, 1 << 20);
    for (int again = 0; again < 3; ++again) {
        try {
            for (const palpate::Frame& frame : reader.poll()) {
                require(std::isfinite(frame.time) && frame.number >= 0);
                require(frame.volume.bytes() == reader.header().frame_bytes());
            }
        } catch (const InputError& error) {
            require_one_line(error.what());
        }
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace palpate::io;
    try {
        const LiveHeader header =
            live_header_from({reinterpret_cast<const std::byte*>(data), size}, size, "text");
        check(header.geometry);
        require(header.slots >= 2 && header.file_bytes() <= size);
        for (std::uint64_t frame = 0; frame < 3; ++frame) {
            const std::uint64_t end =
                header.slot_at(frame) + live_slot_header_bytes + header.frame_bytes();
            require(header.slot_at(frame) >= live_header_bytes && end <= size);
        }
        require(bytes_of(header).size() == live_header_bytes);
    } catch (const InputError& error) {
        require(std::string_view(error.what()).starts_with("text: "));
        require_one_line(error.what());
    }
    const int file = memfd_create("live", MFD_CLOEXEC);
    if (file < 0) return 0;
    try {
        if (write(file, data, size) == static_cast<ssize_t>(size)) {
            read_frames("/proc/self/fd/" + std::to_string(file));
        }
    } catch (const InputError& error) {
        require_one_line(error.what());
    }
    close(file);
    return 0;
}
