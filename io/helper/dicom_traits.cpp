// Compares properties of DICOM slices. See the header.
#include "io/helper/dicom_traits.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "io/helper/dicom_series.hpp"

namespace palpate::io {
namespace {

/// Null if the slice does not have it.
const DicomTrait* trait_of(const DicomSlice& slice, const std::string& name) {
    const auto found = std::ranges::find(slice.traits, name, &DicomTrait::name);
    return found == slice.traits.end() ? nullptr : &*found;
}

/// The least number of each value, in order.
std::vector<double> values_of(const DicomSeries& series, const char* name) {
    constexpr double part = 0.01;
    std::vector<double> numbers, values;
    for (const DicomSlice& s : series.slices) {
        const DicomTrait* const trait = trait_of(s, name);
        if (trait != nullptr && std::isfinite(trait->number)) numbers.push_back(trait->number);
    }
    std::ranges::sort(numbers);
    for (const double number : numbers) {
        if (values.empty() || number - values.back() > part * std::abs(values.back())) {
            values.push_back(number);
        }
    }
    return values;
}

}  // namespace

SlicesAtPlaces slices_at_places(const DicomSeries& series) {
    const auto& slices = series.slices;
    if (!std::ranges::all_of(slices, &DicomSlice::is_placed)) return {};
    const Vec3 normal = slices.front().normal();
    std::vector<double> along;
    for (const DicomSlice& s : slices) along.push_back(normal.dot(*s.position));
    std::vector<std::size_t> order(slices.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return along[i]; });
    SlicesAtPlaces places;
    for (const std::size_t i : order) {
        if (places.empty() || along[i] - along[places.back()[0]] > same_place_mm(series)) {
            places.emplace_back();
        }
        places.back().push_back(i);
    }
    return places;
}

std::vector<DicomTrait> traits_in(const DicomSeries& series) {
    std::vector<DicomTrait> all;
    std::set<std::string> seen;
    for (const DicomSlice& s : series.slices) {
        for (const DicomTrait& trait : s.traits) {
            if (seen.insert(trait.name).second) all.push_back(trait);
        }
    }
    return all;
}

TraitClasses classes_of(const DicomSeries& series, const char* name) {
    const std::vector<double> values = values_of(series, name);
    std::map<std::string, std::size_t> words;  // an empty one: not given
    TraitClasses classes;
    for (const DicomSlice& s : series.slices) {
        const DicomTrait* const trait = trait_of(s, name);
        if (trait != nullptr && std::isfinite(trait->number)) {
            const auto above = std::ranges::upper_bound(values, trait->number);
            classes.push_back(static_cast<std::size_t>(above - values.begin() - 1));
            continue;
        }
        const std::string word = trait == nullptr ? "" : trait->word;
        classes.push_back(words.try_emplace(word, values.size() + words.size()).first->second);
    }
    return classes;
}

bool is_shared(const SlicesAtPlaces& places, const TraitClasses& classes) {
    if (places.empty()) return false;
    const auto values_at = [&](const std::vector<std::size_t>& place) {
        std::set<std::size_t> all;
        for (const std::size_t i : place) all.insert(classes[i]);
        return all;
    };
    const auto first = values_at(places.front());
    return first.size() > 1 && std::ranges::all_of(places, [&](const auto& place) {
               return values_at(place) == first;
           });
}

std::string name_of(const DicomSlice& slice, const char* name) {
    const DicomTrait* const trait = trait_of(slice, name);
    if (trait == nullptr) return std::string("no ") + name;
    const bool is_number = std::isfinite(trait->number);
    return std::string(name) + " " + (is_number ? text_of(trait->number) : trait->word) +
           trait->unit;
}

std::vector<DicomSeries> divided(DicomSeries series, const std::vector<std::string>& names) {
    std::map<std::string, DicomSeries> parts;
    for (std::size_t i = 0; i < names.size(); ++i) {
        DicomSlice& s = series.slices[i];
        DicomSeries& one = parts[names[i]];
        one.uid = series.uid;
        s.kind += (s.kind.empty() || names[i].empty() ? "" : ", ") + names[i];
        one.slices.push_back(std::move(s));
    }
    std::vector<DicomSeries> all;
    for (auto& [name, one] : parts) all.push_back(std::move(one));
    return all;
}

}  // namespace palpate::io
