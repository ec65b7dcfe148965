// Tables as CSV and HTML.
#include "evaluation/table.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "evaluation/html.hpp"

namespace palpate::evaluation {
namespace {

TEST(Table, csv_has_a_header_and_numbers_that_read_back_as_the_same) {
    Table table({"name", "value_mm"});
    table.add({"third", 1.0 / 3});
    EXPECT_EQ(csv_from(table), "name,value_mm\nthird,0.3333333333333333\n");
}

TEST(Table, csv_quotes_what_would_be_taken_apart_and_leaves_out_what_was_not_measured) {
    Table table({"name", "value"});
    table.add({"a, \"b\"", std::numeric_limits<double>::quiet_NaN()});
    EXPECT_EQ(csv_from(table), "name,value\n\"a, \"\"b\"\"\",\n");
}

TEST(Table, html_has_no_markup_of_somebody_else) {
    Table table({"<script>"});
    table.add({"a & b"});
    const std::string html = html_from(table);
    EXPECT_EQ(html.find("<script>"), std::string::npos);
    EXPECT_NE(html.find("&lt;script&gt;"), std::string::npos);
    EXPECT_NE(html.find("a &amp; b"), std::string::npos);
}

TEST(Table, a_row_that_does_not_fit_and_a_column_that_is_not_there_are_refused) {
    Table table({"a", "b"});
    EXPECT_THROW(table.add({1.0}), std::logic_error);
    table.add({1.0, "x"});
    EXPECT_EQ(table.number(0, "a"), 1);
    EXPECT_EQ(table.text(0, "b"), "x");
    EXPECT_THROW((void)table.number(0, "c"), std::out_of_range);
}

}  // namespace
}  // namespace palpate::evaluation
