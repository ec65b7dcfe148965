// A session that runs on a ball or a sequence, with a hand that stays where it is put.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <thread>

#include "apps/live/data_in_hand.hpp"
#include "apps/live/recorded_samples.hpp"
#include "support/scripted_device.hpp"

namespace palpate::app::test {

using namespace std::chrono_literals;

/// Patience is for slow machines; what is waited for comes in milliseconds.
inline bool comes_true(const std::function<bool()>& happened) {
    for (int i = 0; i < 20'000; ++i) {
        if (happened()) return true;
        std::this_thread::sleep_for(1ms);
    }
    return false;
}

inline LoadedVolume loaded(const std::string& name) {
    VolumeOptions options;
    options.volume = name;
    return load(options, {});
}

}  // namespace palpate::app::test
