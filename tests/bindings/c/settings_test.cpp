// Settings by name in the C interface: their descriptions, and that setting one has its effect.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "tests/bindings/c/ball.hpp"

namespace palpate::c::test {
namespace {

std::vector<palpate_setting> described() {
    std::vector<palpate_setting> all;
    for (std::size_t i = 0; i < palpate_setting_count(); ++i) {
        PALPATE_STRUCT(palpate_setting, setting);
        EXPECT_EQ(palpate_setting_describe(i, &setting), PALPATE_OK) << palpate_last_error();
        all.push_back(setting);
    }
    return all;
}

/// Another value, which can be rendered with all others as they are.
double another(double value) {
    if (value == 0) return 1e-4;
    return std::isfinite(value) ? 0.9 * value : 7;
}

class CSettings : public testing::Test {
  protected:
    CSettings() {
        palpate_volume* const volume = ball();
        PALPATE_STRUCT(palpate_render_options, options);
        options.has_isovalue = 1;
        options.isovalue = 100;
        options.static_friction = 0.5;
        options.dynamic_friction = 0.25;
        EXPECT_EQ(palpate_field_create(volume, nullptr, &field_), PALPATE_OK);
        EXPECT_EQ(palpate_renderer_create(field_, &options, nullptr, &renderer_), PALPATE_OK)
            << palpate_last_error();
        palpate_volume_destroy(volume);
    }
    ~CSettings() override {
        palpate_renderer_destroy(renderer_);
        palpate_field_destroy(field_);
    }
    double value(const char* name) const {
        double value = NAN;
        EXPECT_EQ(palpate_renderer_get(renderer_, name, &value), PALPATE_OK)
            << palpate_last_error();
        return value;
    }
    /// The largest force [N] of a hand that presses 8 mm into the ball.
    double largest_force() const {
        double largest = 0;
        for (int i = 0; i < 1500; ++i) {
            PALPATE_STRUCT(palpate_hand, hand);
            PALPATE_STRUCT(palpate_felt, felt);
            hand.time = 1 + 0.001 * i;
            hand.position[2] = std::max(12.0, 25 - 0.02 * i);
            EXPECT_EQ(palpate_renderer_render(renderer_, &hand, &felt), PALPATE_OK);
            largest = std::max(largest, std::hypot(felt.force[0], felt.force[1], felt.force[2]));
        }
        return largest;
    }

