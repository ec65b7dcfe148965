// Claims and words of scaling, from its table.
#include "evaluation/scaling/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "palpate/proxy.hpp"

namespace palpate::evaluation {
namespace {

constexpr double granted = 1e-9;  // G2

/// Rows of a part, by number.
std::vector<std::size_t> rows_of(const Table& table, const std::string& part) {
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < table.rows().size(); ++i) {
        if (table.text(i, "part") == part) rows.push_back(i);
    }
    return rows;
}

/// Least and largest of what `value` gives for the rows; empty where it gives NaN only.
struct Extent {
    double least = std::numeric_limits<double>::infinity();
    double largest = -std::numeric_limits<double>::infinity();
};
template <class Value>
Extent extent_of(const std::vector<std::size_t>& rows, Value&& value) {
    Extent extent;
    for (const std::size_t row : rows) {
        const double v = value(row);
        if (std::isnan(v)) continue;
        extent.least = std::min(extent.least, v);
        extent.largest = std::max(extent.largest, v);
    }
    return extent;
}

/// Tetrahedra entered beyond the one that an update starts in, for each voxel of the hand's way.
Extent density_of_crossings(const Table& table) {
    return extent_of(rows_of(table, "speed"), [&](std::size_t row) {
        return (table.number(row, "tetrahedra") - table.number(row, "updates")) /
               table.number(row, "way_voxel");
    });
}

/// That what `value` gives for the rows lies within bounds; no claim where there is nothing.
template <class Value>
void claim(std::vector<Claim>& claims, const std::vector<std::size_t>& rows, const char* statement,
           const char* measured, double low, double high, Value&& value) {
    const Extent extent = extent_of(rows, value);
    if (extent.least > extent.largest) return;
    claims.push_back({statement, extent.least >= low && extent.largest <= high,
                      fmt::format(fmt::runtime(measured), extent.least, extent.largest)});
}

}  // namespace

std::vector<Claim> scaling_claims(const Table& table, bool own_volumes) {
    std::vector<Claim> claims;
    const auto number = [&](const char* column) {
        return [&table, column](std::size_t row) { return table.number(row, column); };
    };
    const auto explicit_rows = rows_of(table, "explicit");
    claim(claims, explicit_rows, "updates and changes of the level take no memory",
          "heap grew by {:g} to {:g} bytes", 0, 0, number("heap_growth_bytes"));
    if (!own_volumes) return claims;
    const auto sizes = rows_of(table, "size");
    const double first = table.number(sizes.front(), "tetrahedra");
    claim(claims, sizes, "the same motion enters the same tetrahedra in a volume of any size",
          "{:.0f} to {:.0f} tetrahedra", first, first, number("tetrahedra"));
    const Extent crossings = density_of_crossings(table);
    claims.push_back(
        {"tetrahedra entered grow in proportion to the hand's way, to 10 %",
         crossings.largest <= 1.1 * crossings.least,
         fmt::format("{:.3g} to {:.3g} a voxel of way", crossings.least, crossings.largest)});
    std::vector<std::size_t> balls;
    for (const std::size_t row : explicit_rows) {
        if (table.text(row, "volume") == "ball") balls.push_back(row);
    }
    claim(claims, balls, "on the ball one update after a change of the level is on the new surface",
          "{:g} to {:g} changes unfinished", 0, 0, number("unfinished_changes"));
    claim(claims, balls, "and is on it to 1e-9 of the range", "{:.2g} to {:.2g}", 0, granted,
          number("worst_deviation_of_range"));
    claim(claims, balls, "the whole mesh is the same ball: segments that meet one meet both",
          "share of others {:g} to {:g}", 0, 0, number("one_sided_hits_share"));
    claim(claims, balls, "and meet both in the same place to 0.1 voxel", "{:.2g} to {:.2g} voxel",
          0, 0.1, number("hit_difference_voxel"));
    return claims;
}

