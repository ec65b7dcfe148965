// Names that are suggested for one that is unknown.
#include "palpate/names.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace palpate {
namespace {

const std::vector<std::string> names{"cubic", "linear", "gradient", "gradient-improved",
                                     "--isovalue"};

TEST(Names, a_letter_missing_added_wrong_or_swapped_still_finds_the_name) {
    for (const char* word : {"linar", "lineear", "lineax", "linaer", "LINEAR"}) {
        EXPECT_EQ(nearest_name(word, names), "linear") << word;
    }
}

TEST(Names, the_beginning_of_a_name_finds_it) {
    EXPECT_EQ(nearest_name("--iso", names), "--isovalue");
    EXPECT_EQ(nearest_name("gradient-i", names), "gradient-improved");
    EXPECT_EQ(nearest_name("gradient", names), "gradient");
}

TEST(Names, the_part_behind_the_last_dot_finds_a_name) {
    const std::vector<std::string> dotted{"force.limit", "force.rate_limit", "friction.static"};
    EXPECT_EQ(nearest_name("limit", dotted), "force.limit");
    EXPECT_EQ(nearest_name("rate_limt", dotted), "force.rate_limit");
    EXPECT_EQ(nearest_name("force.limt", dotted), "force.limit");
}

TEST(Names, a_word_that_is_like_none_finds_none) {
    for (const std::string& word :
         {std::string("quartz"), std::string("x"), std::string(), std::string(100'000, 'c')}) {
        EXPECT_EQ(nearest_name(word, names), "") << word.substr(0, 9);
    }
    EXPECT_EQ(nearest_name("cubic", {}), "");
}

TEST(Names, messages_list_all_names_and_the_nearest) {
    const std::vector<std::string> two{"above", "below"};
    EXPECT_EQ(use_one_of(two, "abve"), "use one of above, below (did you mean above?)");
    EXPECT_EQ(use_one_of(two, "left"), "use one of above, below");
}

}  // namespace
}  // namespace palpate
