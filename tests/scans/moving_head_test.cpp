// A head that turns from frame to frame: the proxy under a surface that moves. Needs the data
// folder beside the project, and is skipped without it.
#include <gtest/gtest.h>

#include <filesystem>

#include "io/real_volumes.hpp"
#include "palpate/io/volume_file.hpp"
#include "support/moving.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

/// The frames, `interval` [s] apart; there and back.
std::shared_ptr<const Samples> turning_head(const std::filesystem::path& path, double interval) {
    std::vector<Volume> volumes;
    int steps = 1;
    for (int i = 0; i < steps; ++i) {
        io::ReadOptions options;
        options.time_step = i;
        const io::VolumeFile file = io::read_volume(path, options);
        steps = file.time_steps;
        volumes.push_back(file.volume);
    }
    for (int i = steps - 2; i > 0; --i) volumes.push_back(volumes[std::size_t(i)]);
    std::vector<Frame> frames;
    for (Volume& volume : volumes) {
        frames.push_back({interval * double(frames.size()), std::move(volume)});
    }
    return std::make_shared<const Samples>(std::move(frames), interval * double(volumes.size()));
}

/// Slides over a part of the head for `ticks`; the sequence is played or pushed frame by frame.
void feel(const std::shared_ptr<const Samples>& head, double isovalue, const Vec3& way,
          double interval, bool pushed, int ticks, MovingContact& contact) {
    const Vec3 centre = physical_centre(head->geometry());
    apply(contact.session, command::Speed{pushed ? 0.0 : 1.0});
    Random random(3);
    for (int i = 0; i < ticks; ++i) {
        const int every = int(1000 * interval);
        if (pushed && i % every == 0) {
            const auto frame = std::size_t(i / every) % head->frames().size();
            apply(contact.session, command::Samples{samples_of(head->frames()[frame].volume)});
        }
        // Pressed into where the surface lies now, and about along it. The brain at 600 is full of
        // holes, in many of which the hand is free.
        const double t = 1e-3 * i;
        const Vec3 from = centre + 200 * (way + 0.2 * Vec3(std::sin(2 * t), std::sin(1.3 * t),
                                                           std::sin(1.7 * t)));
        const RayHit surface = cast_ray(contact.field(), isovalue, from, centre);
        const Vec3 aim = surface.point + 12 * (centre - from).normalized();
        contact.hand += 0.05 * (aim - contact.hand);
        contact.tick();
        if (testing::Test::HasFatalFailure()) return;
    }
}

}  // namespace

TEST(MovingHead, a_head_that_turns_between_frames_keeps_the_guarantees) {
    const auto path = io::test::real_volume("fmri_headturn_4d.nrrd");
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path.filename() << " is not here";
    // The scanner took 3.2 s a frame; here the head turns as fast as one can, and much faster.
    for (const double interval : {0.5, 0.1, 0.02}) {
        const auto head = turning_head(path, interval);
        ASSERT_EQ(head->frames().size(), 10U);
        for (const double isovalue : {300.0, 600.0}) {
            for (const bool pushed : {false, true}) {
                SCOPED_TRACE(std::to_string(interval) + " s a frame at " +
                             std::to_string(isovalue) + (pushed ? ", pushed" : ", played"));
                const Vec3 way = Vec3(0.3, -1, 0.4).normalized();
                MovingContact contact(head, isovalue,
                                      physical_centre(head->geometry()) + 150 * way);
                // Not scaled(): fewer ticks do not show every kind of contact asked for below.
                feel(head, isovalue, way, interval, pushed, 10'000, contact);
                if (HasFatalFailure()) return;
                std::printf(
                    "[ evidence ] %4.0f ms a frame, at %3.0f, %s: constrained %.2f, "
                    "recovering %lld, rate limited %lld of %lld, G1 %.1e\n",
                    1000 * interval, isovalue, pushed ? "pushed" : "played",
                    double(contact.constrained) / double(contact.ticks),
                    static_cast<long long>(contact.recovering),
                    static_cast<long long>(contact.rate_limited),
                    static_cast<long long>(contact.ticks), contact.worst_g1);
                EXPECT_GT(contact.constrained, contact.ticks / 25);
                EXPECT_EQ(contact.recovering, 0);
                EXPECT_GT(contact.rate_limited, 0);
            }
        }
    }
}