namespace {

std::string time_text(double seconds) {
    if (seconds < 1e-6) return fmt::format("{:.0f} ns", 1e9 * seconds);
    if (seconds < 1e-3) return fmt::format("{:.3g} µs", 1e6 * seconds);
    return seconds < 1 ? fmt::format("{:.3g} ms", 1e3 * seconds) : fmt::format("{:.3g} s", seconds);
}

std::string span_text(const Extent& ns) {
    const auto least = fmt::format("{:.0f}", ns.least), largest = fmt::format("{:.0f}", ns.largest);
    return (least == largest ? least : least + " to " + largest) + " ns";
}

std::string bytes_text(double bytes) {
    if (bytes < 1e4) return fmt::format("{:.0f} bytes", bytes);
    return bytes < 1e9 ? fmt::format("{:.1f} MB", 1e-6 * bytes)
                       : fmt::format("{:.2f} GB", 1e-9 * bytes);
}

/// What both ways take on the volumes of the last part; of the balls on the largest.
std::string explicit_text(const Table& table) {
    std::string text;
    const auto rows = rows_of(table, "explicit");
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const std::size_t row = rows[i];
        const bool is_last = i + 1 == rows.size() || table.text(rows[i + 1], "volume") != "ball";
        if (table.text(row, "volume") == "ball" && !is_last) continue;
        const double whole =
            table.number(row, "explicit_extraction_s") + table.number(row, "explicit_tree_s");
        text += fmt::format("{} {}: ", table.text(row, "volume"), table.text(row, "size"));
        if (!std::isnan(whole)) {
            text +=
                fmt::format("{:.0f} triangles, {} to extract and build, {} at the peak, {} kept; ",
                            table.number(row, "explicit_triangles"), time_text(whole),
                            bytes_text(table.number(row, "explicit_peak_bytes")),
                            bytes_text(table.number(row, "explicit_mesh_bytes") +
                                       table.number(row, "explicit_tree_bytes")));
        }
        text += fmt::format(
            "dynamically, the update after a change of the level takes {} (p99 {}, longest {}; "
            "{:g} "
            "of {:g} were not finished by one update). ",
            time_text(1e-9 * table.number(row, "change_p50_ns")),
            time_text(1e-9 * table.number(row, "change_p99_ns")),
            time_text(1e-9 * table.number(row, "change_max_ns")),
            table.number(row, "unfinished_changes"), table.number(row, "changes"));
    }
    return text;
}

/// What an explicit proxy pays in a tick once all is built.
std::string segment_text(const Table& table) {
    const auto rows = rows_of(table, "explicit");
    const auto extent = [&](const char* column) {
        return extent_of(rows, [&](std::size_t row) { return table.number(row, column); });
    };
    const Extent query = extent("explicit_segment_ns"), update = extent("mean_ns");
    std::string text = "Both ways need the samples in memory.";
    if (query.least > query.largest) return text;
    return text + fmt::format(
                      " Once the tree stands, an explicit proxy pays at least one segment "
                      "query a tick, {:.0f} to {:.0f} ns here, beside {:.0f} to {:.0f} ns "
                      "for a whole update of the dynamic one.",
                      query.least, query.largest, update.least, update.largest);
}

}  // namespace

std::string scaling_paragraph(const Table& table, bool own_volumes) {
    const auto mean = [&](const char* part) {
        return extent_of(rows_of(table, part),
                         [&](std::size_t row) { return table.number(row, "mean_ns"); });
    };
    const Extent speeds = mean("speed"), voxels = mean("voxels-per-mm");
    std::string text = fmt::format(
        "How the time of an update grows (exact, {:g} Hz, in contact {:g} mm of hand below the "
        "surface; otherwise {:g} mm/s and {:g} voxels a mm). With the hand's speed: mean {}. "
        "With the voxels per millimetre of hand: {}. ",
        usual.rate_hz, usual.depth_mm, usual.speed_mm_s, usual.voxels_per_mm, span_text(speeds),
        span_text(voxels));
    if (own_volumes) {
        const Extent sizes = mean("size"), noises = mean("noise");
        const auto rows = rows_of(table, "size");
        const Extent crossings = density_of_crossings(table);
        const Extent moved = extent_of(rows_of(table, "noise"), [&](std::size_t row) {
            return table.number(row, "tetrahedra_per_update");
        });
        text += fmt::format(
            "It is the tetrahedra on the way that cost: {:.2f} to {:.2f} of them a voxel of way at "
            "every speed. With the size of the volume, from {} to {} samples: {}. "
            "With noise added to the ball, up to all of its range: {}, while the "
            "proxy moves through {:.2g} to {:.2g} tetrahedra an update. ",
            crossings.least, crossings.largest, table.text(rows.front(), "size"),
            table.text(rows.back(), "size"), span_text(sizes), span_text(noises), moved.largest,
            moved.least);
    }
    return text +
           "The explicit way extracts the whole isosurface (VTK, flying edges, all "
           "processors) and builds a tree of boxes on it (one thread) before the first "
           "touch, and does both again when the level changes (the fastest of three runs); the "
           "dynamic way does nothing "
           "before, and keeps " +
           bytes_text(sizeof(Proxy)) +
           ". Here the level jumps by a tenth of the data's range, to and fro. " +
           explicit_text(table) + segment_text(table);
}

}  // namespace palpate::evaluation
