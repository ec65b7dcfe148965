// Coarser levels of a grid. See the header.
#include "stream/writer/pyramid.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "io/file_grid.hpp"
#include "stream/box_bytes.hpp"

namespace palpate::stream {

CoarserGrid coarser(const Geometry& finer) {
    double least = std::numeric_limits<double>::infinity();
    for (int a = 0; a < 3; ++a) {
        if (finer.size[a] > 1) least = std::min(least, finer.spacing[a]);
    }
    CoarserGrid grid{finer, Index3::Ones()};
    Vec3 shift = Vec3::Zero();  // of sample 0 [mm, grid axes]
    for (int a = 0; a < 3; ++a) {
        if (finer.size[a] == 1 || finer.spacing[a] >= 2 * least) continue;
        grid.factor[a] = 2;
        grid.geometry.size[a] = (finer.size[a] + 1) / 2;
        grid.geometry.spacing[a] = 2 * finer.spacing[a];
        shift[a] = finer.spacing[a] / 2;
    }
    grid.geometry.origin += finer.direction * shift;
    return grid;
}

std::vector<CoarserGrid> pyramid_of(const Geometry& finest, int chunk) {
    std::vector<CoarserGrid> grids = {{finest, Index3::Ones()}};
    while ((grids.back().geometry.size.array() > chunk).any()) {
        CoarserGrid next = coarser(grids.back().geometry);
        if (!io::why_no_file_grid(next.geometry).empty()) break;  // it could not be opened
        grids.push_back(std::move(next));
    }
    return grids;
}

SampleBox finer_box(const SampleBox& box, const Index3& factor, const Geometry& finer) {
    SampleBox wanted;
    for (int a = 0; a < 3; ++a) {
        wanted.low[a] = box.low[a] * factor[a];
        wanted.high[a] = std::min(box.high[a] * factor[a] + factor[a], finer.size[a]) - 1;
    }
    return wanted;
}

namespace {

/// The finer samples below a coarser one. They are read where they lie: this is the innermost loop
/// of a conversion.
template <class T>
class Below {
  public:
    /// `low` to `high` of the samples `finer` of `finer_box`. Both stay with the caller.
    Below(std::span<const std::byte> finer, const SampleBox& finer_box, const Index3& low,
          const Index3& high)
        : box_(finer_box), low_(low), size_(high - low + Index3::Ones()) {
        first_ = finer.data() + place_in(box_, low_) * sizeof(T);
    }

    /// Whether test(sample) holds for one of them, x fastest.
    template <class Test>
    bool any(Test&& test) const {
        const auto row = static_cast<std::size_t>(box_.high[0] - box_.low[0] + 1);
        const auto plane = row * static_cast<std::size_t>(box_.high[1] - box_.low[1] + 1);
        for (int z = 0; z < size_[2]; ++z) {
            for (int y = 0; y < size_[1]; ++y) {
                const std::size_t before =
                    plane * static_cast<std::size_t>(z) + row * static_cast<std::size_t>(y);
                for (int x = 0; x < size_[0]; ++x) {
                    if (test(sample_at(before + static_cast<std::size_t>(x)))) return true;
                }
            }
        }
        return false;
    }
    T first() const { return sample_at(0); }
    /// Of two along an axis the second.
    T middle(const Index3& factor) const {
        const Index3 at = low_ + (factor / 2).cwiseMin(size_ - Index3::Ones());
        return sample_at(place_in(box_, at) - place_in(box_, low_));
    }
    double mean() const {
        double sum = 0;
        any([&](T sample) {
            sum += static_cast<double>(sample);
            return false;
        });
        return sum / static_cast<double>(size_.cast<std::int64_t>().prod());
    }
    T rounded_mean() const {
        if constexpr (std::is_integral_v<T>) return static_cast<T>(std::lround(mean()));
        return static_cast<T>(mean());
    }

  private:
    /// `place`: among the samples of the box, from the first one below.
    T sample_at(std::size_t place) const {
        T sample;
        std::memcpy(&sample, first_ + place * sizeof sample, sizeof sample);
        return sample;
    }

    const SampleBox& box_;
    const Index3 low_, size_;
    const std::byte* first_;
};

/// Calls visit(below) for each sample of a coarser box.
template <class T, class Visit>
void for_each_below(std::span<const std::byte> finer, const SampleBox& finer_box,
                    const Index3& factor, const SampleBox& box, Visit&& visit) {
    for_each_index(box, [&](const Index3& at) {
        const Index3 low = at.cwiseProduct(factor);
        const Index3 high = (low + factor - Index3::Ones()).cwiseMin(finer_box.high);
        visit(Below<T>(finer, finer_box, low, high));
    });
}

/// Rounded to the nearest whole number, or down. Other programs may add floats in another order.
template <class T>
bool is_mean(T sample, const Below<T>& below) {
    const double mean = below.mean(), off = mean - static_cast<double>(sample);
    if constexpr (std::is_integral_v<T>) return off >= -0.5 && off < 1;
    return std::abs(off) <= 1e-5 * std::abs(mean) || (std::isnan(mean) && std::isnan(sample));
}

template <class T>
bool is_same(T a, T b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

}  // namespace

void take_coarser(Coarsening how, SampleType type, std::span<const std::byte> finer,
                  const SampleBox& finer_box, const Index3& factor, const SampleBox& box,
                  std::span<std::byte> out) {
    with_type(type, [&](auto zero) {
        using T = decltype(zero);
        std::byte* to = out.data();
        for_each_below<T>(finer, finer_box, factor, box, [&](const Below<T>& below) {
            const T value = how == Coarsening::mean    ? below.rounded_mean()
                            : how == Coarsening::first ? below.first()
                                                       : below.middle(factor);
            std::memcpy(to, &value, sizeof value);
            to += sizeof value;
        });
    });
}

void take_means(SampleType type, std::span<const std::byte> finer, const SampleBox& finer_box,
                const Index3& factor, const SampleBox& box, std::span<std::byte> out) {
    take_coarser(Coarsening::mean, type, finer, finer_box, factor, box, out);
}

void CoarseningSeen::look(SampleType type, std::span<const std::byte> finer,
                          const SampleBox& finer_box, const Index3& factor, const SampleBox& box,
                          std::span<const std::byte> coarser) {
    with_type(type, [&](auto zero) {
        using T = decltype(zero);
        const std::byte* from = coarser.data();
        for_each_below<T>(finer, finer_box, factor, box, [&](const Below<T>& below) {
            T stored;
            std::memcpy(&stored, from, sizeof stored);
            from += sizeof stored;
            const auto is_stored = [&](T sample) { return is_same(sample, stored); };
            const auto is_other = [&](T sample) { return !is_same(sample, below.first()); };
            all_first_ = all_first_ && is_stored(below.first());
            all_middle_ = all_middle_ && is_stored(below.middle(factor));
            all_below_ = all_below_ && below.any(is_stored);
            if (!below.any(is_other)) return;
            ++telling_;
            means_ += is_mean(stored, below) ? 1 : 0;
        });
    });
}

bool CoarseningSeen::is_known() const {
    return telling_ > 0 && (all_first_ || all_middle_ || 2 * means_ > telling_);
}

Coarsening CoarseningSeen::found() const {
    if (all_first_) return Coarsening::first;
    if (all_middle_) return Coarsening::middle;
    const bool are_means = 2 * means_ > telling_;
    return all_below_ && !are_means ? Coarsening::first : Coarsening::mean;
}

}  // namespace palpate::stream
