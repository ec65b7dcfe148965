// Reads CSV tables of numbers and bare words. A cell may be in quotes.
#include "palpate/io/csv.hpp"

#include <algorithm>
#include <cmath>

#include "io/system/number.hpp"

namespace palpate::io {
namespace {

std::string_view without_blanks(std::string_view text) {
    constexpr std::string_view blank = " \t\r";
    const auto first = text.find_first_not_of(blank);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(blank) - first + 1);
}

void split(std::string_view line, std::vector<std::string_view>& cells) {
    cells.clear();
    for (;;) {
        auto comma = line.find(',');
        if (without_blanks(line).starts_with('"')) {
            comma = line.find(',', line.find('"', line.find('"') + 1));
        }
        std::string_view cell = without_blanks(line.substr(0, comma));
        if (cell.size() > 1 && cell.front() == '"' && cell.back() == '"') {
            cell = cell.substr(1, cell.size() - 2);
        }
        cells.push_back(cell);
        if (comma == std::string_view::npos) return;
        line.remove_prefix(comma + 1);
    }
}

}  // namespace

std::string quoted(std::string_view text) {
    constexpr std::size_t longest = 40;
    std::string shown = "'";
    for (const char c : text.substr(0, longest)) shown += c >= ' ' && c <= '~' ? c : '?';
    return shown + (text.size() > longest ? "...'" : "'");
}

std::string_view whole_lines(std::string_view text) {
    return text.substr(0, text.rfind('\n') + 1);  // npos + 1 is 0
}

CsvReader::CsvReader(std::string_view text, std::string name, CommentSink comments)
    : comments_(std::move(comments)), rest_(text), name_(std::move(name)) {
    if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);
    if (text.find('\0') != std::string_view::npos) {
        throw InputError(name_ + ": is not a text file: give a CSV file with a header line");
    }
    if (!next_line()) throw InputError(name_ + ": is empty: give a CSV file with a header line");
    header_ = cells_;
}

bool CsvReader::next_line() {
    while (!rest_.empty()) {
        const auto end = std::min(rest_.find_first_of("\r\n"), rest_.size());
        const auto text = without_blanks(rest_.substr(0, end));
        rest_.remove_prefix(end);
        rest_.remove_prefix(rest_.starts_with("\r\n") ? 2 : std::min<std::size_t>(1, rest_.size()));
        ++line_;
        if (text.empty()) continue;
        if (text[0] == '#') {
            if (comments_) comments_(text.substr(1));
            continue;
        }
        row_ = text;
        split(text, cells_);
        return true;
    }
    return false;
}

bool CsvReader::has_column(std::string_view column) const {
    return std::find(header_.begin(), header_.end(), column) != header_.end();
}

std::size_t CsvReader::column(std::string_view column) const {
    const auto found = std::find(header_.begin(), header_.end(), column);
    if (found == header_.end()) {
        std::string names;
        for (std::size_t i = 0; i < header_.size() && i < 8; ++i) {
            names += (i == 0 ? "" : ", ") + quoted(header_[i]);
        }
        fail("there is no column " + quoted(column) + ": the header, " + names +
             (header_.size() > 8 ? ", ..." : "") + ", must name it, with commas in between");
    }
    if (std::find(found + 1, header_.end(), column) != header_.end()) {
        fail("two columns are named " + quoted(column) + ": rename one");
    }
    return static_cast<std::size_t>(found - header_.begin());
}

bool CsvReader::next() {
    if (!next_line()) return false;
    if (cells_.size() != header_.size()) {
        fail("there are " + std::to_string(cells_.size()) + " cells where the header has " +
             std::to_string(header_.size()) +
             ": complete the row, and write decimals with a point");
    }
    return true;
}

double CsvReader::number(std::size_t column) const {
    if (const auto value = number_from<double>(cells_[column])) return *value;
    fail(quoted(cells_[column]) + " in column " + quoted(header_[column]) +
         " is not a number: write one like -1.25 or 3e-4");
}

double CsvReader::finite_number(std::size_t column) const {
    const double value = number(column);
    if (std::isfinite(value)) return value;
    fail(quoted(cells_[column]) + " in column " + quoted(header_[column]) +
         " is not finite: remove the row or give a number");
}

std::int64_t CsvReader::integer(std::size_t column) const {
    if (const auto value = number_from<std::int64_t>(cells_[column])) return *value;
    fail(quoted(cells_[column]) + " in column " + quoted(header_[column]) +
         " is not a whole number: write one like 12");
}

void CsvReader::fail(const std::string& problem) const {
    throw InputError(name_ + ", line " + std::to_string(line_) + ": " + problem);
}

}  // namespace palpate::io
