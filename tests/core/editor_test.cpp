// Editor: undo and redo against a list of whole copies.
#include "palpate/edit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "support/edits.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

edit::Fill fill(int at, double value) {
    return {{Index3::Constant(at), Index3::Constant(at)}, value};
}

TEST(Editor, undo_and_redo_lead_through_the_versions_as_they_were) {
    const Geometry geometry = odd_grids()[4];
    for (const SampleType type : {SampleType::uint8, SampleType::float32}) {
        Random random(7);
        const auto begin = samples_of(noise_of(type, geometry, 1));
        Editor editor(begin);
        std::vector<Volume> copies{begin->volume()};
        std::size_t now = 0;
        int undone = 0, redone = 0;
        for (int i = 0; i < scaled(400) + 20; ++i) {
            const int choice = random.below(5);
            const Volume before = flattened(*editor.samples());
            SampleBox box;
            if (choice == 0) {
                box = editor.undo();
                EXPECT_EQ(box.empty(), now == 0);
                now -= now > 0;
                ++undone;
            } else if (choice == 1) {
                box = editor.redo();
                EXPECT_EQ(box.empty(), now + 1 == copies.size());
                redone += now + 1 < copies.size();
                now += now + 1 < copies.size();
            } else {
                box = editor.apply(random_edit(random, geometry, type));
                if (!box.empty()) {
                    copies.erase(copies.begin() + static_cast<std::ptrdiff_t>(++now), copies.end());
                    copies.push_back(flattened(*editor.samples()));
                }
            }
            ASSERT_TRUE(same_bits(flattened(*editor.samples()), copies[now])) << "step " << i;
            ASSERT_EQ(editor.undo_steps(), now);
            ASSERT_EQ(editor.redo_steps(), copies.size() - 1 - now);
            ASSERT_EQ(editor.changed(), editor.samples() != begin);
            for_each_sample(geometry, [&](const Index3& at) {
                const bool in =
                    (at.array() >= box.low.array()).all() && (at.array() <= box.high.array()).all();
                ASSERT_TRUE(in || before.sample(at) == copies[now].sample(at));
            });
        }
        EXPECT_GT(undone, 0);
        EXPECT_GT(redone, 0);
    }
}

TEST(Editor, a_stroke_whose_first_edit_fails_is_a_step_of_its_own) {
    Editor editor(samples_of(noise_of(SampleType::uint8, grid(cube(8)), 1)));
    editor.apply(fill(3, 1));
    EXPECT_THROW(editor.apply(fill(4, std::nan(""))), std::invalid_argument);
    editor.apply(fill(5, 2), EditStep::same);
    editor.apply(fill(6, 3), EditStep::same);
    EXPECT_EQ(editor.undo_steps(), 2U);
    EXPECT_EQ(editor.undo(), (SampleBox{Index3::Constant(5), Index3::Constant(6)}));
}

TEST(Editor, an_edit_tells_its_progress_and_can_be_stopped_by_it) {
    Editor editor(samples_of(noise_of(SampleType::uint8, grid(cube(100)), 1)));
    const auto before = editor.samples();
    const edit::Fill all{whole_box(before->geometry()), 3};
    std::vector<double> told;
    const auto tell = [&](double fraction) { told.push_back(fraction); };
    const auto stop_in_the_middle = [](double fraction) {
        if (fraction > 0.5) throw std::runtime_error("stopped");
    };
    EXPECT_THROW(editor.apply(all, EditStep::own, stop_in_the_middle), std::runtime_error);
    EXPECT_EQ(editor.samples(), before);
    EXPECT_EQ(editor.undo_steps(), 0U);
    EXPECT_EQ(editor.apply(all, EditStep::own, tell), all.box);
    EXPECT_GT(told.size(), 10U);
    EXPECT_TRUE(std::ranges::is_sorted(told));
    EXPECT_LE(told.back(), 1);
}

TEST(Editor, a_stroke_of_many_edits_is_one_step) {
    Editor editor(samples_of(noise_of(SampleType::uint8, grid(cube(40)), 1)));
    const Volume before = flattened(*editor.samples());
    editor.apply(fill(3, 1));
    const Volume between = flattened(*editor.samples());
    editor.apply(fill(5, 2), EditStep::own);
    for (int i = 6; i < 38; ++i) editor.apply(fill(i, 3), EditStep::same);
    const Volume after = flattened(*editor.samples());
    EXPECT_EQ(editor.undo_steps(), 2U);
    EXPECT_EQ(editor.undo(), (SampleBox{Index3::Constant(5), Index3::Constant(37)}));
    EXPECT_TRUE(same_bits(flattened(*editor.samples()), between));
    EXPECT_EQ(editor.redo(), (SampleBox{Index3::Constant(5), Index3::Constant(37)}));
    EXPECT_TRUE(same_bits(flattened(*editor.samples()), after));
    editor.undo();
    editor.undo();
    EXPECT_TRUE(same_bits(flattened(*editor.samples()), before));
    // After an undo there is no step to go on with.
    editor.apply(fill(9, 9), EditStep::same);
    EXPECT_EQ(editor.undo_steps(), 1U);
    EXPECT_EQ(editor.redo_steps(), 0U);
}

