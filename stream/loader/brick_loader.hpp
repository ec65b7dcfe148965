// The state of a BrickLoader. Private to stream/loader.
#pragma once

#include <atomic>
#include <condition_variable>
#include <list>
#include <map>
#include <mutex>

#include "palpate/stream/loader.hpp"
#include "stream/box_bytes.hpp"
#include "stream/loader/blocks.hpp"
#include "stream/loader/brick_memory.hpp"

namespace palpate::stream {

struct BrickLoader::Parts {
    struct Job {
        Index3 brick;
        int coarser;
        bool helps;  ///< another thread makes the brick; this one reads a piece of it
    };
    /// A wait_for() that has not ended.
    struct Waiting {
        std::vector<Index3> needed;
        std::uint64_t number;  ///< in the order in which they began, from 1
        std::string problem;   ///< why one of them cannot be had
    };
    using Clock = std::chrono::steady_clock;

    Parts(std::shared_ptr<const Store> store, Volume overview, const BrickLoaderSettings& settings);

    void look(std::span<const Interest> hands, Clock::time_point now);
    std::optional<BrickVersion> take();
    void wait_for(const Vec3& centre, double radius, const std::stop_token& stop);
    BrickLoaderStatus status() const;
    void read(const SampleBox& box, std::span<std::byte> out, const std::stop_token& stop);
    void leave_room(std::uint64_t bytes);
    Brick read(const Index3& brick, int coarser, const std::stop_token& stop);

    Turn next(bool urgent);
    void make(const Job& job, std::uint64_t waits, const std::stop_token& stop);
    void help(const Job& job, const std::stop_token& stop);
    SampleBox source_of(const Index3& brick, int coarser) const;
    bool has_all(const Index3& brick, int coarser) const;
    std::optional<Job> next_job(bool urgent);
    int for_eyes() const;
    std::optional<Job> job_for(const Index3& brick, int level, Clock::time_point now) const;
    bool has(const Index3& brick, int level) const;
    bool is_behind() const;
    void want(std::vector<Index3> bricks);
    void wake();
    void put(const Job& job, const Brick& brick);
    void fail(const Index3& brick, const std::string& problem, std::uint64_t begun);
    void make_room();
    void choose_levels(std::span<const Interest> hands, Clock::time_point now);
    std::uint64_t bytes() const;
    void count_process();

    /// All samples of a brick's memory, also those beyond the grid.
    static SampleBox room_of(const Index3& brick) {
        const Index3 low = brick * ResidentBricks::edge;
        return {low, low + Index3::Constant(ResidentBricks::edge - 1)};
    }

    const std::shared_ptr<const Store> store_;
    const BrickLoaderSettings settings_;
    const Volume overview_;
    const std::shared_ptr<const Samples> empty_;
    const Geometry geometry_;
    std::atomic<std::size_t> most_bricks_;
    const std::shared_ptr<Loader> loader_;
    const std::unique_ptr<Blocks> blocks_;
    const std::unique_ptr<BrickMemory> memory_;

    mutable std::mutex mutex_;
    std::condition_variable_any changed_;                  // for who waits
    ResidentBricks bricks_;                                // as taken last
    std::map<Index3, Brick, ByPlace> held_;                // in memory now
    Clock::time_point newest_{};                           // when the last of those came
    std::map<Index3, int, ByPlace> in_flight_;             // level that is being read
    std::map<Index3, Clock::time_point, ByPlace> failed_;  // not tried again before
    std::vector<Index3> wanted_;                           // most urgent first
    std::array<std::size_t, 4> begun_{};  // of each of next_job()'s rounds: all before is there
    std::list<Waiting> waiting_;
    std::uint64_t waits_ = 0;     // calls of wait_for() so far
    int first_ = 0, finest_ = 0;  // steps coarser that are read, coarse_first
    double brick_s_ = 0;          // that a brick lately took to come, 0: none yet
    double speed_ = 0;            // of the fastest hand [bricks/s]
    Clock::time_point looked_{};  // when that was
    std::vector<BrickEvent> events_;
    std::uint64_t other_bytes_ = 0;    // leave_room()
    std::uint64_t process_bytes_ = 0;  // of the process, beyond bricks, pieces and edits
    Clock::time_point counted_{};      // when those were
    std::uint64_t most_bytes_ = 0, loaded_ = 0, dropped_ = 0;
    std::string problem_;
    const Reading reading_;  // last: its jobs use all of the above
};

}  // namespace palpate::stream
