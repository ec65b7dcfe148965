// Boxes of a store for pictures, at the level of detail that a picture needs. They are read coarse
// levels first, in bounded memory, with few requests at a time, and after the bricks that hands
// need (loader.hpp).
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "palpate/stream/store.hpp"

namespace palpate::stream {

class Loader;

/// A part of a level of a store.
struct DetailBox {
    int level = 0;
    SampleBox box;  ///< inside that level's grid

    bool operator==(const DetailBox&) const = default;
};

/// The samples of such a box that are loaded. Missing pieces are interpolated from a coarser box
/// that was read before, or from the overview.
struct Detail {
    DetailBox of;
    Volume volume;            ///< only the box, at its place in space
    std::size_t pieces = 0;   ///< that the box lies in
    std::size_t missing = 0;  ///< of these
    SampleBox changed;        ///< of the volume's grid: since the last one of this box
};

struct DetailSettings {
    std::uint64_t memory = std::uint64_t{1} << 27;  ///< [bytes] most that decoded pieces take
    int threads = 12;  ///< that read at a time: at most half of them, and at most six, for pictures
    /// The reader's own thread calls this first, for example to lower its priority. That thread
    /// puts pictures together and calls `made`.
    std::function<void()> begin_thread = {};
    std::shared_ptr<Loader> shared = {};  ///< as that of a loader, with its threads
};

struct DetailStatus {
    std::size_t wanted = 0;   ///< pieces of the boxes that are wanted now
    std::size_t missing = 0;  ///< of these, not there yet
    std::size_t coming = 0;   ///< of these, being read
    std::size_t failed = 0;   ///< of these, tried again later
    std::uint64_t bytes = 0;  ///< that decoded pieces take
    std::string problem;      ///< the reason why pieces are missing. Usually empty
};

/// Any thread may call any function.
class DetailReader {
  public:
    /// Called from the reader's own thread.
    using Made = std::function<void(int viewer, Detail)>;

    DetailReader(std::shared_ptr<const Store> store, Volume overview, DetailSettings settings,
                 Made made);
    /// Cancels reads under way, and waits for the threads.
    ~DetailReader();
    DetailReader(const DetailReader&) = delete;
    DetailReader& operator=(const DetailReader&) = delete;

    /// Sets the boxes that this viewer needs, in place of its earlier ones. The last box is the
    /// goal. The others are coarser boxes of the same part of space, which are read first and shown
    /// until the pieces of the last one are loaded. Viewers with smaller numbers come first. While
    /// pieces are missing, versions come `interval` apart. Throws std::invalid_argument for a box
    /// that is empty or not inside its level, and for none.
    void want(int viewer, const std::vector<DetailBox>& coarse_to_fine,
              std::chrono::milliseconds interval = std::chrono::milliseconds(250));
    /// Cancels all requests of this viewer.
    void forget(int viewer);
    DetailStatus status() const;

  private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

/// Interpolates samples of a grid from a coarser one that shows the same part of space, with the
/// same directions. Beyond the border of the coarser one, its last samples are repeated. `out` has
/// the samples of the whole grid. Only those of `box` are written.
void interpolate_into(const Volume& coarse, const Geometry& grid, const SampleBox& box,
                      std::byte* out);

}  // namespace palpate::stream