TEST(Editor, a_stroke_that_begins_in_the_air_is_a_step_of_its_own) {
    Editor editor(
        samples_of(volume_of<std::uint8_t>(grid(cube(20)), [](const Index3& i) { return i[2]; })));
    editor.apply(fill(3, 100));
    editor.apply(fill(5, 5), EditStep::own);  // is 5 already
    editor.apply(fill(6, 200), EditStep::same);
    editor.apply(fill(7, 200), EditStep::same);
    EXPECT_EQ(editor.undo_steps(), 2U);
    editor.undo();
    EXPECT_EQ(editor.samples()->sample({6, 6, 6}), 6);
    EXPECT_EQ(editor.samples()->sample({3, 3, 3}), 100);
}

TEST(Editor, what_changes_nothing_is_no_step_and_leaves_what_can_be_redone) {
    Editor editor(samples_of(noise_of(SampleType::uint8, grid(cube(20)), 1)));
    editor.apply(fill(3, 255));
    editor.apply(fill(3, 1));
    editor.undo();
    EXPECT_TRUE(editor.apply(fill(3, 255)).empty());
    EXPECT_EQ(editor.redo_steps(), 1U);
    EXPECT_EQ(editor.undo_steps(), 1U);
}

TEST(Editor, the_history_stays_within_its_bound_and_loses_the_oldest_steps) {
    constexpr std::size_t brick = Bricks::per_brick * 2;
    Editor editor(samples_of(noise_of(SampleType::int16, grid(cube(64)), 1)), 30 * brick);
    Random random(3);
    std::vector<Volume> copies{flattened(*editor.samples())};
    for (int i = 0; i < 60; ++i) {
        editor.apply(fill(random.below(64), 1 + i));
        copies.push_back(flattened(*editor.samples()));
        ASSERT_LE(editor.history_bytes(), 30 * brick);
    }
    const std::size_t steps = editor.undo_steps();
    EXPECT_GT(steps, 1U);
    EXPECT_LT(steps, 30U);
    for (std::size_t i = 0; i < steps; ++i) {
        editor.undo();
        ASSERT_TRUE(same_bits(flattened(*editor.samples()), copies[copies.size() - 2 - i]));
    }
    EXPECT_TRUE(editor.undo().empty());
}

TEST(Editor, an_edit_larger_than_the_bound_can_be_undone_still) {
    const auto begin = samples_of(noise_of(SampleType::int16, grid(cube(64)), 1));
    Editor editor(begin, 1000);
    editor.apply(edit::Fill{whole_box(begin->geometry()), 3});
    EXPECT_EQ(editor.undo_steps(), 1U);
    editor.undo();
    EXPECT_EQ(editor.samples(), begin);
}

TEST(Editor, versions_that_can_no_longer_be_reached_are_freed) {
    Editor editor(samples_of(noise_of(SampleType::uint8, grid(cube(20)), 1)));
    editor.apply(fill(3, 1));
    editor.apply(fill(4, 2));
    const std::weak_ptr<const Samples> undone = editor.samples();
    editor.undo();
    EXPECT_FALSE(undone.expired());
    editor.apply(fill(5, 3));
    EXPECT_TRUE(undone.expired());
    const std::weak_ptr<const Samples> inside_stroke = editor.samples();
    editor.apply(fill(6, 3), EditStep::same);
    EXPECT_TRUE(inside_stroke.expired());
}

TEST(Editor, versions_that_it_drops_can_be_freed_later) {
    Editor editor(samples_of(noise_of(SampleType::uint8, grid(cube(20)), 1)), 1);
    std::vector<std::weak_ptr<const Samples>> known = {editor.samples()};
    Editor::Versions dropped;
    const auto take = [&](const Edit& edit, EditStep step = EditStep::own) {
        (void)editor.take(edited(editor.samples(), edit), step, &dropped);
        known.push_back(editor.samples());
    };
    take(fill(3, 1));
    editor.undo();
    take(fill(4, 2));
    take(fill(5, 2), EditStep::same);
    take(fill(6, 3));
    (void)editor.set_saved();
    const auto alive = [&] {
        return std::ranges::count_if(known, [](const auto& one) { return !one.expired(); });
    };
    EXPECT_EQ(alive(), 5) << "some versions were freed at once";
    dropped.clear();
    EXPECT_EQ(alive(), 2) << "the last step has two";
}

TEST(Editor, knows_whether_its_samples_are_saved) {
    Editor editor(samples_of(noise_of(SampleType::uint8, grid(cube(20)), 1)));
    EXPECT_FALSE(editor.changed());
    editor.apply(fill(3, 1));
    EXPECT_TRUE(editor.changed());
    editor.set_saved();
    EXPECT_FALSE(editor.changed());
    editor.undo();
    EXPECT_TRUE(editor.changed());
    editor.redo();
    EXPECT_FALSE(editor.changed());
}

TEST(Editor, needs_samples) {
    EXPECT_THROW(Editor(nullptr), std::invalid_argument);
}

}  // namespace
