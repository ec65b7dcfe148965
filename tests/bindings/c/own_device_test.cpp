// Devices of the C interface's caller that hang, give no numbers, or are slow.
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <string>
#include <utility>

#include "tests/bindings/c/hand.hpp"

namespace palpate::c::test {
namespace {

constexpr std::array both_callbacks{&Hand::in_read, &Hand::in_write};

class COwnDevice : public CRun {
  protected:
    std::string problem() const {
        std::array<char, 300> text{};
        palpate_run_text(run_, PALPATE_TEXT_PROBLEM, text.data(), text.size(), nullptr);
        return text.data();
    }
    /// A run that has a force, and a callback that does not return until the gate opens.
    void hang(const palpate_own_device& own, const Hand& hand, Gate& gate) {
        start(own);
        gate.closed = true;
        EXPECT_TRUE(comes_true([&] { return gate.reached.load(); }));
        EXPECT_GT(hand.force, 0.5);
    }
};

TEST_F(COwnDevice, a_stop_says_that_a_callback_hangs_until_it_returns_and_gets_the_zero) {
    for (Gate Hand::*const where : both_callbacks) {
        Hand hand;
        const palpate_own_device own = device_of(hand);
        Gate& gate = hand.*where;
        hang(own, hand, gate);
        for (int i = 0; i < 2; ++i) {
            EXPECT_EQ(palpate_run_stop(run_), PALPATE_NO_DEVICE);
            const std::string error = palpate_last_error();
            EXPECT_NE(error.find("its force may still be on"), std::string::npos) << error;
            EXPECT_EQ(problem(), error);
        }
        EXPECT_GT(hand.force, 0.5);
        gate.closed = false;
        EXPECT_TRUE(comes_true([&] { return palpate_run_stop(run_) == PALPATE_OK; }));
        EXPECT_EQ(hand.force, 0);
        EXPECT_EQ(problem(), "");
        palpate_run_destroy(std::exchange(run_, nullptr));
        EXPECT_EQ(hand.closes, 1);
    }
}

TEST_F(COwnDevice, another_device_is_used_and_the_one_that_hangs_is_told) {
    Hand hand;
    const palpate_own_device own = device_of(hand);
    hang(own, hand, hand.in_write);
    EXPECT_EQ(palpate_run_use_device(run_, "simulated:hand=hold"), PALPATE_NO_DEVICE);
    const std::string error = palpate_last_error();
    EXPECT_NE(error.find("its force may still be on"), std::string::npos) << error;
    EXPECT_TRUE(shows(
        [](const palpate_snapshot& now) { return now.device_status == PALPATE_DEVICE_READY; }));
    EXPECT_EQ(problem(), "");
    EXPECT_EQ(palpate_run_use_device(run_, "simulated:hand=hold"), PALPATE_OK);
    hand.in_write.closed = false;
    EXPECT_TRUE(comes_true([&] { return hand.closes == 1; }));
    EXPECT_EQ(hand.force, 0);
}

TEST_F(COwnDevice, destroying_a_run_leaves_a_callback_that_hangs_alone_until_it_returns) {
    for (Gate Hand::*const where : both_callbacks) {
        Hand hand;
        const palpate_own_device own = device_of(hand);
        Gate& gate = hand.*where;
        hang(own, hand, gate);
        palpate_run_destroy(std::exchange(run_, nullptr));
        EXPECT_EQ(hand.closes, 0);
        EXPECT_GT(hand.force, 0.5);
        EXPECT_EQ(create(&own), PALPATE_NO_DEVICE) << palpate_last_error();
        gate.closed = false;
        EXPECT_TRUE(comes_true([&] { return hand.closes == 1; }));
        EXPECT_EQ(hand.force, 0);
        EXPECT_TRUE(comes_true([&] { return create(&own) == PALPATE_OK; }));
        palpate_run_destroy(std::exchange(run_, nullptr));
    }
}

TEST_F(COwnDevice, a_pose_that_is_not_finite_is_a_fault_without_force_and_says_so) {
    start(device_of(hand_));
    constexpr double infinity = std::numeric_limits<double>::infinity();
    for (auto Hand::*const which : {&Hand::broken_position, &Hand::broken_orientation}) {
        for (const double number : {double{NAN}, infinity}) {
            ASSERT_TRUE(comes_true([&] { return hand_.force > 0.5; }));
            (hand_.*which) = number;
            EXPECT_TRUE(shows([](const palpate_snapshot& now) {
                return now.device_status == PALPATE_DEVICE_FAULT && now.felt.force[2] == 0;
            }));
            EXPECT_NE(problem().find("not finite"), std::string::npos) << problem();
            EXPECT_TRUE(comes_true([&] { return hand_.force == 0; }));
            (hand_.*which) = 0;
            EXPECT_TRUE(comes_true([&] { return problem().empty(); }));
        }
    }
}

TEST_F(COwnDevice, springs_have_to_be_stable_at_the_rate_of_the_callbacks) {
    palpate_own_device own = device_of(hand_);
    own.rate = 50;
    for (const double stiffness : {0.26, 4.9, 15.0}) {
        stiffness_ = stiffness;
        EXPECT_EQ(create(&own), PALPATE_INVALID);
        const std::string error = palpate_last_error();
        EXPECT_NE(error.find("at 50 Hz and a delay of 40.1 ms to be rendered stably"),
                  std::string::npos)
            << error;
    }
    stiffness_ = 0;
    ASSERT_EQ(create(&own), PALPATE_OK) << palpate_last_error();
    double usual = 0;
    EXPECT_EQ(palpate_run_get(run_, "force.stiffness", &usual), PALPATE_OK);
    // Not the 0.5 of its hint. A reading and a force each wait one period for the other thread.
    EXPECT_NEAR(usual, 2.5e-3 / (0.5 / 50 + 2.0 / 50 + 1e-4), 1e-12);
}

}  // namespace
}  // namespace palpate::c::test
