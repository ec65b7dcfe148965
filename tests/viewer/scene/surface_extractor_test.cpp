// Extraction of the surface in the background.
#include <gtest/gtest.h>
#include <chrono>
#include <cmath>

#include "apps/viewer/scene/surface_extractor.hpp"
#include "palpate/scenes/volumes.hpp"
#include "palpate/surface.hpp"
#include "support/fields.hpp"

namespace palpate::viewer {
namespace {

using namespace std::chrono_literals;

/// Collects what comes from the working thread.
struct Results {
    std::mutex mutex;
    std::condition_variable changed;
    std::vector<ExtractedSurface> made;
    std::vector<std::string> failed;

    SurfaceExtractor::Results into() {
        return {[this](ExtractedSurface surface) {
                    const std::lock_guard lock(mutex);
                    made.push_back(std::move(surface));
                    changed.notify_all();
                },
                [this](std::uint64_t, const std::string& what) {
                    const std::lock_guard lock(mutex);
                    failed.push_back(what);
                    changed.notify_all();
                }};
    }
    /// False if it does not happen within a minute.
    template <class Happened>
    bool wait_for(Happened happened) {
        std::unique_lock lock(mutex);
        return changed.wait_for(lock, 60s, [&] { return happened(*this); });
    }
};

auto finished(std::uint64_t request) {
    return [request](const Results& r) {
        return !r.made.empty() && r.made.back().request == request && r.made.back().finished;
    };
}

Field ball(int edge) {
    return linear_field(scenes::ball(support::cube(edge)));
}

TEST(SurfaceExtractor, is_coarse_first_and_then_as_the_proxy_meets_it) {
    Results results;
    SurfaceExtractor work(results.into());
    const Field field = ball(100);
    work.ask(7, field, 128);
    ASSERT_TRUE(results.wait_for(finished(7)));
    ASSERT_EQ(results.made.size(), 2U);  // every 2nd sample: fewer than 350,000
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(results.made[i].request, 7U);
        EXPECT_EQ(results.made[i].isovalue, 128);
        EXPECT_EQ(results.made[i].every, 2 >> i);
        EXPECT_EQ(results.made[i].finished, i == 1);
    }
    const SurfaceMesh mesh = extract_surface(field, 128);
    EXPECT_EQ(triangle_count(results.made.back().blocks), mesh.triangles.size());
    EXPECT_LE(results.made.back().moving->triangle_count(),
              SurfaceLimits().moving_triangles * 5 / 4);
}

TEST(SurfaceExtractor, steps_start_small_and_end_with_every_sample) {
    for (const Index3& size :
         {Index3(1, 1, 1), Index3(64, 64, 64), Index3(512, 512, 640), Index3(3000, 20, 1)}) {
        const std::vector<int> steps = steps_for(size);
        EXPECT_EQ(steps.back(), 1);
        EXPECT_LE(size.cast<double>().prod() / std::pow(steps.front(), 3), 350'000);
        for (std::size_t i = 1; i < steps.size(); ++i) EXPECT_EQ(steps[i - 1], 2 * steps[i]);
    }
}

TEST(SurfaceExtractor, the_newest_of_fifty_requests_is_the_last_one_extracted) {
    Results results;
    SurfaceExtractor work(results.into());
    const Field field = ball(80);
    for (int i = 1; i <= 50; ++i) work.ask(std::uint64_t(i), field, 60 + 3 * i);
    ASSERT_TRUE(results.wait_for(finished(50)));
    EXPECT_EQ(results.made.back().isovalue, 210);
    // Not all were carried out, and none out of its turn.
    EXPECT_LT(results.made.size(), 50U);
    for (std::size_t i = 1; i < results.made.size(); ++i) {
        EXPECT_LE(results.made[i - 1].request, results.made[i].request);
    }
}

TEST(SurfaceExtractor, keeps_within_its_triangles) {
    Results results;
    SurfaceLimits limits;
    limits.most_triangles = 20'000;
    limits.moving_triangles = 2'000;
    SurfaceExtractor work(results.into(), limits);
    work.ask(1, ball(64), 128);
    ASSERT_TRUE(results.wait_for(finished(1)));
    EXPECT_GT(results.made.back().every, 1);
    EXPECT_LE(triangle_count(results.made.back().blocks), 20'000U);
    EXPECT_LE(results.made.back().moving->triangle_count(), 2'500U);
    EXPECT_GT(results.made.back().moving->triangle_count(), 100U);
}

TEST(SurfaceExtractor, says_what_is_wrong_with_an_isovalue_and_goes_on) {
    Results results;
    SurfaceExtractor work(results.into());
    const Field field = ball(16);
    work.ask(1, field, std::nan(""));
    ASSERT_TRUE(results.wait_for([](const Results& r) { return !r.failed.empty(); }));
    EXPECT_FALSE(results.failed.front().empty());
    work.ask(2, field, 128);
    ASSERT_TRUE(results.wait_for(finished(2)));
}

TEST(SurfaceExtractor, can_be_destroyed_while_it_extracts) {
    Results results;
    {
        SurfaceExtractor work(results.into());
        work.ask(1,
                 linear_field(support::noise_volume<std::uint8_t>(support::grid(support::cube(160)),
                                                                  3, 0, 256)),
                 128);
        ASSERT_TRUE(results.wait_for([](const Results& r) { return !r.made.empty(); }));
    }
    EXPECT_FALSE(results.made.back().finished);
}

TEST(SurfaceExtractor, a_dropped_request_gives_no_surface) {
    Results results;
    SurfaceExtractor work(results.into());
    work.ask(1,
             linear_field(
                 support::noise_volume<std::uint8_t>(support::grid(support::cube(160)), 3, 0, 256)),
             128);
    work.forget();
    work.ask(2, ball(16), 128);
    ASSERT_TRUE(results.wait_for(finished(2)));
    for (const ExtractedSurface& made : results.made) {
        EXPECT_FALSE(made.request == 1 && made.finished);
    }
}

}  // namespace
}  // namespace palpate::viewer
