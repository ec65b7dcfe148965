// Tells DICOM series apart. See the header and docs/io.md.
#include "io/helper/dicom_series.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

namespace palpate::io {
namespace {

std::string key_of(const DicomSlice& s) {
    std::string key = s.series_uid + "|" + s.stack + "|" + s.kind + "|" + std::to_string(s.rows) +
                      "x" + std::to_string(s.columns) + "|" + s.patient_id + "|" + s.study_uid +
                      "|" + s.frame_of_reference;
    // Moments of different places, which are not known, make no volume.
    if (s.is_moment && !s.position) key += "|" + s.instance_uid;
    return key;
}

/// Equal but for rounding in the files' decimals.
bool is_same(const std::optional<Vec3>& a, const std::optional<Vec3>& b) {
    constexpr double part = 1e-3;
    if (!a || !b) return !a && !b;
    return (*a - *b).cwiseAbs().maxCoeff() <= part * a->cwiseAbs().maxCoeff();
}

/// Some scanners write the echo time that they measured for each slice.
bool is_same_echo(double a, double b) {
    return std::abs(a - b) <= 0.01 * std::abs(a) || (std::isnan(a) && std::isnan(b));
}

bool are_alike(const DicomSlice& a, const DicomSlice& b) {
    return is_same(a.row, b.row) && is_same(a.column, b.column) && is_same(a.pixel, b.pixel) &&
           is_same_echo(a.echo, b.echo);
}

/// [mm] along the normal; the number of a slice without a place.
double place_along(const DicomSlice& s) {
    if (!s.is_placed()) return s.frames > 1 ? s.order : s.instance;
    return s.row->cross(*s.column).dot(*s.position);
}

/// In order; empty where slices have no place.
std::vector<double> places_along(const DicomSeries& series) {
    std::vector<double> along;
    for (const DicomSlice& s : series.slices) {
        if (!s.is_placed()) return {};
        along.push_back(place_along(s));
    }
    std::sort(along.begin(), along.end());
    return along;
}

void name_echo(DicomSeries& series) {
    const double echo = series.slices.front().echo;
    if (!std::isfinite(echo)) return;
    for (DicomSlice& s : series.slices) {
        s.kind += (s.kind.empty() ? "" : ", ") + ("echo time " + text_of(echo)) + " ms";
    }
}

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

/// The parts of a series that a property of its slices tells apart, which their kinds then name.
template <class Name>
std::vector<DicomSeries> divided(DicomSeries series, const Name& name_of) {
    std::map<std::string, DicomSeries> parts;
    for (DicomSlice& s : series.slices) {
        const std::string name = name_of(s);
        DicomSeries& one = parts[name];
        one.uid = series.uid;
        s.kind += (s.kind.empty() || name.empty() ? "" : ", ") + name;
        one.slices.push_back(std::move(s));
    }
    std::vector<DicomSeries> all;
    for (auto& [name, one] : parts) all.push_back(std::move(one));
    return all;
}

/// Contrasts (water, fat) apart, where there are several at one place.
std::vector<DicomSeries> by_contrast(DicomSeries series) {
    if (!has_several_at_one_place(series)) return {std::move(series)};
    return divided(std::move(series), [](const DicomSlice& s) { return s.contrast; });
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
    const auto parts = divided(series, [](const DicomSlice& s) {
        const double number = s.frames == 1 ? s.keys.at(acquisition_number) : 0;
        return number > 0 ? "acquisition " + text_of(number) : "";
    });
    const bool are_apart =
        std::ranges::none_of(parts, has_several_at_one_place) && are_volumes(parts, places);
    return are_apart ? parts : std::vector{std::move(series)};
}

/// An anonymiser may give each file an identity of its own. It then tells nothing apart.
void forget_unique(std::vector<DicomSlice>& slices, std::string DicomSlice::*identity) {
    std::map<std::string, std::map<std::string, int>> counts;
    for (const DicomSlice& s : slices) ++counts[s.series_uid][s.*identity];
    for (DicomSlice& s : slices) {
        const auto& own = counts.at(s.series_uid);
        const bool unique =
            std::ranges::all_of(own, [](const auto& one) { return one.second == 1; });
        if (unique && own.size() > 2) (s.*identity).clear();
    }
}

/// What tells the series from others of its UID.
std::string difference_of(const DicomSeries& series, const std::vector<DicomSeries>& all) {
    struct Part {
        const char* name;
        std::string DicomSlice::*value;
    };
    static constexpr Part parts[] = {{"", &DicomSlice::kind},
                                     {"patient ", &DicomSlice::patient_id},
                                     {"study ", &DicomSlice::study_uid},
                                     {"frame of reference ", &DicomSlice::frame_of_reference}};
    std::string text;
    for (const Part& part : parts) {
        const std::string& own = series.slices.front().*part.value;
        const auto differs = [&](const DicomSeries& other) {
            return other.uid == series.uid && other.slices.front().*part.value != own;
        };
        if (own.empty() || std::ranges::none_of(all, differs)) continue;
        text += (text.empty() ? "" : ", ") + std::string(part.name) + own;
    }
    return text;
}

}  // namespace

/// Some scanners have pixels of 1 um.
double same_place_mm(const DicomSeries& series) {
    const auto& pixel = series.slices.front().pixel;
    return std::min(0.05, 0.05 * (pixel ? pixel->head<2>().minCoeff() : 0.1));
}

std::vector<DicomSeries> series_of(std::vector<DicomSlice> slices) {
    for (const auto identity :
         {&DicomSlice::patient_id, &DicomSlice::study_uid, &DicomSlice::frame_of_reference}) {
        forget_unique(slices, identity);
    }
    std::map<std::string, std::vector<DicomSeries>> sorted;
    for (DicomSlice& s : slices) {
        std::vector<DicomSeries>& alike = sorted[key_of(s)];
        auto series = std::ranges::find_if(
            alike, [&](const DicomSeries& one) { return are_alike(one.slices.front(), s); });
        if (series == alike.end()) series = alike.insert(alike.end(), {s.series_uid, {}});
        series->slices.push_back(std::move(s));
    }
    std::vector<DicomSeries> all;
    for (auto& [key, alike] : sorted) {
        for (DicomSeries& one : alike) {
            name_echo(one);
            for (DicomSeries& contrast : by_contrast(std::move(one))) {
                std::ranges::move(by_acquisition(std::move(contrast)), std::back_inserter(all));
            }
        }
    }
    return all;
}

SeriesInfo info_of(const DicomSeries& series) {
    const DicomSlice& one = series.slices.front();
    SeriesInfo info;
    info.uid = one.series_uid;
    info.patient = one.patient;
    info.study = one.study;
    info.description = one.description;
    info.modality = one.values.modality;
    info.stack = one.stack;
    info.slices = static_cast<int>(series.slices.size());
    info.size = {one.columns, one.rows};
    if (one.pixel) info.spacing.head<2>() = one.pixel->head<2>();
    const std::vector<double> along = places_along(series);
    double gap = 0;
    for (std::size_t i = 1; i < along.size(); ++i) {
        const double step = along[i] - along[i - 1];
        if (step > same_place_mm(series) && (gap == 0 || step < gap)) gap = step;
    }
    info.spacing[2] = gap > 0 ? gap : one.thickness;
    return info;
}

const DicomSlice& middle_of(const DicomSeries& series) {
    std::vector<std::pair<double, const DicomSlice*>> order;
    for (const DicomSlice& s : series.slices) order.emplace_back(place_along(s), &s);
    const auto middle = order.begin() + static_cast<std::ptrdiff_t>(order.size() / 2);
    std::nth_element(order.begin(), middle, order.end());
    return *middle->second;
}

const DicomSeries& choose_series(const std::vector<DicomSeries>& all, const std::string& chosen) {
    if (all.size() == 1 && chosen.empty()) return all.front();
    std::vector<const DicomSeries*> matching;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (chosen == std::to_string(i + 1) || chosen == all[i].uid) matching.push_back(&all[i]);
    }
    if (matching.size() == 1) return *matching.front();
    std::string text = chosen.empty()     ? "has " + std::to_string(all.size()) + " DICOM series"
                       : matching.empty() ? "has no DICOM series '" + chosen + "'"
                                          : "has several DICOM series '" + chosen + "'";
    std::vector<SeriesInfo> list;
    for (const DicomSeries& series : all) {
        list.push_back(info_of(series));
        const std::string difference = difference_of(series, all);
        std::string& about = list.back().description;
        about += (about.empty() || difference.empty() ? "" : ", ") + difference;
    }
    throw ChooseSeries(text + "; choose one by its number or UID", std::move(list));
}

}  // namespace palpate::io
