// Claims and the paragraph of scaling, from its table.
#include "evaluation/scaling/report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "palpate/proxy.hpp"

namespace palpate::evaluation {
namespace {

/// Smallest and largest of numbers that are not NaN; `largest` is less if there are none.
struct Extent {
    double smallest = std::numeric_limits<double>::infinity();
    double largest = -std::numeric_limits<double>::infinity();
};
Extent extent_of(const std::vector<double>& numbers) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    return {smallest(numbers, infinity), largest(numbers, -infinity)};
}

/// Tetrahedra entered beyond the one that an update starts in, for each voxel of the hand's path.
Extent density_of_crossings(const Table& table) {
    std::vector<double> densities;
    for (const auto& row : table.where("part", "speed")
                               .where("method", "exact")
                               .rows_of({"tetrahedra", "updates", "path_voxel"})) {
        densities.push_back((row[0] - row[1]) / row[2]);
    }
    return extent_of(densities);
}

/// That a column lies within bounds; no claim where nothing was measured.
void claim(std::vector<Claim>& claims, const Table& rows, const char* column, double low,
           double high, const char* statement, const char* measured) {
    const Extent extent = extent_of(rows.numbers(column));
    if (extent.smallest > extent.largest) return;
    claims.push_back({statement, extent.smallest >= low && extent.largest <= high,
                      fmt::format(fmt::runtime(measured), extent.smallest, extent.largest)});
}

}  // namespace

std::vector<Claim> scaling_claims(const Table& table, bool own_volumes) {
    std::vector<Claim> claims;
    const Table both = table.where("part", "explicit");
    claim(claims, both, "heap_growth_bytes", 0, 0,
          "updates and changes of the level take no memory", "heap grew by {:g} to {:g} bytes");
    if (!own_volumes) return claims;
    const Table sizes = table.where("part", "size").where("method", "exact");
    const Table balls = both.where("volume", "ball");
    const double first = sizes.number(0, "tetrahedra");
    claim(claims, sizes, "tetrahedra", first, first,
          "the same motion enters the same tetrahedra in a volume of any size",
          "{:.0f} to {:.0f} tetrahedra");
    const Extent crossings = density_of_crossings(table);
    claims.push_back(
        {"tetrahedra entered grow in proportion to the hand's path, to 10 %",
         crossings.largest <= 1.1 * crossings.smallest,
         fmt::format("{:.3g} to {:.3g} a voxel of path", crossings.smallest, crossings.largest)});
    claim(claims, balls, "unfinished_changes", 0, 0,
          "on the ball one update after a change of the level is on the new surface",
          "{:g} to {:g} changes unfinished");
    claim(claims, balls, "worst_deviation_of_range", 0, granted,
          "and is on it to 1e-9 of the range", "{:.2g} to {:.2g}");
    claim(claims, balls, "one_sided_hits_share", 0, 0,
          "the whole mesh is the same ball: segments that meet one meet both",
          "share of others {:g} to {:g}");
    claim(claims, balls, "hit_difference_voxel", 0, 0.1,
          "and meet both in the same place to 0.1 voxel", "{:.2g} to {:.2g} voxel");
    return claims;
}

std::string time_text(double seconds) {
    if (seconds < 1e-6) return fmt::format("{:.0f} ns", 1e9 * seconds);
    if (seconds < 1e-3) return fmt::format("{:.3g} µs", 1e6 * seconds);
    return seconds < 1 ? fmt::format("{:.3g} ms", 1e3 * seconds) : fmt::format("{:.3g} s", seconds);
}

