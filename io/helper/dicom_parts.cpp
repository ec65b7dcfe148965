// Divides DICOM series into volumes. See the header and docs/io.md.
#include "io/helper/dicom_parts.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>

#include "io/helper/dicom_series.hpp"
#include "io/helper/dicom_stations.hpp"
#include "io/helper/dicom_traits.hpp"

namespace palpate::io {
namespace {

struct Place {
    double along = 0;  ///< [mm] of its first slice
    int slices = 0;
};

/// In order; empty where slices have no place.
std::vector<Place> counted_places(const DicomSeries& series) {
    const std::vector<double> along = places_along(series);
    const double least = same_place_mm(series);
    std::vector<Place> places;
    for (std::size_t i = 0; i < along.size(); ++i) {
        if (i == 0 || along[i] - along[i - 1] > least) places.push_back({along[i]});
        ++places.back().slices;
    }
    return places;
}

bool has_several_at_one_place(const DicomSeries& series) {
    return std::ranges::any_of(counted_places(series), [](const Place& p) { return p.slices > 1; });
}

/// Contrasts (water, fat) apart, where there are several at one place.
std::vector<DicomSeries> by_contrast(DicomSeries series) {
    if (!has_several_at_one_place(series)) return {std::move(series)};
    std::vector<std::string> names;
    for (const DicomSlice& s : series.slices) names.push_back(s.contrast);
    return divided(std::move(series), names);
}

/// Whether each part is a volume of its own, which overlaps with another one. Parts of one volume
/// leave out places that other parts have (every second slice), or lie beside them.
bool are_volumes(const std::vector<DicomSeries>& parts, const std::vector<Place>& places) {
    const double least = same_place_mm(parts.front());
    const auto lies_in = [&](double place, const std::vector<double>& along) {
        return place >= along.front() - least && place <= along.back() + least;
    };
    std::vector<std::vector<double>> all;
    std::ranges::transform(parts, std::back_inserter(all), places_along);
    return std::ranges::all_of(all, [&](const auto& along) {
        const auto is_missing = [&](const Place& p) {
            const auto is_here = [&](double a) { return std::abs(a - p.along) <= least; };
            return lies_in(p.along, along) && std::ranges::none_of(along, is_here);
        };
        const auto overlaps = [&](const auto& other) {
            return &other != &along &&
                   (lies_in(other.front(), along) || lies_in(along.front(), other));
        };
        return std::ranges::none_of(places, is_missing) && std::ranges::any_of(all, overlaps);
    });
}

/// Acquisitions apart, where they overlap: some places have slices of several of them, but not all
/// places, as those of time steps have.
std::vector<DicomSeries> by_acquisition(DicomSeries series) {
    const std::vector<Place> places = counted_places(series);
    const auto differ = [](const Place& a, const Place& b) { return a.slices != b.slices; };
    if (std::ranges::adjacent_find(places, differ) == places.end()) return {std::move(series)};
    std::vector<std::string> names;
    for (const DicomSlice& s : series.slices) {
        const double number = s.frames == 1 ? s.keys.at(acquisition_number) : 0;
        names.push_back(number > 0 ? "acquisition " + text_of(number) : "");
    }
    const auto parts = divided(series, names);
    const bool are_apart =
        std::ranges::none_of(parts, has_several_at_one_place) && are_volumes(parts, places);
    return are_apart ? parts : std::vector{std::move(series)};
}

/// Whether moments that the header counts go along with a property, such as the inversion time of a
/// film. Then these are moments of one series.
bool are_moments_of(const DicomSeries& series, const TraitClasses& classes) {
    for (const std::size_t key : {temporal_position, trigger_time, cardiac_phase}) {
        std::map<double, std::size_t> of_moment;
        std::set<std::size_t> seen;
        const auto follows = [&](std::size_t i) {
            const double moment = series.slices[i].keys.at(key);
            seen.insert(classes[i]);
            return std::isfinite(moment) &&
                   of_moment.try_emplace(moment, classes[i]).first->second == classes[i];
        };
        bool all = true;
        for (std::size_t i = 0; all && i < classes.size(); ++i) all = follows(i);
        if (all && seen.size() > 1) return true;
    }
    return false;
}

/// By the first property that has several values at each place, and the same ones at all.
std::vector<DicomSeries> by_trait(DicomSeries series) {
    if (!has_several_at_one_place(series)) return {std::move(series)};
    const auto places = slices_at_places(series);
    for (const DicomTrait& trait : traits_in(series)) {
        if (!trait.is_series) continue;
        const TraitClasses classes = classes_of(series, trait.name);
        if (!is_shared(places, classes) || are_moments_of(series, classes)) continue;
        std::map<std::size_t, std::string> names;  // by the first slice of a class
        for (std::size_t i = 0; i < classes.size(); ++i) {
            names.try_emplace(classes[i], name_of(series.slices[i], trait.name));
        }
        std::vector<std::string> own;
        for (const std::size_t one : classes) own.push_back(names[one]);
        std::vector<DicomSeries> all;
        for (DicomSeries& part : divided(std::move(series), own)) {
            std::ranges::move(by_trait(std::move(part)), std::back_inserter(all));
        }
        return all;
    }
    return {std::move(series)};
}

}  // namespace

std::vector<DicomSeries> parts_of(DicomSeries series) {
    std::vector<DicomSeries> all;
    for (DicomSeries& station : by_station(std::move(series))) {
        for (DicomSeries& contrast : by_contrast(std::move(station))) {
            for (DicomSeries& part : by_trait(std::move(contrast))) {
                std::ranges::move(by_acquisition(std::move(part)), std::back_inserter(all));
            }
        }
    }
    return all;
}

}  // namespace palpate::io
