// Decoded pieces of a store, kept within a memory bound: neighbouring bricks need the same ones.
// Private to stream/.
#pragma once

#include <chrono>

#include "stream/loader/loader.hpp"

namespace palpate::stream {

/// What could not be had is tried again after this long.
constexpr std::chrono::seconds pause_after_failure{2};

/// The samples of a box, x fastest, shared by all who hold them.
struct StoredPiece {
    SampleBox box = {};
    std::shared_ptr<const std::vector<std::byte>> samples = {};  ///< null: not in memory
};

/// The pieces of a store that one reader of it keeps. Readers with the same Loader read none that
/// another one keeps or is reading. Each has a bound of its own, and what a hand uses counts as the
/// hand's, so that eyes never drop it. Any thread may call any function.
class Blocks {
  public:
    Blocks(const Store& store, std::uint64_t most_bytes, std::shared_ptr<Loader> loader, For whom);
    ~Blocks();
    Blocks(const Blocks&) = delete;
    Blocks& operator=(const Blocks&) = delete;

    /// Whether pieces of a level are kept. False for those that are too large, and for rows, which
    /// cost nothing to read in parts.
    bool keeps(int level) const;
    /// As Store::read(), to the places of the samples in a box `room`, which `out` holds. Pieces
    /// small enough to keep are read whole, and each by one thread; first those that no other
    /// thread reads, so that threads with neighbouring boxes share the work.
    void read(int level, const SampleBox& box, const SampleBox& room, std::span<std::byte> out,
              const std::stop_token& stop);
    /// So that read() finds them, unless they are dropped meanwhile.
    void load(int level, const SampleBox& box, const std::stop_token& stop);
    /// The same for one piece of the box, the first that no other thread reads. False if there is
    /// none.
    bool load_one(int level, const SampleBox& box, const std::stop_token& stop);
    /// The piece that holds `part`, or `part` alone if pieces of the level are not kept.
    StoredPiece piece(int level, const SampleBox& part, const std::stop_token& stop);
    /// The same, without samples unless they are in memory: waits for nothing.
    StoredPiece kept(int level, const SampleBox& part);
    /// Whether each piece of a box is kept or being read.
    bool has_all(int level, const SampleBox& box) const;
    /// Of the pieces that count as its own.
    std::uint64_t bytes() const;

  private:
    using Key = Loader::Key;
    using Bytes = Loader::Bytes;
    using Kept = Loader::Kept;

    static Key key_of(int level, const SampleBox& piece) {
        return {level, piece.low[0], piece.low[1], piece.low[2]};
    }

    template <class Work>
    void for_each_stored(int level, const SampleBox& box, Work&& work) const;
    SampleBox whole(int level, const SampleBox& part) const;
    Bytes read_now(int level, const SampleBox& box, const std::stop_token& stop) const;
    Bytes block(int level, const SampleBox& box, const std::stop_token& stop);
    bool read_if_unread(int level, const SampleBox& box, const std::stop_token& stop);
    std::shared_future<Bytes> others_or_claim(int level, const SampleBox& box,
                                              std::promise<Bytes>& promise);
    Bytes read_claimed(int level, const SampleBox& box, std::promise<Bytes>& promise,
                       const std::stop_token& stop);
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
