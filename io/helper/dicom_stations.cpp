// Tells stations apart. See the header and docs/io.md.
#include "io/helper/dicom_stations.hpp"

#include <algorithm>
#include <numeric>
#include <set>

#include "io/helper/dicom_traits.hpp"

namespace palpate::io {
namespace {

using Places = std::vector<Eigen::Vector2d>;

/// Divides slices, given by their numbers, where none of them lies in a gap of an axis.
std::vector<std::vector<std::size_t>> cut(std::vector<std::size_t> slices, const Places& places,
                                          int axis, double gap) {
    const auto place = [&](std::size_t i) { return places[i][axis]; };
    std::ranges::stable_sort(slices, {}, place);
    std::vector<std::vector<std::size_t>> parts;
    for (const std::size_t i : slices) {
        if (parts.empty() || place(i) - place(parts.back().back()) > gap) parts.emplace_back();
        parts.back().push_back(i);
    }
    return parts;
}

/// For each slice, which of the stations it belongs to. These lie more than `gap` pixels apart.
std::vector<std::size_t> stations_of(const Places& places, double gap) {
    std::vector<std::size_t> all(places.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    std::vector<std::vector<std::size_t>> parts{all};
    for (bool changes = true; changes;) {
        std::vector<std::vector<std::size_t>> next;
        for (const auto& part : parts) {
            for (const auto& wide : cut(part, places, 0, gap)) {
                for (auto& one : cut(wide, places, 1, gap)) next.push_back(std::move(one));
            }
        }
        changes = next.size() > parts.size();
        parts = std::move(next);
    }
    std::vector<std::size_t> stations(places.size());
    for (std::size_t k = 0; k < parts.size(); ++k) {
        for (const std::size_t i : parts[k]) stations[i] = k;
    }
    return stations;
}

bool are_side_by_side(const SlicesAtPlaces& planes, const std::vector<std::size_t>& stations) {
    return std::ranges::any_of(planes, [&](const auto& plane) {
        return std::ranges::any_of(
            plane, [&](std::size_t i) { return stations[i] != stations[plane[0]]; });
    });
}

/// Whether slices of one station lie between those of another, and none is alone.
bool are_interleaved(const SlicesAtPlaces& planes, const std::vector<std::size_t>& stations) {
    std::vector<std::vector<std::size_t>> planes_of(
        1 + *std::max_element(stations.begin(), stations.end()));
    for (std::size_t k = 0; k < planes.size(); ++k) {
        for (const std::size_t i : planes[k]) planes_of[stations[i]].push_back(k);
    }
    std::ranges::sort(planes_of);
    bool overlap = false;
    for (std::size_t s = 0; s < planes_of.size(); ++s) {
        if (planes_of[s].back() == planes_of[s].front()) return false;
        overlap = overlap || (s > 0 && planes_of[s].front() < planes_of[s - 1].back());
    }
    return overlap;
}

/// Each of several planes of its own, as those of a tilted gantry: no stations that are known.
bool are_single(const SlicesAtPlaces& planes, const std::vector<std::size_t>& stations) {
    std::set<std::pair<std::size_t, std::size_t>> all;
    std::set<std::size_t> seen;
    for (std::size_t k = 0; k < planes.size(); ++k) {
        for (const std::size_t i : planes[k]) {
            if (all.emplace(stations[i], k).second) seen.insert(stations[i]);
        }
    }
    return planes.size() > 1 && all.size() == seen.size();
}

std::string place_name(const DicomSlice& s) {
    const Vec3& p = *s.position;
    return "from (" + text_of(p[0]) + ", " + text_of(p[1]) + ", " + text_of(p[2]) + ") mm";
}

}  // namespace

Eigen::Vector2d place_in_plane(const DicomSlice& slice, const DicomSlice& of) {
    const Vec3 way = *slice.position - *of.position;
    const Vec3 pixel = of.pixel.value_or(Vec3(1, of.aspect, 0));
    return {of.row->normalized().dot(way) / pixel[0], of.column->normalized().dot(way) / pixel[1]};
}

std::vector<DicomSeries> by_station(DicomSeries series) {
    const SlicesAtPlaces planes = slices_at_places(series);
    if (series.slices.size() < 2 || planes.empty()) return {std::move(series)};
    const DicomSlice& first = series.slices.front();
    Places places;
    for (const DicomSlice& s : series.slices) places.push_back(place_in_plane(s, first));
    auto stations = stations_of(places, same_place_pixels);
    if (!are_side_by_side(planes, stations)) {
        // Planes of one station may lie between those of another.
        stations = stations_of(places, 0.5 * std::min(first.columns, first.rows));
        if (!are_interleaved(planes, stations)) return {std::move(series)};
    } else if (are_single(planes, stations)) {
        return {std::move(series)};
    }
    std::vector<std::string> names(places.size()), of_station(places.size());
    for (const auto& plane : planes) {
        for (const std::size_t i : plane) {
            std::string& name = of_station[stations[i]];
            if (name.empty()) name = place_name(series.slices[i]);
            names[i] = name;
        }
    }
    return divided(std::move(series), names);
}

}  // namespace palpate::io
