// A session that runs on a ball or a sequence, with a hand that stays where it is put.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <thread>

#include "apps/live/data_in_hand.hpp"
#include "apps/live/recorded_samples.hpp"
#include "support/eventually.hpp"
#include "support/scripted_device.hpp"

namespace palpate::app::test {

using namespace std::chrono_literals;

using support::comes_true;

inline LoadedVolume loaded(const std::string& name) {
    VolumeOptions options;
    options.volume = name;
    return load(options, {});
}

}  // namespace palpate::app::test
