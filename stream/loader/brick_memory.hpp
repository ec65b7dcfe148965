// Memory of bricks, used again and again. A fast hand goes through thousands of them per second.
// The system would get memory that is freed so often back late, and the process would seem larger.
// Private to stream/.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

namespace palpate::stream {

/// Any thread may call any function and drop what it took, also after the end.
class BrickMemory {
  public:
    /// Keeps at most `most_free` pieces of `bytes` each for later.
    BrickMemory(std::size_t bytes, std::size_t most_free)
        : shared_(std::make_shared<Shared>(bytes, most_free)) {}

    /// All zero.
    std::shared_ptr<std::byte[]> take() const;
    /// Pieces that are in use.
    std::size_t used() const;
    /// All bytes that are in use or kept for later.
    std::size_t bytes() const;

  private:
    struct Shared {
        const std::size_t each, most_free;
        std::mutex mutex = {};
        std::size_t count = 0;  // that are in use or free
        std::vector<std::unique_ptr<std::byte[]>> free = {};

        Shared(std::size_t bytes, std::size_t most) : each(bytes), most_free(most) {
            free.reserve(most_free);
        }
    };
    std::shared_ptr<Shared> shared_;
};

}  // namespace palpate::stream
