// Texts of numbers in the panel and the status line.
#include "apps/viewer/panel/inputs.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <utility>

namespace palpate::viewer {
namespace {

TEST(NumberText, has_no_exponent_where_people_do_not_expect_one) {
    const std::pair<double, const char*> fourth[]{{35030.4, "35030"},
                                                  {1252.25, "1252"},
                                                  {123456789, "123456789"},
                                                  {40.25, "40.25"},
                                                  {-1024, "-1024"},
                                                  {0.00125, "0.00125"},
                                                  {0, "0"},
                                                  {-0.0, "0"},
                                                  {9999.96, "10000"},
                                                  {2.5e-7, "2.5e-07"},
                                                  {3e12, "3e+12"}};
    for (const auto& [value, text] : fourth) EXPECT_EQ(number_text(value, 4), text) << value;
    EXPECT_EQ(number_text(std::numeric_limits<double>::infinity()), "inf");
}

TEST(NumberText, with_a_comma_is_a_number_unless_it_may_be_thousands) {
    for (const auto& [text, value] :
         {std::pair("4,5", 4.5), {"0,125", 0.125}, {"1,0000", 1}, {"1234,567", 1234.567}}) {
        EXPECT_EQ(number_from(text), value) << text;
    }
    for (const char* text : {"1,000", "-12,500", "999,999", "1,000,000", "1,000.5"}) {
        EXPECT_FALSE(number_from(text)) << text;
    }
}

}  // namespace
}  // namespace palpate::viewer
