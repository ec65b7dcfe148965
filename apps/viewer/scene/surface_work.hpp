// The isosurface, extracted on a thread of its own: coarse first, the newest wish wins.
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "apps/viewer/scene/drawn_mesh.hpp"
#include "palpate/field.hpp"

namespace palpate::viewer {

/// A surface that can be drawn.
struct DrawnSurface {
    std::uint64_t wish = 0;                   ///< which ask() it answers
    double isovalue = 0;                      ///< [data units]
    std::shared_ptr<const DrawnMesh> mesh;    ///< positions from the grid's centre
    std::shared_ptr<const DrawnMesh> moving;  ///< of few triangles; the same where it is small
    int every = 1;                            ///< every how manieth sample it was made from
    bool finished = false;                    ///< no finer one comes
    double seconds = 0;                       ///< since it was asked for
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
    /// Stops and waits for the thread: no longer than about a slice takes.
    ~SurfaceWork();
    SurfaceWork(const SurfaceWork&) = delete;
    SurfaceWork& operator=(const SurfaceWork&) = delete;

    /// Extracts this one. What is under way is given up once its coarsest form was shown, so that
    /// a level that is dragged is always seen to move.
    void ask(std::uint64_t wish, const Field& field, double isovalue);
    /// Nothing is wanted any more.
    void forget();

  private:
    struct Wish {
        std::uint64_t number;
        Field field;
        double isovalue;
    };
    void run(const std::stop_token& stop);
    void carry_out(const Wish& wish, const std::stop_token& stop);
    bool outdated(const std::stop_token& stop, bool first) const;

    Results results_;
    SurfaceLimits limits_;
    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::optional<Wish> next_;
    std::atomic<bool> waiting_{false}, forgotten_{false};
    std::jthread thread_;
};

/// Every how manieth sample the steps from coarse to full take, for a grid of this size.
std::vector<int> steps_for(const Index3& size);

}  // namespace palpate::viewer
