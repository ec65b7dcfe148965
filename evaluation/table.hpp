// A table with named columns: what becomes an experiment's CSV. A column's name carries its unit.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <string>
#include <variant>
#include <vector>

namespace palpate::evaluation {

using Cell = std::variant<double, std::string>;

class Table {
  public:
    Table() = default;
    explicit Table(std::vector<std::string> columns) : columns_(std::move(columns)) {}

    /// Throws std::logic_error unless there is a cell for every column.
    void add(std::vector<Cell> row);

    const std::vector<std::string>& columns() const { return columns_; }
    const std::vector<std::vector<Cell>>& rows() const { return rows_; }
    /// Throws std::out_of_range for a column that there is not.
    double number(std::size_t row, const std::string& column) const;
    const std::string& text(std::size_t row, const std::string& column) const;

  private:
    const Cell& cell(std::size_t row, const std::string& column) const;

    std::vector<std::string> columns_;
    std::vector<std::vector<Cell>> rows_;
};

/// RFC 4180 with line feeds; numbers with the digits that read back as the same double, and an
/// empty cell for NaN (not measured).
std::string csv_from(const Table& table);
/// A table of HTML, numbers to four digits.
std::string html_from(const Table& table);

}  // namespace palpate::evaluation
