// A live session with nothing but the installed package: reads a volume, opens the simulated device
// by name, feels the volume until there is a force, and renders the recording again, bit for bit.
#include <algorithm>
#include <bit>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <thread>
#include <variant>

#include "ball.hpp"
#include "palpate/devices/devices.hpp"
#include "palpate/io/recording.hpp"
#include "palpate/io/volume_file.hpp"
#include "palpate/palpate.hpp"

using namespace palpate;
namespace fs = std::filesystem;

namespace {

constexpr double isovalue = 0;  // the surface of the ball

/// Feels the field with the simulated device until there is a force, and records that. How many
/// ticks there were.
long long feel(const Field& field, const fs::path& recording) {
    const auto fit = [&](const DeviceInfo& info) { return fit_workspace(field.geometry(), info); };
    const auto device =
        devices::open_device(devices::parse_device("simulated:omni,hand=press,seconds=1,loop=yes"),
                             {field, isovalue, 1000, fit});
    const DeviceInfo info = device->info();
    RendererSettings settings;
    settings.device = info.limits;
    settings.force.limit = info.limits.maximum_force;
    settings.transform = fit(info);
    Session session{make_renderer(field, isovalue, settings), {}};

    io::RecordingHead head;
    head.version = "consumer";
    head.volume = io::identify(field.volume(), {{"volume", "ball.nrrd"}});
    head.isovalue = isovalue;
    head.device = info.name + " (" + info.model + ")";
    head.method = "exact";
    head.settings = session.renderer.settings;
    head.session = session.settings;
    io::RecordingWriter writer(recording, head);
    Servo servo(std::move(session), *device, {.real_time = false, .recorder = &writer.queue()});
    servo.start();
    double greatest = 0;
    while (greatest < 0.1) {  // however long a busy machine takes
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
        const auto now = servo.snapshot();
        if (now) greatest = std::max(greatest, now->session.tick.force.norm());
    }
    servo.stop();
    writer.finish(servo.report().unrecorded);
    const long long ticks = servo.report().ticks;
    std::printf("felt with %s: %lld ticks, at most %.2f N\n", head.device.c_str(), ticks, greatest);
    return ticks;
}

bool same(const Vec3& a, const Vec3& b) {
    for (int axis = 0; axis < 3; ++axis) {
        if (std::bit_cast<std::uint64_t>(a[axis]) != std::bit_cast<std::uint64_t>(b[axis]))
            return false;
    }
    return true;
}

void render_again(const Field& field, const fs::path& recording, long long expected) {
    io::RecordingReader reader(recording);
    RendererSettings settings = reader.head().settings;
    Session session{make_renderer(field, reader.head().isovalue, settings), reader.head().session};
    long long ticks = 0;
    while (const auto event = reader.next()) {
        if (const auto* command = std::get_if<Command>(&*event)) {
            apply(session, *command);
            continue;
        }
        const auto& recorded = std::get<SessionTick>(*event);
        const SessionTick again = repeat(session, recorded);
        if (!same(recorded.tick.proxy.scp, again.tick.proxy.scp) ||
            !same(recorded.tick.force, again.tick.force)) {
            throw std::runtime_error("tick " + std::to_string(ticks) + " differs");
        }
        ++ticks;
    }
    if (ticks != expected || !reader.complete() || reader.lost() > 0) {
        throw std::runtime_error("the recording is not whole");
    }
    std::printf("rendered again: %lld ticks, the same bit for bit\n", ticks);
}

}  // namespace

int main(int, char** argv) {
    try {
        const fs::path folder = fs::absolute(argv[0]).parent_path();
        const fs::path recording = folder / "session.csv";
        fs::remove(recording);
        write_ball(folder / "ball.nrrd");
        const io::VolumeFile file = io::read_volume(folder / "ball.nrrd");
        std::printf("read ball.nrrd: %s, %d voxels a side\n", file.format.c_str(),
                    file.volume.geometry().size[0]);
        const Field field = linear_field(file.volume);
        const long long ticks = feel(field, recording);
        render_again(field, recording, ticks);
    } catch (const std::exception& e) {
        std::fprintf(stderr, "session: %s\n", e.what());
        return EXIT_FAILURE;
    }
}
