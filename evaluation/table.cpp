// Rows, and the two ways they are written.
#include "evaluation/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "evaluation/html.hpp"
#include "io/number.hpp"

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

std::string html_cell(const Cell& cell) {
    if (const double* number = std::get_if<double>(&cell)) {
        return std::isnan(*number) ? "<td></td>" : fmt::format("<td class=n>{:.4g}</td>", *number);
    }
    return "<td>" + html_text(std::get<std::string>(cell)) + "</td>";
}

}  // namespace

void Table::add(std::vector<Cell> row) {
    if (row.size() != columns_.size()) {
        throw std::logic_error(
            fmt::format("a row of {} cells in a table of {} columns", row.size(), columns_.size()));
    }
    rows_.push_back(std::move(row));
}

const Cell& Table::cell(std::size_t row, const std::string& column) const {
    const auto at = std::find(columns_.begin(), columns_.end(), column);
    if (at == columns_.end()) throw std::out_of_range("no column " + column);
    return rows_.at(row)[static_cast<std::size_t>(at - columns_.begin())];
}

double Table::number(std::size_t row, const std::string& column) const {
    return std::get<double>(cell(row, column));
}

const std::string& Table::text(std::size_t row, const std::string& column) const {
    return std::get<std::string>(cell(row, column));
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

std::string html_from(const Table& table) {
    std::string html = "<table>\n<tr>";
    for (const std::string& name : table.columns()) html += "<th>" + html_text(name) + "</th>";
    html += "</tr>\n";
    for (const auto& row : table.rows()) {
        html += "<tr>";
        for (const Cell& cell : row) html += html_cell(cell);
        html += "</tr>\n";
    }
    return html + "</table>\n";
}

}  // namespace palpate::evaluation
