// Reads trajectories: rows of a CSV table whose times must increase.
#include "palpate/io/trajectory.hpp"

#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "io/recording/trace_columns.hpp"
#include "io/system/number.hpp"
#include "palpate/io/csv.hpp"

namespace palpate::io {
namespace {

constexpr const char* no_orientation =
    "qw, qx, qy, qz are no orientation: a quaternion of length 1 is needed";

/// Unit to all digits; what is so already stays, to the bit. Nothing if it is not nearly unit.
std::optional<Quaternion> unit(Quaternion q) {
    const double squared = q.squaredNorm();
    if (!(std::abs(squared - 1) <= 2e-3)) return std::nullopt;
    if (std::abs(squared - 1) > 1e-14) q.normalize();
    return q;
}

Quaternion orientation_from(const CsvReader& rows, const QuaternionColumns& columns) {
    const auto q = unit(columns.read(rows));
    if (!q) rows.fail(no_orientation);
    return *q;
}

/// The problem with a row. Empty if there is none.
std::string problem_of(const Trajectory& t, std::size_t row) {
    if (!std::isfinite(t.time[row])) return "the time is not finite";
    if (row > 0 && !(t.time[row] > t.time[row - 1])) {
        return "the time does not come after that of the row before";
    }
    return t.position[row].allFinite() ? "" : "the position is not finite";
}

}  // namespace

Trajectory parse_trajectory(std::string_view text, const std::string& name) {
    CsvReader rows(text, name);
    const std::size_t time = rows.column("t");
    const bool plain = rows.has_column("x") || !rows.has_column("hip_x");
    const std::string prefix = plain ? "" : "hip_";
    const std::size_t x = rows.column(prefix + "x");
    const std::size_t y = rows.column(prefix + "y");
    const std::size_t z = rows.column(prefix + "z");
    // If only some of these columns exist, column() reports it.
    std::optional<QuaternionColumns> turn;
    for (const char* part : {"qw", "qx", "qy", "qz"}) {
        if (!turn && rows.has_column(part)) turn.emplace(rows, "");
    }

    Trajectory trajectory;
    while (rows.next()) {
        const double t = rows.finite_number(time);
        if (!trajectory.time.empty() && !(t > trajectory.time.back())) {
            std::string before;
            append_number(before, trajectory.time.back());
            rows.fail("the time " + quoted(rows.cell(time)) + " does not come after " + before +
                      ", that of the row before: " +
                      (rows.has_column("hand") ? "keep the rows of one hand"
                                               : "sort the rows and remove doubles"));
        }
        trajectory.time.push_back(t);
        trajectory.position.emplace_back(rows.finite_number(x), rows.finite_number(y),
                                         rows.finite_number(z));
        if (turn) trajectory.orientation.push_back(orientation_from(rows, *turn));
    }
    if (trajectory.time.empty()) {
        throw InputError(name + ": has a header and no rows: add at least one position");
    }
    return trajectory;
}

Trajectory checked_trajectory(std::vector<double> time, std::vector<Vec3> position,
                              std::vector<Quaternion> orientation) {
    Trajectory t{std::move(time), std::move(position), std::move(orientation)};
    const std::size_t rows = t.time.size();
    if (rows == 0) throw std::invalid_argument("a trajectory needs at least one position");
    if (t.position.size() != rows || (!t.orientation.empty() && t.orientation.size() != rows)) {
        throw std::invalid_argument(
            "a trajectory needs as many positions (and orientations) as times");
    }
    for (std::size_t row = 0; row < rows; ++row) {
        std::string problem = problem_of(t, row);
        if (problem.empty() && !t.orientation.empty()) {
            const auto q = unit(t.orientation[row]);
            if (q)
                t.orientation[row] = *q;
            else
                problem = no_orientation;
        }
        if (!problem.empty()) {
            throw std::invalid_argument("row " + std::to_string(row) + ": " + problem);
        }
    }
    return t;
}

Trajectory read_trajectory(const std::filesystem::path& path) {
    return parse_trajectory(read_text(path), path.string());
}

}  // namespace palpate::io
