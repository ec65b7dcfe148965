// Decoded pieces of a store, kept within a memory bound: neighbouring bricks need the same ones.
// Private to stream/.
#pragma once

#include <chrono>

#include "stream/loader/loader.hpp"

namespace palpate::stream {

/// What could not be had is tried again after this long.
constexpr std::chrono::seconds pause_after_failure{2};

/// The pieces of a store that one reader of it keeps. Readers with the same Loader read none that
/// another one keeps or is reading. Each has a bound of its own, and what a hand uses counts as the
/// hand's, so that eyes never drop it. Any thread may call any function.
class Blocks {
  public:
    Blocks(const Store& store, std::uint64_t most_bytes, std::shared_ptr<Loader> loader, For whom);
    ~Blocks();
    Blocks(const Blocks&) = delete;
    Blocks& operator=(const Blocks&) = delete;

    /// As Store::read(). Pieces small enough to keep are read whole, and each by one thread; first
    /// those that no other thread reads, so that threads with neighbouring boxes share the work.
    void read(int level, const SampleBox& box, std::span<std::byte> out, std::stop_token stop) {
        read(level, box, box, out, std::move(stop));
    }
    /// The same to their places in a box `room`, whose samples `out` holds.
    void read(int level, const SampleBox& box, const SampleBox& room, std::span<std::byte> out,
              std::stop_token stop);
    /// So that read() finds them, unless they are dropped meanwhile.
    void load(int level, const SampleBox& box, const std::stop_token& stop);
    /// True if all pieces of a box are here, so that read() waits for nothing.
    bool has_all(int level, const SampleBox& box) const;
    /// True if some piece of a box is neither kept nor being read.
    bool has_unread(int level, const SampleBox& box) const;
    /// Reads one such piece, if there is one.
    void read_one(int level, const SampleBox& box, std::stop_token stop);
    /// Of the pieces that count as its own.
    std::uint64_t bytes() const;

  private:
    using Key = Loader::Key;
    using Bytes = Loader::Bytes;
    using Kept = Loader::Kept;

    Bytes block(int level, const Index3& at, const SampleBox& box, std::stop_token stop);
    bool has(int level, const Index3& at) const;
    bool keeps(int level) const;
    const Level& grid_of(int level) const;
    void use(Kept& kept);
    void forget(const Key& key);
    void forget_old(const Key& but);

    const Store& store_;
    const std::uint64_t most_bytes_;
    const std::shared_ptr<Loader> loader_;
    const For whom_;
    std::list<Key> ages_;      // of its own pieces, newest first
    std::uint64_t bytes_ = 0;  // of these
};

}  // namespace palpate::stream
