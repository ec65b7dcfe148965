// Memory for chunks while they are unpacked, which all threads of a store share. Private to
// stream/.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <stop_token>

namespace palpate::stream {

class UnpackingRoom {
  public:
    /// [bytes] 0: a quarter of this machine's memory.
    explicit UnpackingRoom(std::uint64_t most);

    std::uint64_t most() const { return most_; }

    /// A part of the room, until the end of its life.
    class Share {
      public:
        /// Waits until there are so many bytes, at most `most()`. Throws Cancelled.
        Share(UnpackingRoom& room, std::uint64_t bytes, const std::stop_token& stop);
        ~Share();
        Share(const Share&) = delete;
        Share& operator=(const Share&) = delete;

      private:
        UnpackingRoom& room_;
        std::uint64_t bytes_;
    };

  private:
    const std::uint64_t most_;
    std::mutex mutex_;
    std::condition_variable_any returned_;
    std::uint64_t taken_ = 0;
};

}  // namespace palpate::stream
