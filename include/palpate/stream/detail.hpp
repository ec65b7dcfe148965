// Boxes of a store for pictures, at the level of detail that these deserve: coarse first, in
// bounded memory, by few requests at a time, behind what hands need (loader.hpp).
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "palpate/stream/store.hpp"

namespace palpate::stream {

class Blocks;
class Pieces;

/// A part of a level of a store.
struct DetailBox {
    int level = 0;
    SampleBox box;  ///< inside that level's grid

    bool operator==(const DetailBox&) const = default;
};

/// The samples of such a box, as far as they are loaded. Missing pieces are interpolated from a
/// coarser box that was read before, or from the overview.
struct Detail {
    DetailBox of;
    Volume volume;            ///< of the box alone, in its place in space
    std::size_t pieces = 0;   ///< that the box lies in
    std::size_t missing = 0;  ///< of these
    SampleBox changed;        ///< of the volume's grid: since the last one of this box
};

struct DetailSettings {
    std::uint64_t memory = std::uint64_t{1} << 27;  ///< [bytes] most that decoded pieces take
    int threads = 6;                                ///< that read at a time
    /// How many pieces may be read at a time now. Asked often, by any thread. Empty: as many as
    /// there are threads.
    std::function<int()> most_at_a_time = {};
    /// What each thread does first, for example to lower its priority.
    std::function<void()> begin_thread = {};
    std::shared_ptr<Pieces> pieces = {};  ///< as those of a loader
};

struct DetailStatus {
    std::size_t wanted = 0;   ///< pieces of the boxes that are wanted now
    std::size_t missing = 0;  ///< of these, not there yet
    std::size_t coming = 0;   ///< of these, being read
    std::size_t failed = 0;   ///< of these, tried again later
    std::uint64_t bytes = 0;  ///< that decoded pieces take
    std::string problem;      ///< why pieces do not come. Usually empty
};

/// Any thread may call any function.
class DetailReader {
  public:
    /// Called from one of the reader's threads, for one viewer by one at a time.
    using Made = std::function<void(int viewer, Detail)>;

    DetailReader(std::shared_ptr<const Store> store, Volume overview, DetailSettings settings,
                 Made made);
    /// Cancels what is being read, and waits for the threads.
    ~DetailReader();
    DetailReader(const DetailReader&) = delete;
    DetailReader& operator=(const DetailReader&) = delete;

    /// What this viewer needs now, instead of what it needed before: the last of these boxes, and
    /// until its pieces are there coarser boxes of the same part of space, which are read first.
    /// Viewers with smaller numbers come first. While pieces are missing, versions come `interval`
    /// apart. Throws std::invalid_argument for a box that is empty or not inside its level, and for
    /// none.
    void want(int viewer, const std::vector<DetailBox>& coarse_to_fine,
              std::chrono::milliseconds interval = std::chrono::milliseconds(250));
    /// Nothing any more.
    void forget(int viewer);
    DetailStatus status() const;

  private:
    using Clock = std::chrono::steady_clock;
    struct Piece;
    struct Work;
    struct Job {
        std::shared_ptr<Work> work;
        Piece* piece = nullptr;  ///< to read. Null: the work is to be published
        bool asks = false;       ///< disk or network
    };

    void run(const std::stop_token& stop);
    std::optional<Job> next_job();
    std::optional<Job> piece_of(const std::shared_ptr<Work>& work, bool may_ask);
    void read(const Job& job, const std::stop_token& stop);
    void end_stage(Work& work);
    void make_base(Work& work) const;
    void publish(Work& work);

    const std::shared_ptr<const Store> store_;
    const Volume overview_;
    const DetailSettings settings_;
    const Made made_;
    const std::unique_ptr<Blocks> blocks_;
    mutable std::mutex mutex_;
    std::condition_variable_any changed_;
    std::map<int, std::shared_ptr<Work>> work_;  // of each viewer
    int reading_ = 0;
    std::uint64_t news_ = 0;  // counts what may be a reason to go on
    std::string problem_;
    std::vector<std::jthread> threads_;  // last: they use all of the above
};

/// The samples of a grid interpolated from a coarser one that shows the same part of space, with
/// the same directions; at its border the last samples go on. Into `out`, which holds the samples
/// of the whole grid, those of `box` alone.
void interpolate_into(const Volume& coarse, const Geometry& grid, const SampleBox& box,
                      std::byte* out);

}  // namespace palpate::stream
