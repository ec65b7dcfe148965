// The isosurface, extracted on a thread of its own: coarse first, the newest wish wins.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "apps/viewer/scene/surface_blocks.hpp"
#include "palpate/field.hpp"

namespace palpate::viewer {

/// A surface that can be drawn.
struct DrawnSurface {
    std::uint64_t wish = 0;  ///< which ask() or update() it answers
    double isovalue = 0;     ///< [data units]
    /// Positions from the grid's centre. Those that did not change are the same as before, and in
    /// the same place.
    MeshBlocks blocks;
    std::shared_ptr<const DrawnMesh> moving;  ///< of few triangles; null: there are none
    int every = 1;                            ///< every how manieth sample it was made from
    bool finished = false;                    ///< no finer one comes
    double seconds = 0;                       ///< since it was begun
};

struct SurfaceLimits {
    std::size_t most_triangles = 6'000'000;  ///< past that, coarser: some 0.5 GB
    std::size_t moving_triangles = 40'000;
};

class SurfaceWork {
  public:
    /// Called from the working thread: with each surface that is made (coarser ones first), and
    /// with what went wrong, in words.
    struct Results {
        std::function<void(DrawnSurface)> made;
        std::function<void(std::uint64_t wish, std::string what)> failed;
    };
    explicit SurfaceWork(Results results, const SurfaceLimits& limits = {});
    /// Stops and waits for the thread: no longer than a few blocks take.
    ~SurfaceWork();
    SurfaceWork(const SurfaceWork&) = delete;
    SurfaceWork& operator=(const SurfaceWork&) = delete;

    /// New data, or another level. What is under way is given up once its coarsest form was shown,
    /// so that a level that is dragged is always seen to move.
    void ask(std::uint64_t wish, const Field& field, double isovalue);
    /// Another version of what was asked for last, on the same grid. `changed`: only these samples
    /// have changed since the last ask() or update(), which may be forgotten for this one: what it
    /// changed is not. A small change is made in what is shown, be that fine or not yet, and the
    /// finer surface that is under way goes on with it. A large one is shown coarsely first, and
    /// finely once versions stop to come.
    void update(std::uint64_t wish, const Field& field, double isovalue, const SampleBox& changed);
    /// Nothing is wanted any more.
    void forget();

  private:
    struct Wish {
        std::uint64_t number;
        Field field;
        double isovalue;
        bool anew;          // or only `changed`
        SampleBox changed;  // since the last wish that was taken up
    };
    void run(const std::stop_token& stop);
    void carry_out(const std::stop_token& stop);
    void take_up(Wish wish);
    void flow(const std::vector<int>& steps);
    bool make_first(const std::function<bool()>& go_on);
    bool make_finer(const std::function<bool()>& go_on);
    void publish(bool finished);
    void rest(const std::stop_token& stop);
    void pace(double seconds);

    Results results_;
    SurfaceLimits limits_;
    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::optional<Wish> next_;
    std::atomic<bool> waiting_{false}, forgotten_{false};

    // The working thread's.
    std::optional<Wish> wish_;            // that is carried out
    std::optional<SurfaceBlocks> shown_;  // what was published last, or is to be brought up to it
    std::optional<SurfaceBlocks> finer_;  // under way
    std::vector<int> steps_;              // still to come after shown_, finer_'s first
    bool flowing_ = false;                // large changes come one after the other
    int pace_ = 0;                        // every how manieth sample those take; 0: not known
    std::chrono::steady_clock::time_point begun_;
    std::jthread thread_;
};

/// Every how manieth sample the steps from coarse to full take, for a grid of this size.
std::vector<int> steps_for(const Index3& size);

}  // namespace palpate::viewer
