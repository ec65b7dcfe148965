// Selecting from tables, and writing them as CSV.
#include "evaluation/table.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <stdexcept>

#include "io/system/number.hpp"

namespace palpate::evaluation {
namespace {

std::string csv_cell(const Cell& cell) {
    std::string out;
    if (const double* number = std::get_if<double>(&cell)) {
        if (!std::isnan(*number)) io::append_number(out, *number);
        return out;
    }
    const std::string& text = std::get<std::string>(cell);
    if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
    for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
    return '"' + out + '"';
}

}  // namespace

void Table::add(const std::vector<NamedCell>& row) {
    const auto empty = [](const Cell& like) {
        return std::holds_alternative<double>(like) ? Cell(std::nan("")) : Cell(std::string());
    };
    std::vector<Cell> cells;
    if (!rows_.empty()) std::ranges::transform(rows_.front(), std::back_inserter(cells), empty);
    for (const auto& [column, cell] : row) {
        const auto at = std::find(columns_.begin(), columns_.end(), column);
        if (at == columns_.end()) {
            columns_.push_back(column);
            cells.push_back(cell);
            for (auto& other : rows_) other.push_back(empty(cell));
        } else {
            cells[static_cast<std::size_t>(at - columns_.begin())] = cell;
        }
    }
    rows_.push_back(std::move(cells));
}

std::size_t Table::index_of(const std::string& column) const {
    const auto at = std::find(columns_.begin(), columns_.end(), column);
    if (at == columns_.end()) throw std::out_of_range("no column " + column);
    return static_cast<std::size_t>(at - columns_.begin());
}

const Cell& Table::cell(std::size_t row, const std::string& column) const {
    return rows_.at(row)[index_of(column)];
}

double Table::number(std::size_t row, const std::string& column) const {
    return std::get<double>(cell(row, column));
}

const std::string& Table::text(std::size_t row, const std::string& column) const {
    return std::get<std::string>(cell(row, column));
}

Table Table::where(const std::string& column, const Cell& value) const {
    const std::size_t at = index_of(column);
    Table found;
    found.columns_ = columns_;
    std::copy_if(rows_.begin(), rows_.end(), std::back_inserter(found.rows_),
                 [&](const std::vector<Cell>& row) { return row[at] == value; });
    return found;
}

std::vector<double> Table::numbers(const std::string& column) const {
    std::vector<double> found;
    const std::size_t at = index_of(column);
    for (const auto& row : rows_) found.push_back(std::get<double>(row[at]));
    return found;
}

std::vector<std::string> Table::distinct(const std::string& column) const {
    std::vector<std::string> found;
    const std::size_t at = index_of(column);
    for (const auto& row : rows_) {
        const auto& text = std::get<std::string>(row[at]);
        if (std::find(found.begin(), found.end(), text) == found.end()) found.push_back(text);
    }
    return found;
}

std::vector<std::vector<double>> Table::rows_of(const std::vector<std::string>& columns) const {
    std::vector<std::vector<double>> found(rows_.size());
    for (const std::string& column : columns) {
        const std::vector<double> values = numbers(column);
        for (std::size_t i = 0; i < values.size(); ++i) found[i].push_back(values[i]);
    }
    return found;
}

double largest(const std::vector<double>& numbers, double least) {
    // A comparison with NaN is false, so NaN is passed over.
    return std::accumulate(numbers.begin(), numbers.end(), least,
                           [](double a, double b) { return b > a ? b : a; });
}

double smallest(const std::vector<double>& numbers, double largest) {
    return std::accumulate(numbers.begin(), numbers.end(), largest,
                           [](double a, double b) { return b < a ? b : a; });
}

double quantile(std::vector<double> numbers, double share) {
    if (numbers.empty()) return std::nan("");
    const auto rank = std::ceil(share * static_cast<double>(numbers.size()));
    const auto at = numbers.begin() + static_cast<std::ptrdiff_t>(std::max(1.0, rank)) - 1;
    std::nth_element(numbers.begin(), at, numbers.end());
    return *at;
}

std::string csv_from(const Table& table) {
    std::string csv;
    const auto line = [&](const auto& cells, auto text_of) {
        for (std::size_t i = 0; i < cells.size(); ++i) csv += (i ? "," : "") + text_of(cells[i]);
        csv += '\n';
    };
    line(table.columns(), [](const std::string& name) { return csv_cell(name); });
    for (const auto& row : table.rows()) line(row, csv_cell);
    return csv;
}

}  // namespace palpate::evaluation
