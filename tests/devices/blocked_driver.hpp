// A vendor's driver that does not answer, and a program that does not wait for it.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <future>
#include <string>

#include "devices/claim.hpp"
#include "palpate/devices/backend.hpp"
#include "support/eventually.hpp"

namespace palpate::support {

/// Opens a device by open(progress) while its driver does not answer, and stops that. `block` gives
/// the driver a function that does not return, or an empty one.
template <class Open, class Block>
void expect_a_stopped_opening_is_left_alone(const Open& open, const Block& block) {
    struct Stopped {};
    const int hand = 0;
    const devices::OpenedBy opened_by(&hand, [] {
        ADD_FAILURE() << "the hand gives up its device for one that cannot be opened";
    });
    std::promise<void> answer;
    // For long only, so that a program that waits for it fails and does not hang.
    const auto end = answer.get_future().share();
    block(std::function<void()>([end] { end.wait_for(std::chrono::seconds(20)); }));
    const auto stop = [calls = 0](double) mutable {
        if (++calls == 4) throw Stopped{};
    };
    EXPECT_THROW(open(stop), Stopped);
    block(std::function<void()>{});
    try {
        open(OnProgress{});
        ADD_FAILURE() << "it was opened twice";
    } catch (const devices::DeviceError& error) {
        EXPECT_NE(std::string(error.what()).find("its driver has not returned"), std::string::npos)
            << error.what();
    }
    answer.set_value();
    const auto opens = [&] {
        try {
            return open(OnProgress{}) != nullptr;
        } catch (const devices::DeviceError&) {
            return false;
        }
    };
    EXPECT_TRUE(comes_true(opens)) << "it was not closed when the driver had opened it";
}

}  // namespace palpate::support
