// Runs a servo with a simulated hand, alone or under load, and counts how late it is woken.
#include "doctor/latency.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <string>
#include <thread>

#include "palpate/devices/devices.hpp"
#include "palpate/run/setup.hpp"
#include "palpate/scenes/volumes.hpp"

namespace palpate::doctor {
namespace {

using namespace std::chrono_literals;

constexpr const char* scene_name = "marschner-lobb:64x64x64";
constexpr std::size_t load_words = std::size_t{1} << 20;  // 8 MB a thread: more than caches hold

/// Threads that compute and move memory, as many as there are processors, until it is destroyed.
class Load {
  public:
    Load() {
        const unsigned count = std::max(1U, std::thread::hardware_concurrency());
        for (unsigned i = 0; i < count; ++i) threads_.emplace_back([this] { work(); });
    }
    ~Load() {
        done_.store(true);
        for (std::thread& thread : threads_) thread.join();
    }
    Load(const Load&) = delete;
    Load& operator=(const Load&) = delete;

  private:
    void work() const {
        std::vector<double> words(load_words, 1.0);
        double sum = 0;
        while (!done_.load(std::memory_order_relaxed)) {
            for (double& word : words) word = std::sqrt(word + sum);
            sum = words[static_cast<std::size_t>(sum) % load_words];
        }
    }

    std::atomic<bool> done_{false};
    std::vector<std::thread> threads_;
};

void wait(const LatencySettings& settings) {
    const auto begin = std::chrono::steady_clock::now();
    for (double part = 0; part < 1;) {
        std::this_thread::sleep_for(std::clamp<std::chrono::duration<double>>(
            std::chrono::duration<double>((1 - part) * settings.seconds), 1ms, 100ms));
        const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
        part = passed.count() / settings.seconds;
        settings.progress(std::min(part, 1.0));
    }
}

/// Bins that end at 1, 2, 5, 10 us and so on, from the first with a tick; the last one ends at the
/// maximum.
std::vector<LatenessBin> bins_of(const LatencyHistogram& lateness) {
    const LatencySummary all = lateness.summary();
    std::vector<LatenessBin> bins;
    std::uint64_t before = 0;
    for (double decade = 1; before < all.count; decade *= 10) {
        for (const double end : {decade, 2 * decade, 5 * decade}) {
            if (before == all.count) break;
            const auto ns = static_cast<std::int64_t>(1000 * end);
            const std::uint64_t count =
                ns >= all.max ? all.count : std::min(all.count, lateness.count_to(ns));
            if (count > 0)
                bins.push_back(
                    {std::min(end, static_cast<double>(all.max) / 1000), count - before});
            before = count;
        }
    }
    return bins;
}

}  // namespace

Latency measure_latency(const LatencySettings& settings) {
    const scenes::Scene scene = scenes::make_volume(scene_name);
    run::Setup setup;
    setup.device = devices::parse_device("simulated:omega7,loop=yes");
    const Field field = run::make_field(scene.volume, setup.field);
    const auto device = devices::open_device(
        setup.device, {field, scene.isovalue, run::usual_rate, [&](const DeviceInfo& info) {
                           return run::transform_for(field.geometry(), info, setup);
                       }});
    const Session session = run::make_session(field, scene.isovalue, device->info(), setup);

    Latency latency;
    latency.seconds = settings.seconds;
    latency.under_load = settings.under_load;
    latency.rendered = std::string("synthetic:") + scene_name + " at isovalue " +
                       std::to_string(scene.isovalue) +
                       ", smooth field, exact proxy, explored by a simulated omega.7 at 1000 Hz";
    ServoSettings servo_settings;
    servo_settings.rate = run::usual_rate;
    Servo servo(session, *device, servo_settings);
    {
        std::optional<Load> load;
        if (settings.under_load) load.emplace();
        servo.start();
        wait(settings);
        servo.stop();
    }
    latency.report = servo.report();
    latency.privileges = servo.privileges();
    latency.histogram = bins_of(servo.lateness());
    return latency;
}

}  // namespace palpate::doctor
