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

}  // namespace
}  // namespace palpate::evaluation
