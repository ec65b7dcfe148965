// The volumes of experiments: scenes, files, and the user's own.
#include "evaluation/subject.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "palpate/io/error.hpp"

namespace palpate::evaluation {
namespace {

TEST(Subject, a_scene_has_its_own_level_and_takes_another) {
    EXPECT_EQ(subject_from("synthetic:cylinder@0.53").isovalue, 0.53);
    EXPECT_GT(subject_from("synthetic:sphere:20x20x20").isovalue, 0);
    EXPECT_EQ(subject_from("synthetic:sphere:20x20x20@17").isovalue, 17);
}

TEST(Subject, a_file_needs_a_level_and_has_to_be_there) {
    EXPECT_THROW(subject_from("head.nrrd"), std::invalid_argument);
    EXPECT_THROW(subject_from("nowhere/head.nrrd@300"), io::InputError);
    EXPECT_THROW(subject_from("synthetic:sphere@much"), std::invalid_argument);
    EXPECT_THROW(subject_from("synthetic:nothing"), std::invalid_argument);
}

TEST(Subject, real_volumes_are_left_out_where_there_are_none) {
    EXPECT_FALSE(real("", "lobster"));
    EXPECT_FALSE(real("/nowhere", "lobster"));
    EXPECT_THROW(real("", "dragon"), std::logic_error);
}

TEST(Subject, the_lobster_is_felt_at_its_shell) {
    const auto lobster = real(PALPATE_DATA_FOLDER, "lobster");
    if (!lobster) GTEST_SKIP() << "the real volumes are not there";
    EXPECT_EQ(lobster->isovalue, 35);
    EXPECT_EQ(lobster->field.geometry().size, Index3(301, 324, 56));
}

}  // namespace
}  // namespace palpate::evaluation
