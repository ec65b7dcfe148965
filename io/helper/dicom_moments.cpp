// Finds the slices that belong to one moment. See the header and docs/io.md.
#include "io/helper/dicom_moments.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "io/helper/dicom_traits.hpp"

namespace palpate::io {
namespace {

using Keys = std::vector<std::size_t>;
using Values = std::vector<double>;

class Moments {
  public:
    Moments(const DicomSeries& series, SliceGroups& groups) : series_(series), groups_(groups) {
        for (const DicomSlice& s : series.slices) keys_ = std::max(keys_, s.keys.size());
    }

    void sort(std::vector<std::string>& notes) {
        put_in_order(notes);
        for (const DicomTrait& trait : traits_in(series_)) keep_together(trait.name);
    }

  private:
    void put_in_order(std::vector<std::string>& notes) {
        if (sort_by_shared_keys()) return;
        for (std::size_t key = 0; key < keys_; ++key) {
            if (!tells_apart({key})) continue;
            if (key == temporal_position && has_repeated(key)) fail();
            sort_by({key});
            if (times_follow(key) || places_follow(key)) return note_ignored(key, notes);
        }
        fail();
    }

    /// If every place has the same values of a property (directions of diffusion), each time step
    /// gets one of them, in the order of the first place.
    void keep_together(const char* name) {
        const TraitClasses classes = classes_of(series_, name);
        const auto classes_at = [&](const std::vector<PlacedSlice>& group) {
            std::vector<std::size_t> all;
            for (const PlacedSlice& p : group) all.push_back(classes[p.slice]);
            return all;
        };
        const auto order = classes_at(groups_.front());
        const auto is_shared = [&](const auto& group) {
            return std::ranges::is_permutation(classes_at(group), order);
        };
        if (!std::ranges::all_of(groups_, is_shared)) return;
        for (auto& group : groups_) {
            for (std::size_t k = 0; k < order.size(); ++k) {
                const auto from = group.begin() + static_cast<std::ptrdiff_t>(k);
                const auto next = std::find_if(from, group.end(), [&](const PlacedSlice& p) {
                    return classes[p.slice] == order[k];
                });
                std::rotate(from, next, next + 1);
            }
        }
    }

    static constexpr const char* const names[] = {"", "TemporalPositionIdentifier", "TriggerTime",
                                                  "NominalPercentageOfCardiacPhase",
                                                  "FrameReferenceTime"};

    [[noreturn]] void fail() const {
        throw Failure("there are " + std::to_string(groups_.front().size()) +
                      " slices at every place, and their headers (temporal position, trigger and "
                      "other times, acquisition and instance numbers) do not say which of them "
                      "belong together; export each volume as a series of its own");
    }

    double value(const PlacedSlice& p, std::size_t key) const {
        const Values& keys = series_.slices[p.slice].keys;
        return key < keys.size() ? keys[key] : std::numeric_limits<double>::quiet_NaN();
    }

    /// By several keys, one after the other. For each place, or for all of them.
    std::vector<Values> values(const std::vector<PlacedSlice>& group, const Keys& keys) const {
        std::vector<Values> all;
        for (const PlacedSlice& p : group) {
            Values& one = all.emplace_back();
            for (const std::size_t key : keys) one.push_back(value(p, key));
        }
        std::ranges::sort(all);
        return all;
    }

    bool is_given(std::size_t key) const {
        return std::ranges::all_of(groups_, [&](const auto& group) {
            return std::ranges::none_of(group,
                                        [&](const auto& p) { return std::isnan(value(p, key)); });
        });
    }

    bool tells_apart(const Keys& keys) const {
        return std::ranges::all_of(keys, [&](std::size_t key) { return is_given(key); }) &&
               std::ranges::all_of(groups_, [&](const auto& group) {
                   const auto all = values(group, keys);
                   return std::ranges::adjacent_find(all) == all.end();
               });
    }

    /// Whether a value is that of several slices, wherever they lie.
    bool has_repeated(std::size_t key) const {
        Values all;
        for (const auto& group : groups_) {
            for (const PlacedSlice& p : group) all.push_back(value(p, key));
        }
        std::ranges::sort(all);
        return std::ranges::adjacent_find(all) != all.end();
    }

    void sort_by(const Keys& keys) {
        const auto before = [&](const PlacedSlice& a, const PlacedSlice& b) {
            for (const std::size_t key : keys) {
                if (value(a, key) != value(b, key)) return value(a, key) < value(b, key);
            }
            return false;
        };
        for (auto& group : groups_) std::ranges::stable_sort(group, before);
    }

    /// A frame's number counts after its dimensions: in several files, frames at every place may
    /// have the same numbers by chance.
    Keys keys_in_order() const {
        Keys keys(keys_);
        std::iota(keys.begin(), keys.end(), std::size_t{0});
        if (keys_ > first_dimension) {
            std::rotate(keys.begin() + frame_number, keys.begin() + first_dimension, keys.end());
        }
        return keys;
    }

    bool sort_by_shared_keys() {
        Keys keys;
        for (const std::size_t key : keys_in_order()) {
            if (!is_given(key)) continue;
            keys.push_back(key);
            const auto first = values(groups_.front(), keys);
            const bool shared = std::ranges::all_of(
                groups_, [&](const auto& group) { return values(group, keys) == first; });
            if (!shared) keys.pop_back();
            if (shared && tells_apart(keys)) {
                sort_by(keys);
                return true;
            }
        }
        return false;
    }

    /// Sorted by the key, every slice of a moment comes before all of the next.
    bool times_follow(std::size_t key) const {
        for (std::size_t k = 1; k < groups_.front().size(); ++k) {
            double last = -std::numeric_limits<double>::infinity();
            for (const auto& group : groups_) last = std::max(last, value(group[k - 1], key));
            for (const auto& group : groups_) {
                if (value(group[k], key) <= last) return false;
            }
        }
        return true;
    }

    /// Sorted by the key, every slice of a place comes before all of another.
    bool places_follow(std::size_t key) const {
        std::vector<std::pair<double, double>> ranges;
        for (const auto& group : groups_) {
            ranges.emplace_back(value(group.front(), key), value(group.back(), key));
        }
        std::ranges::sort(ranges);
        for (std::size_t i = 1; i < ranges.size(); ++i) {
            if (ranges[i].first <= ranges[i - 1].second) return false;
        }
        return true;
    }

    void note_ignored(std::size_t used, std::vector<std::string>& notes) const {
        for (std::size_t key = temporal_position; key < std::min(used, std::size(names)); ++key) {
            if (!tells_apart({key})) continue;
            notes.push_back(std::string("its ") + names[key] +
                            " is not the same at every place: the time steps are in the order of " +
                            "acquisition, and may be of different moments");
            return;
        }
    }

    const DicomSeries& series_;
    SliceGroups& groups_;
    std::size_t keys_ = 0;
};

}  // namespace

void sort_by_moment(const DicomSeries& series, SliceGroups& groups,
                    std::vector<std::string>& notes) {
    if (groups.front().size() > 1) Moments(series, groups).sort(notes);
}

}  // namespace palpate::io
