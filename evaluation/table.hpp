// A table with named columns: the numbers of an experiment, written as its CSV. A column's name
// carries its unit.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace palpate::evaluation {

using Cell = std::variant<double, std::string>;

/// A cell with the name of its column.
using NamedCell = std::pair<std::string, Cell>;

class Table {
  public:
    /// Columns stand in the order in which rows first name them. A cell that a row does not name is
    /// empty: NaN, or no text.
    void add(const std::vector<NamedCell>& row);

    const std::vector<std::string>& columns() const { return columns_; }
    const std::vector<std::vector<Cell>>& rows() const { return rows_; }
    /// Throws std::out_of_range for a column that there is not.
    double number(std::size_t row, const std::string& column) const;
    const std::string& text(std::size_t row, const std::string& column) const;

    /// The rows that hold `value` in `column`, as a table with the same columns.
    Table where(const std::string& column, const Cell& value) const;
    std::vector<double> numbers(const std::string& column) const;
    /// What a column holds, each once, in the order of the rows.
    std::vector<std::string> distinct(const std::string& column) const;
    /// Rows of several columns, as a figure's series has them.
    std::vector<std::vector<double>> rows_of(const std::vector<std::string>& columns) const;

  private:
    std::size_t index_of(const std::string& column) const;
    const Cell& cell(std::size_t row, const std::string& column) const;

    std::vector<std::string> columns_;
    std::vector<std::vector<Cell>> rows_;
};

/// Of the numbers that are not NaN; `least` (`largest`) without one.
double largest(const std::vector<double>& numbers, double least = 0);
double smallest(const std::vector<double>& numbers, double largest);
/// The smallest number that is at least as large as a share of all, 0 to 1. NaN without numbers.
double quantile(std::vector<double> numbers, double share);

/// RFC 4180 with line feeds; numbers with the digits that read back as the same double, and an
/// empty cell for NaN (not measured).
std::string csv_from(const Table& table);

}  // namespace palpate::evaluation
