// Levels are read from text as people write them, and text without a number is refused.
#include "palpate/io/level.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "support/fields.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::io {
namespace {

using support::grid;
using support::message_of;

TEST(Level, is_read_as_people_write_it) {
    const Volume volume(grid({2, 1, 1}), std::vector<std::int16_t>{-1000, 3000});
    EXPECT_EQ(level_from_text("300", volume), 300);
    EXPECT_EQ(level_from_text("-12.5", volume), -12.5);
    EXPECT_EQ(level_from_text("-1e3", volume), -1000);
    EXPECT_EQ(level_from_text("1E+2", volume), 100);
    EXPECT_EQ(level_from_text("50%", volume), 1000);
    EXPECT_DOUBLE_EQ(level_from_text("53%", volume), 1120);
    EXPECT_EQ(level_from_text("0%", volume), -1000);
    EXPECT_EQ(level_from_text("100%", volume), 3000);
    EXPECT_EQ(level_from_text("+0.5", volume), 0.5);
    EXPECT_EQ(level_from_text("+.5", volume), 0.5);
    EXPECT_EQ(level_from_text("+50%", volume), 1000);
    // Out of the range is a level too: there is just nothing to feel at it.
    EXPECT_EQ(level_from_text("1e6", volume), 1e6);
}

TEST(Level, that_is_not_a_number_is_refused_with_the_text_in_the_message) {
    const Volume volume(grid({2, 1, 1}), std::vector<std::int16_t>{-1000, 3000});
    for (const char* bad :
         {"",      "%",      "abc",  "nan",  "NaN",  "inf",  "-inf", "infinity", "5%%", "%5",
          "1e999", "1e999%", "3 00", " 300", "300 ", "0x10", "1,5",  "--3",      "3e",  "300HU",
          "5 %",   "nan%",   "+",    "++1",  "+-1",  "-+1",  "+%",   "+ 1"}) {
        std::string quoted(1, '\'');
        quoted.append(bad).push_back('\'');
        const std::string what =
            message_of<std::invalid_argument>([&] { (void)level_from_text(bad, volume); });
        EXPECT_NE(what.find(quoted), std::string::npos) << bad;
    }
}

}  // namespace
}  // namespace palpate::io
