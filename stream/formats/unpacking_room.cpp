// Memory for chunks while they are unpacked. See the header.
#include "stream/formats/unpacking_room.hpp"

#include "io/system/system.hpp"
#include "palpate/stream/store.hpp"

namespace palpate::stream {

UnpackingRoom::UnpackingRoom(std::uint64_t most)
    : most_(most > 0 ? most : io::machine_memory() / 4) {}

UnpackingRoom::Share::Share(UnpackingRoom& room, std::uint64_t bytes, const std::stop_token& stop)
    : room_(room), bytes_(bytes) {
    std::unique_lock lock(room_.mutex_);
    const auto fits = [&] { return room_.taken_ + bytes_ <= room_.most_; };
    if (!room_.returned_.wait(lock, stop, fits)) throw Cancelled{};
    room_.taken_ += bytes_;
}

UnpackingRoom::Share::~Share() {
    {
        const std::lock_guard lock(room_.mutex_);
        room_.taken_ -= bytes_;
    }
    room_.returned_.notify_all();
}

}  // namespace palpate::stream