namespace {

std::string span_text(const Extent& ns) {
    const auto low = fmt::format("{:.0f}", ns.smallest), high = fmt::format("{:.0f}", ns.largest);
    return (low == high ? low : low + " to " + high) + " ns";
}

std::string bytes_text(double bytes) {
    if (bytes < 1e4) return fmt::format("{:.0f} bytes", bytes);
    return bytes < 1e9 ? fmt::format("{:.1f} MB", 1e-6 * bytes)
                       : fmt::format("{:.2f} GB", 1e-9 * bytes);
}

/// What both approaches take on the volumes of the last part; of the balls on the largest.
std::string explicit_text(const Table& table) {
    std::string text;
    const Table rows = table.where("part", "explicit");
    for (std::size_t i = 0; i < rows.rows().size(); ++i) {
        const auto number = [&](const char* column) { return rows.number(i, column); };
        const auto time = [&](const char* column) { return time_text(1e-9 * number(column)); };
        const bool is_last = i + 1 == rows.rows().size() || rows.text(i + 1, "volume") != "ball";
        if (rows.text(i, "volume") == "ball" && !is_last) continue;
        text += fmt::format("{} {}: ", rows.text(i, "volume"), rows.text(i, "size"));
        if (!std::isnan(number("explicit_ready_s"))) {
            text += fmt::format(
                "{:.0f} triangles, {} to extract and {} to build, {} at the peak, {} kept; ",
                number("explicit_triangles"), time_text(number("explicit_extraction_s")),
                time_text(number("explicit_tree_s")), bytes_text(number("explicit_peak_bytes")),
                bytes_text(number("explicit_kept_bytes")));
        }
        text += fmt::format(
            "dynamically, the update after a change of the level takes {} (p99 {}, longest {}; "
            "{:g} of {:g} were not finished by one update). ",
            time("change_p50_ns"), time("change_p99_ns"), time("change_max_ns"),
            number("unfinished_changes"), number("changes"));
    }
    return text;
}

/// What an explicit proxy pays in a tick once all is built.
std::string segment_text(const Table& table) {
    const Table rows = table.where("part", "explicit");
    const Extent query = extent_of(rows.numbers("explicit_segment_ns"));
    const Extent update = extent_of(rows.numbers("mean_ns"));
    std::string text = "Both approaches need the samples in memory.";
    if (query.smallest > query.largest) return text;
    return text + fmt::format(
                      " Once the hierarchy is built, an explicit proxy pays at least one segment "
                      "query a tick, {} here, beside {} for a whole update of the dynamic one.",
                      span_text(query), span_text(update));
}

}  // namespace

std::string scaling_paragraph(const Table& table, bool own_volumes) {
    const auto rows = [&](const char* part, const char* method) {
        return table.where("part", part).where("method", method);
    };
    const auto mean = [&](const char* part, const char* method = "exact") {
        return extent_of(rows(part, method).numbers("mean_ns"));
    };
    const Extent speeds = mean("speed"), voxels = mean("voxels-per-mm");
    std::string text = fmt::format(
        "How the time of an update grows (exact, {:g} Hz, in contact {:g} mm of hand below the "
        "surface; otherwise {:g} mm/s and {:g} voxels a mm). With the hand's speed: mean {}. "
        "With the voxels per millimetre of hand: {}. On the smooth field the same two take {} and "
        "{}. ",
        usual.rate_hz, usual.depth_mm, usual.speed_mm_s, usual.voxels_per_mm, span_text(speeds),
        span_text(voxels), span_text(mean("speed", "smooth")),
        span_text(mean("voxels-per-mm", "smooth")));
    if (own_volumes) {
        const Extent sizes = mean("size"), noises = mean("noise");
        const std::vector<std::string> edges = rows("size", "exact").distinct("size");
        const Extent crossings = density_of_crossings(table);
        const Extent moved = extent_of(rows("noise", "exact").numbers("tetrahedra_per_update"));
        text += fmt::format(
            "The cost is in the tetrahedra passed: {:.2f} to {:.2f} of them a voxel of path at "
            "every speed. With the size of the volume, from {} to {} samples: {}. With noise added "
            "to the ball, up to all of its range: {}, while the proxy moves through {:.2g} to "
            "{:.2g} tetrahedra an update. ",
            crossings.smallest, crossings.largest, edges.front(), edges.back(), span_text(sizes),
            span_text(noises), moved.largest, moved.smallest);
    }
    return text +
           "The explicit approach extracts the whole isosurface (VTK, flying edges) and builds a "
           "bounding volume hierarchy on it (Embree), both on all processors, before the first "
           "touch, and does both again when the level changes (the fastest of three runs); the "
           "dynamic approach does nothing before, and keeps " +
           bytes_text(sizeof(Proxy)) +
           ". Here the level jumps by a tenth of the data's range, to and fro. " +
           explicit_text(table) + segment_text(table);
}

}  // namespace palpate::evaluation
