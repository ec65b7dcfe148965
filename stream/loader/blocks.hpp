// Decoded pieces of a store, kept within a memory bound: neighbouring bricks need the same ones.
// Private to stream/.
#pragma once

#include <chrono>
#include <functional>
#include <future>
#include <list>
#include <map>
#include <mutex>

#include "palpate/stream/loader.hpp"

namespace palpate::stream {

/// What could not be had is tried again after this long.
constexpr std::chrono::seconds pause_after_failure{2};

/// Calls work(0) to work(count - 1) from so many threads; what one of them throws ends the others
/// and is passed on.
void for_all_at_once(std::size_t count, int threads, const std::function<void(std::size_t)>& work);

/// Store::read() of a large box by several threads, piece by piece, each of which says what part is
/// made.
void read_by_pieces(const Store& store, int level, const SampleBox& box, std::span<std::byte> out,
                    int threads, const std::stop_token& stop,
                    const std::function<void(double)>& made = {});

/// Any thread may call any function.
class Blocks {
  public:
    Blocks(const Store& store, std::uint64_t most_bytes) : store_(store), most_bytes_(most_bytes) {}

    /// As Store::read(). Pieces small enough to keep are read whole, and each by one thread; first
    /// those that no other thread reads, so that threads with neighbouring boxes share the work.
    void read(int level, const SampleBox& box, std::span<std::byte> out, std::stop_token stop);
    /// True if some piece of a box is neither kept nor being read.
    bool has_unread(int level, const SampleBox& box) const;
    /// Reads one such piece, if there is one.
    void read_one(int level, const SampleBox& box, std::stop_token stop);
    std::uint64_t bytes() const;

  private:
    using Key = std::array<int, 4>;  // level and place
    using Bytes = std::shared_ptr<const std::vector<std::byte>>;
    struct Kept {
        std::shared_future<Bytes> bytes;  // null if the read failed
        std::list<Key>::iterator age;
        std::uint64_t size;
    };

    Bytes block(int level, const Index3& at, const SampleBox& box, std::stop_token stop);
    bool has(int level, const Index3& at) const;
    bool keeps(int level) const;
    const Level& grid_of(int level) const;
    void forget(const Key& key);
    void forget_old(const Key& but);

    const Store& store_;
    const std::uint64_t most_bytes_;
    mutable std::mutex mutex_;
    std::map<Key, Kept> kept_;
    std::list<Key> ages_;  // newest first
    std::uint64_t bytes_ = 0;
};

}  // namespace palpate::stream
