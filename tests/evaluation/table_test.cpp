// Tables as CSV.
#include "evaluation/table.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace palpate::evaluation {
namespace {

TEST(Table, csv_has_a_header_and_numbers_that_read_back_as_the_same) {
    Table table;
    table.add({{"name", "third"}, {"value_mm", 1.0 / 3}});
    EXPECT_EQ(csv_from(table), "name,value_mm\nthird,0.3333333333333333\n");
}

TEST(Table, csv_quotes_what_would_be_taken_apart_and_leaves_out_what_was_not_measured) {
    Table table;
    table.add({{"name", "a, \"b\""}, {"value", std::nan("")}});
    EXPECT_EQ(csv_from(table), "name,value\n\"a, \"\"b\"\"\",\n");
}

TEST(Table, a_cell_that_a_row_does_not_name_is_empty) {
    Table table;
    table.add({{"name", "a"}, {"value", 1.0}});
    table.add({{"name", "b"}, {"other", "x"}});
    EXPECT_EQ(csv_from(table), "name,value,other\na,1,\nb,,x\n");
    EXPECT_EQ(table.number(0, "value"), 1);
    EXPECT_TRUE(std::isnan(table.number(1, "value")));
    EXPECT_EQ(table.text(0, "other"), "");
    EXPECT_THROW((void)table.number(0, "none"), std::out_of_range);
}

TEST(Table, rows_and_columns_are_selected_by_name) {
    Table table;
    table.add({{"method", "exact"}, {"x", 1.0}, {"y", 2.0}});
    table.add({{"method", "paper"}, {"x", 1.0}, {"y", 3.0}});
    table.add({{"method", "exact"}, {"x", 4.0}, {"y", std::nan("")}});
    const Table exact = table.where("method", "exact");
    EXPECT_EQ(exact.rows().size(), 2U);
    EXPECT_EQ(exact.where("x", 1.0).rows_of({"y", "x"}),
              (std::vector<std::vector<double>>{{2, 1}}));
    EXPECT_EQ(table.distinct("method"), (std::vector<std::string>{"exact", "paper"}));
    EXPECT_EQ(largest(table.numbers("y")), 3);  // NaN is passed over
    EXPECT_EQ(smallest(table.numbers("y"), 9), 2);
}

TEST(Table, a_quantile_is_the_smallest_number_that_is_at_least_as_large_as_its_share_of_all) {
    const std::vector<double> numbers{4, 1, 3, 2};
    EXPECT_EQ(quantile(numbers, 0.5), 2);
    EXPECT_EQ(quantile(numbers, 0.51), 3);
    EXPECT_EQ(quantile(numbers, 1), 4);
    EXPECT_EQ(quantile(numbers, 0), 1);
    EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

}  // namespace
}  // namespace palpate::evaluation
