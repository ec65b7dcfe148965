// Tells DICOM series apart. See the header and docs/io.md.
#include "io/helper/dicom_series.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "io/helper/dicom_parts.hpp"

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

void name_echo(DicomSeries& series) {
    const double echo = series.slices.front().echo;
    if (!std::isfinite(echo)) return;
    for (DicomSlice& s : series.slices) {
        s.kind += (s.kind.empty() ? "" : ", ") + ("echo time " + text_of(echo)) + " ms";
    }
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
            std::ranges::move(parts_of(std::move(one)), std::back_inserter(all));
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