    palpate_field* field_ = nullptr;
    palpate_renderer* renderer_ = nullptr;
};

TEST_F(CSettings, each_is_described_and_its_default_is_in_its_range) {
    std::set<std::string> names;
    for (const palpate_setting& one : described()) {
        names.insert(one.name);
        EXPECT_STRNE(one.about, "") << one.name;
        EXPECT_TRUE(one.open ? one.usual > one.least : one.usual >= one.least) << one.name;
        EXPECT_LE(one.usual, one.most) << one.name;
    }
    EXPECT_EQ(names.size(), palpate_setting_count());
    EXPECT_GT(names.size(), 20U);
    PALPATE_STRUCT(palpate_setting, setting);
    EXPECT_EQ(palpate_setting_describe(palpate_setting_count(), &setting), PALPATE_INVALID);
}

TEST_F(CSettings, an_error_is_one_line_of_whole_characters) {
    EXPECT_EQ(palpate_renderer_set(renderer_, "a\nb\x7f", 1), PALPATE_INVALID);
    const std::string line = palpate_last_error();
    EXPECT_NE(line.find("a b "), std::string::npos) << line;
    for (std::size_t shift = 0; shift < 3; ++shift) {
        std::string name(shift, 'x');
        for (int i = 0; i < 1000; ++i) name += "\u20ac";  // three bytes each
        EXPECT_EQ(palpate_renderer_set(renderer_, name.c_str(), 1), PALPATE_INVALID);
        const std::string cut = palpate_last_error();
        const std::size_t first = cut.find("\u20ac"), gap = cut.find(" ... ");
        ASSERT_NE(gap, std::string::npos) << cut;
        EXPECT_EQ((gap - first) % 3, 0U) << cut;
        EXPECT_GT(cut.size(), 800U);
        EXPECT_NE(cut.find("limits."), std::string::npos) << cut;  // the end: what to use instead
    }
}

TEST_F(CSettings, what_is_set_by_any_name_is_what_a_renderer_has) {
    for (const palpate_setting& one : described()) {
        const double before = value(one.name), wanted = another(before);
        ASSERT_NE(before, wanted) << one.name;
        ASSERT_EQ(palpate_renderer_set(renderer_, one.name, wanted), PALPATE_OK)
            << one.name << ": " << palpate_last_error();
        EXPECT_EQ(value(one.name), wanted) << one.name;
        ASSERT_EQ(palpate_renderer_set(renderer_, one.name, before), PALPATE_OK)
            << one.name << ": " << palpate_last_error();
    }
}

TEST_F(CSettings, a_limit_is_kept_from_the_next_tick_on) {
    EXPECT_GT(largest_force(), 3);
    ASSERT_EQ(palpate_renderer_set(renderer_, "force.limit", 0.5), PALPATE_OK);
    EXPECT_LE(largest_force(), 0.5 + 1e-12);
}

TEST_F(CSettings, names_and_values_that_cannot_be_are_refused_and_change_nothing) {
    for (const palpate_setting& one : described()) {
        const double before = value(one.name);
        EXPECT_EQ(palpate_renderer_set(renderer_, one.name, NAN), PALPATE_INVALID) << one.name;
        EXPECT_EQ(palpate_renderer_set(renderer_, one.name, -1), PALPATE_INVALID) << one.name;
        EXPECT_EQ(value(one.name), before) << one.name;
    }
    double value = 5;
    EXPECT_EQ(palpate_renderer_get(renderer_, "force.stifness", &value), PALPATE_INVALID);
    EXPECT_NE(std::string(palpate_last_error()).find("did you mean force.stiffness"),
              std::string::npos)
        << palpate_last_error();
    EXPECT_EQ(value, 5);
    EXPECT_EQ(palpate_renderer_get(renderer_, nullptr, &value), PALPATE_INVALID);
    EXPECT_EQ(palpate_renderer_set(nullptr, "force.limit", 1), PALPATE_INVALID);
    EXPECT_EQ(palpate_run_set(nullptr, "force.limit", 1), PALPATE_INVALID);
    EXPECT_EQ(palpate_run_set(nullptr, nullptr, 1), PALPATE_INVALID);
}

TEST(CRanges, only_their_levels_are_touched) {
    palpate_volume* const volume = ball();
    palpate_field* field = nullptr;
    ASSERT_EQ(palpate_field_create(volume, nullptr, &field), PALPATE_OK);
    palpate_volume_destroy(volume);
    const std::array<double, 2> range{150, 160};  // from 10 mm
    PALPATE_STRUCT(palpate_render_options, options);
    options.ranges = range.data();
    palpate_renderer* renderer = nullptr;
    EXPECT_EQ(palpate_renderer_create(field, &options, nullptr, &renderer), PALPATE_INVALID);
    options.range_count = 1;
    const auto refuses_isovalue = [&](palpate_render_options with) {
        with.has_isovalue = 1;
        with.isovalue = 100;
        EXPECT_EQ(palpate_renderer_create(field, &with, nullptr, &renderer), PALPATE_INVALID);
        EXPECT_TRUE(std::string(palpate_last_error()).starts_with("isovalue does nothing: "));
    };
    refuses_isovalue(options);
    PALPATE_STRUCT(palpate_render_options, layered);
    layered.layers = "sample-head";
    refuses_isovalue(layered);
    ASSERT_EQ(palpate_renderer_create(field, &options, nullptr, &renderer), PALPATE_OK)
        << palpate_last_error();
    for (int i = 0; i < 1000; ++i) {
        PALPATE_STRUCT(palpate_hand, hand);
        PALPATE_STRUCT(palpate_felt, felt);
        hand.time = 1 + 0.001 * i;
        hand.position[2] = 25 - 0.0155 * i;
        ASSERT_EQ(palpate_renderer_render(renderer, &hand, &felt), PALPATE_OK);
        if (std::abs(hand.position[2] - 10) < 0.1) continue;
        EXPECT_EQ(felt.mode == PALPATE_CONSTRAINED, hand.position[2] < 10) << hand.position[2];
    }
    palpate_renderer_destroy(renderer);
    palpate_field_destroy(field);
}

}  // namespace
}  // namespace palpate::c::test
