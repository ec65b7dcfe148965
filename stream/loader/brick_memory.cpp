// Memory of bricks. See the header.
#include "stream/loader/brick_memory.hpp"

#include <cstring>

namespace palpate::stream {

std::shared_ptr<std::byte[]> BrickMemory::take() const {
    std::unique_ptr<std::byte[]> bytes;
    {
        const std::scoped_lock lock(shared_->mutex);
        if (!shared_->free.empty()) {
            bytes = std::move(shared_->free.back());
            shared_->free.pop_back();
        }
    }
    const bool is_new = !bytes;
    if (is_new) bytes.reset(new std::byte[shared_->each]);
    std::memset(bytes.get(), 0, shared_->each);
    const auto give_back = [shared = shared_](std::byte* dropped) {
        std::unique_ptr<std::byte[]> own(dropped);
        const std::scoped_lock lock(shared->mutex);
        if (shared->free.size() < shared->most_free) {
            shared->free.push_back(std::move(own));
        } else {
            --shared->count;
        }
    };
    if (is_new) {
        const std::scoped_lock lock(shared_->mutex);
        ++shared_->count;
    }
    return {bytes.release(), give_back};
}

std::size_t BrickMemory::used() const {
    const std::scoped_lock lock(shared_->mutex);
    return shared_->count - shared_->free.size();
}

std::size_t BrickMemory::bytes() const {
    const std::scoped_lock lock(shared_->mutex);
    return shared_->count * shared_->each;
}

}  // namespace palpate::stream
