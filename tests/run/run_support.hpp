// Runs and servos that are driven by steps: a test says how far their time goes.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "palpate/run/recorded_samples.hpp"
#include "palpate/run/replay.hpp"
#include "palpate/run/run.hpp"
#include "support/eventually.hpp"
#include "support/scripted_device.hpp"

namespace palpate::run::test {

using support::comes_true;

inline LoadedVolume loaded(const std::string& name) {
    return load(source_named(name));
}

inline std::shared_ptr<Data> stepped_data(LoadedVolume loaded, const PlaybackSetup& playback = {}) {
    return std::make_shared<Data>(std::move(loaded), playback, Pace::by_steps);
}

inline Setup with_device(const std::string& device) {
    Setup setup;
    setup.device = devices::parse_device(device);
    setup.real_time = false;
    return setup;
}

/// Another device, until `fails`: then its driver throws.
class Failing final : public Device {
  public:
    Failing(std::unique_ptr<Device> device, const bool& fails)
        : device_(std::move(device)), fails_(fails) {}

    DeviceInfo info() const override { return device_->info(); }
    DeviceReading read(double time) override {
        if (fails_) throw std::runtime_error("the cable was pulled");
        return device_->read(time);
    }
    void write(const Wrench& wrench, double time) override { device_->write(wrench, time); }
    void stop() noexcept override { device_->stop(); }

  private:
    std::unique_ptr<Device> device_;
    const bool& fails_;
};

/// The device of this name, which fails as above.
inline Setup with_failing(const std::string& device, const bool& fails) {
    Setup setup = with_device(device);
    setup.open_device = [&fails](const auto& choice, const auto& scene) {
        return std::make_unique<Failing>(devices::open_device(choice, scene), fails);
    };
    return setup;
}

/// Steps until something holds; false if it does not within a minute of the session. While data is
/// being read that time stands still, almost: it is the reader's threads that take long.
template <class Step, class Settled, class Condition>
bool steps_until(Step&& step, Settled&& is_settled, Condition&& holds) {
    for (double steps = 0; steps < 60'000;) {
        if (holds()) return true;
        const bool settled = is_settled();
        if (!settled) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        steps += settled ? 1 : 0.5;
        step();
    }
    return false;
}

template <class Condition>
bool steps_until(Run& live, Condition&& holds) {
    return steps_until([&] { live.step(); }, [&] { return live.data().is_settled(); }, holds);
}

/// So many ticks.
inline void step(Run& live, int ticks) {
    for (int i = 0; i < ticks; ++i) live.step();
}

/// Renders a recording again and expects the same ticks; returns how many there are.
inline std::int64_t expect_same_again(Replay& replay) {
    while (const auto tick = replay.next()) {
        const auto differs = difference(tick->recorded, tick->again);
        EXPECT_FALSE(differs) << "tick " << tick->number << ": " << differs->part << " was "
                              << differs->recorded << ", is " << differs->again;
        if (differs) break;
    }
    return replay.ticks();
}

/// A servo that is stepped on `device`; `told` gets the history, if it is not null.
inline StartServo servo_on(Device& device, std::vector<Command>* told = nullptr) {
    return [&device, told](Session session, const std::vector<Command>& history) {
        if (told) *told = history;
        return std::make_unique<Servo>(std::move(session), device, ServoSettings{.rate = 1000});
    };
}

/// The time of servos and of what follows them, which tests move on.
class Time {
  public:
    /// One tick of each servo; then, every 4 ms, `work`.
    template <class Work>
    void step(std::initializer_list<Servo*> servos, Work&& work) {
        for (Servo* servo : servos) servo->step(std::int64_t{1'000'000} * ticks_);
        if (++ticks_ % 4 == 0) work(now());
    }
    std::chrono::steady_clock::time_point now() const {
        return std::chrono::steady_clock::time_point(std::chrono::milliseconds(ticks_));
    }

  private:
    std::int64_t ticks_ = 0;
};

}  // namespace palpate::run::test
