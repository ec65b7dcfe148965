// A live source, which is a process of its own. It writes a ball that moves to and fro, one frame
// every 20 ms, into a file that Palpate follows.
//   example_live_source FILE [SECONDS]      FILE for example in /dev/shm; default: until killed
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <vector>

#include "palpate/io/live_file.hpp"

namespace {

using namespace palpate;

volatile std::sig_atomic_t stopped = 0;

/// 255 in the middle, 128 on the surface, falling to 0 over 8 mm.
Volume ball(const Geometry& geometry, const Vec3& centre, double radius) {
    std::vector<std::uint8_t> samples;
    samples.reserve(static_cast<std::size_t>(sample_count(geometry)));
    for (int k = 0; k < geometry.size[2]; ++k) {
        for (int j = 0; j < geometry.size[1]; ++j) {
            for (int i = 0; i < geometry.size[0]; ++i) {
                const Vec3 at = physical_from_index(geometry, Vec3(i, j, k));
                const double depth = radius - (at - centre).norm();
                const double density = std::fmin(std::fmax(0.5 + depth / 8, 0), 1);
                samples.push_back(static_cast<std::uint8_t>(std::lround(255 * density)));
            }
        }
    }
    return Volume(geometry, std::move(samples));
}

}  // namespace

int main(int count, char** arguments) {
    if (count < 2 || count > 3) {
        std::fprintf(stderr, "usage: %s FILE [SECONDS]\n", arguments[0]);
        return 2;
    }
    const double seconds = count == 3 ? std::atof(arguments[2]) : INFINITY;
    for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { stopped = 1; });
    Geometry geometry;
    geometry.size = {48, 48, 48};
    geometry.spacing = {1, 1, 1};
    constexpr double interval = 0.02;
    try {
        io::LiveWriter writer(arguments[1], geometry, SampleType::uint8, interval);
        std::printf("%s: 50 frames a second\n", arguments[1]);
        std::fflush(stdout);
        const auto begin = std::chrono::steady_clock::now();
        for (int frame = 0; stopped == 0 && frame * interval < seconds; ++frame) {
            const double time = frame * interval;
            const Vec3 centre = physical_centre(geometry) + Vec3(8 * std::sin(3 * time), 0, 0);
            writer.push(ball(geometry, centre, 12), time);
            std::this_thread::sleep_until(begin + std::chrono::duration<double>(time + interval));
        }
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
