// Reads tables of numbers: a header that names the columns, `#` comments, any line ends. Columns
// are found by name. Trajectories and traces are read with it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/io/error.hpp"
#include "palpate/progress.hpp"

namespace palpate::io {

/// The whole text of a file, a pipe or a device, without a byte order mark. Throws InputError, also
/// for a zero byte, a line of more than 16 MiB, a file of more than 4 GiB or a stream of more than
/// 256 MiB.
/// `progress` is called while a pipe or a device is waited for. Without it, that wait ends with an
/// InputError at a signal that the program handles, or when nothing was received for 10 s.
std::string read_text(const std::filesystem::path& path, const OnProgress& progress = {});

/// The text without an incomplete last line (of a file that was cut off while it was written).
std::string_view whole_lines(std::string_view text);

/// Reads the rows of a CSV text. Blank lines and lines that start with # are skipped,
/// spaces around cells and a byte order mark too. Quotes have no meaning. Errors are InputErrors
/// that name the file and the line.
class CsvReader {
  public:
    /// Called with each comment, without its #.
    using CommentSink = std::function<void(std::string_view)>;
    /// Reads the header. `text` must outlive the reader; errors call it `name`.
    CsvReader(std::string_view text, std::string name, CommentSink comments = {});

    bool has_column(std::string_view column) const;
    /// The number of the column. A column that is missing or given twice is an error.
    std::size_t column(std::string_view column) const;

    /// Goes to the next row; false at the end. A row must have as many cells as the header.
    bool next();
    std::size_t line() const { return line_; }
    std::size_t bytes_left() const { return rest_.size(); }
    std::string_view cell(std::size_t column) const { return cells_[column]; }
    /// The text of the row, without blanks at its ends.
    std::string_view row() const { return row_; }
    /// The cell as a number, NaN and infinity included.
    double number(std::size_t column) const;
    /// The cell as a number that is finite.
    double finite_number(std::size_t column) const;
    std::int64_t integer(std::size_t column) const;

    /// Throws "NAME, line N: PROBLEM".
    [[noreturn]] void fail(const std::string& problem) const;

  private:
    bool next_line();

    CommentSink comments_;
    std::string_view rest_;
    std::string name_;
    std::size_t line_ = 0;
    std::string_view row_;
    std::vector<std::string_view> header_;
    std::vector<std::string_view> cells_;
};

/// Text from a file for use in a one-line message: shortened, in quotes, printable.
std::string quoted(std::string_view text);

}  // namespace palpate::io
