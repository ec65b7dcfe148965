// The same as session/main.cpp through palpate/run: a live run on a file, recorded and rendered
// again.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <thread>

#include "ball.hpp"
#include "palpate/run/replay.hpp"
#include "palpate/run/run.hpp"

using namespace palpate;
namespace fs = std::filesystem;

namespace {

/// Feels the file until there is a force, and records that. How many ticks there were.
std::int64_t feel(const fs::path& volume, const fs::path& recording) {
    run::Setup setup;
    setup.device = devices::parse_device("simulated:omni,hand=press,seconds=1,loop=yes");
    setup.field.isovalue = io::Level{0.0};  // the surface of the ball
    setup.real_time = false;
    run::Run run(std::make_shared<run::Data>(run::load(run::source_named(volume.string()))), setup);
    run.record(recording);
    run.start();
    double greatest = 0;
    while (greatest < 0.1) {  // however long a busy machine takes
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
        const auto now = run.snapshot();
        if (now) greatest = std::max(greatest, now->session.tick.force.norm());
    }
    run.stop();
    const std::int64_t ticks = run.stop_recording();
    std::printf("felt with %s: %lld ticks, at most %.2f N\n", run.device().model.c_str(),
                static_cast<long long>(ticks), greatest);
    return ticks;
}

void render_again(const fs::path& recording, std::int64_t expected) {
    io::RecordingReader reader(recording);
    const run::LoadedVolume loaded = run::load(run::recorded_source(reader.head(), recording));
    run::Replay replay(reader, loaded, recording.string());
    while (const auto tick = replay.next()) {
        if (const auto found = run::difference(tick->recorded, tick->again)) {
            throw std::runtime_error("tick " + std::to_string(tick->number) +
                                     " differs: " + found->part);
        }
    }
    if (replay.ticks() != expected || !reader.complete() || reader.lost() > 0) {
        throw std::runtime_error("the recording is not whole");
    }
    std::printf("rendered again: %lld ticks, the same bit for bit\n",
                static_cast<long long>(replay.ticks()));
}

}  // namespace

int main(int, char** argv) {
    try {
        const fs::path folder = fs::absolute(argv[0]).parent_path();
        const fs::path recording = folder / "run.csv";
        fs::remove(recording);
        write_ball(folder / "ball.nrrd");
        const std::int64_t ticks = feel(folder / "ball.nrrd", recording);
        render_again(recording, ticks);
    } catch (const std::exception& e) {
        std::fprintf(stderr, "live_run: %s\n", e.what());
        return EXIT_FAILURE;
    }
}
