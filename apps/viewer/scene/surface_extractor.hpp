// Extracts the isosurface on a thread of its own, coarse first; the newest request wins.
#pragma once

#include <atomic>
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

#include "apps/viewer/model/sample_block.hpp"
#include "apps/viewer/scene/surface_blocks.hpp"
#include "palpate/field.hpp"

namespace palpate::viewer {

/// A surface that can be drawn.
struct ExtractedSurface {
    std::uint64_t request = 0;  ///< which ask() or update() it answers
    double isovalue = 0;        ///< [data units]
    /// Positions from the grid's centre. Those that did not change are the same as before, and in
    /// the same place.
    MeshBlocks blocks;
    std::shared_ptr<const RenderMesh> moving;  ///< of few triangles; null: there are none
    int every = 1;                             ///< made from one sample for so many along each axis
    bool finished = false;                     ///< no finer one comes
    double seconds = 0;                        ///< since it was begun

    /// The very same meshes, not others like them.
    bool operator==(const ExtractedSurface&) const = default;
};

struct SurfaceLimits {
    std::size_t most_triangles = 6'000'000;  ///< past that, coarser: some 0.5 GB
    std::size_t moving_triangles = 40'000;
    bool coarse_first = true;  ///< else the full surface at once, and a coarser one where that has
                               ///< too many triangles
};

class SurfaceExtractor {
  public:
    /// Called from the working thread: with each surface that is made (coarser ones first), and
    /// with what went wrong, in words.
    struct Results {
        std::function<void(ExtractedSurface)> made;
        std::function<void(std::uint64_t request, std::string what)> failed;
    };
    explicit SurfaceExtractor(Results results, const SurfaceLimits& limits = {});
    /// Stops and waits for the thread: no longer than a few blocks take.
    ~SurfaceExtractor();

    /// New data, or another level. The extraction before it is cancelled once its coarsest surface
    /// was shown, so that the surface follows a level that is dragged.
    void ask(std::uint64_t request, const Field& field, double isovalue);
    /// Another version of the data asked for last, on the same grid. `changed`: only these samples
    /// have changed since the last ask() or update(); changes of requests that are skipped add up.
    /// An edit is made in the surface that is shown, coarse or fine, and in the finer one that is
    /// being extracted. Where all has changed it is shown coarsely first, and finely once no
    /// versions come.
    void update(std::uint64_t request, const Field& field, double isovalue,
                const SampleBox& changed);
    /// Of surfaces asked for from now on.
    void set_most_triangles(std::size_t triangles);
    /// [mm, physical] From which positions count, of surfaces asked for from now on; without it the
    /// middle of their grid.
    void set_origin(const Vec3& origin);
    void forget();

  private:
    struct Request {
        std::uint64_t number;
        Field field;
        double isovalue;
        bool anew;  // or only `changed`
        std::size_t most_triangles;
        SampleBox changed;  // since the last request that was taken up
        std::optional<Vec3> origin;
    };
    void run(const std::stop_token& stop);
    void carry_out(const std::stop_token& stop);
    void take_up(Request request);
    Field field_of(const SurfaceBlocks& blocks);
    SurfaceBlocks blocks_of(int every) const;
    void stream(const std::vector<int>& steps);
    bool make_first(const std::function<bool()>& go_on);
    bool make_finer(const std::function<bool()>& go_on);
    void publish(bool finished);
    void rest(const std::stop_token& stop);
    void adapt_step(double seconds);

    Results results_;
    SurfaceLimits limits_;
    std::optional<Vec3> origin_;
    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::optional<Request> next_;
    std::atomic<bool> waiting_{false}, forgotten_{false};

    // The working thread's.
    std::optional<Request> request_;       // that is carried out
    std::optional<SurfaceBlocks> shown_;   // what was published last, or is to be brought up to it
    std::optional<SurfaceBlocks> finer_;   // under way
    std::map<int, CoarseSamples> coarse_;  // of the field of request_, by the step
    std::vector<int> steps_;               // still to come after shown_, finer_'s first
    bool streaming_ = false;               // large changes come one after the other
    int moving_step_ = 0;                  // the step that those take; 0: not known
    std::chrono::steady_clock::time_point begun_;
    std::jthread thread_;
};

/// The steps from coarse to full, for a grid of this size: samples for one that is looked at.
std::vector<int> steps_for(const Index3& size);

}  // namespace palpate::viewer
