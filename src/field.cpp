// Field: reads samples anywhere. Samples in one plain array are read in rows, others one by one:
// from background, labels, edits, bricks of a large grid and two frames.
#include "palpate/field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "palpate/names.hpp"

namespace palpate {
namespace {

/// Data at most this many times their range from zero are used as they are: there the tolerance is
/// 9.3e-10 of the range, just within what G1 and G2 grant. From others an offset is taken.
constexpr double most_ranges_from_zero = 1 << 19;

}  // namespace

std::string_view name_of(Interpolation interpolation) {
    return enum_name(interpolation);
}

Interpolation interpolation_from(std::string_view name) {
    return named<Interpolation>(name);
}

Field::Field(Volume volume, Solid solid, std::optional<double> background,
             Interpolation interpolation)
    : Field(std::make_shared<const Samples>(std::move(volume)), solid, background, interpolation) {}

Field::Field(std::shared_ptr<const Samples> samples, Solid solid, std::optional<double> background,
             Interpolation interpolation)
    : samples_(std::move(samples)),
      row_(geometry().size[0]),
      slice_(row_ * geometry().size[1]),
      background_(
          background.value_or(solid == Solid::above ? samples_->minimum() : samples_->maximum())),
      voxels_per_mm_(geometry().spacing.cwiseInverse()),
      sign_(solid == Solid::above ? 1 : -1),
      size_(geometry().size),
      cells_(size_ - Index3::Ones()),
      solid_(solid),
      interpolation_(interpolation) {
    // Like all samples: then no product of the proxy's overflows.
    if (!(std::abs(background_) <= std::numeric_limits<float>::max())) {
        throw std::invalid_argument("the background is not finite or beyond +-3.4e38");
    }
    look();
}

void Field::use(const std::shared_ptr<const Samples>& samples) noexcept {
    samples_ = samples;
    look();
}

void Field::set_time(double time) noexcept {
    if (time == time_) return;
    time_ = time;
    look();
}

void Field::cover(const std::shared_ptr<const Field>& labels, std::uint32_t solid_labels,
                  double open, double solid) noexcept {
    if (cover_.labels != labels) {
        if (!cover_.labels) cover_.background = background_;
        cover_.labels = labels;
        const Geometry &from = geometry(), &to = labels->geometry();
        cover_.shift = index_from_physical(to, physical_from_index(from, Vec3::Zero()));
        for (int a = 0; a < 3; ++a) {
            const Vec3 next = physical_from_index(from, Vec3::Unit(a));
            cover_.turn.col(a) = index_from_physical(to, next) - cover_.shift;
        }
        constexpr double rounding = 1e-6;  // [voxel]
        cover_.same_grid = from.size == to.size &&
                           (cover_.turn - Mat3::Identity()).cwiseAbs().maxCoeff() *
                                   static_cast<double>(from.size.maxCoeff()) <
                               rounding &&
                           cover_.shift.cwiseAbs().maxCoeff() < rounding;
        look();
    }
    cover_.solid_labels = solid_labels;
    cover_.open = open - offset_;
    cover_.solid = solid - offset_;
    background_ = (solid_labels & 1U) != 0 ? solid : cover_.background;
}

namespace {

/// Reads samples in bricks one by one. Neighbours mostly lie in one resident brick, which is then
/// looked up only once.
template <class T>
class BrickReader {
  public:
    BrickReader(const ResidentBricks* resident, const Bricks* edited)
        : resident_(resident), edited_(edited) {}

    /// Null if the sample is in no brick. In a large grid this means that it is not in memory.
    const T* find(const Index3& at) {
        if (resident_) {
            const Index3 place = ResidentBricks::brick_of(at);
            if (place != place_) brick_ = resident_->at(place_ = place);
            if (!brick_) return nullptr;
        }
        if (const Brick* edited = edited_ ? edited_->of_sample(at) : nullptr) {
            return in(*edited) + Bricks::place_of(at);
        }
        return brick_ ? in(*brick_) + ResidentBricks::place_of(at) : nullptr;
    }

  private:
    static const T* in(const Brick& brick) {
        return reinterpret_cast<const T*>(brick.samples.get());
    }

    const ResidentBricks* resident_;
    const Bricks* edited_;
    Index3 place_ = Index3::Constant(-1);
    const Brick* brick_ = nullptr;  // there
};

/// Whether two samples lie in one resident brick.
bool are_in_one(const Index3& a, const Index3& b) {
    return ((a[0] ^ b[0]) | (a[1] ^ b[1]) | (a[2] ^ b[2])) / ResidentBricks::edge == 0;
}

}  // namespace

template <int count>
Field::Rows Field::stored_rows(const Index3& low) const {
    const Index3 high(low[0] + count - 1, low[1] + count - 1, low[2] + count - 1);
    if (!has_sample(low) || !has_sample(high)) return {};
    const std::size_t bytes = size_of(type_);
    const auto in = [&](const Brick& brick, std::ptrdiff_t place, std::ptrdiff_t row) {
        return Rows{brick.samples.get() + static_cast<std::size_t>(place) * bytes, row, row * row,
                    false};
    };
    const Brick* const resident =
        resident_ && are_in_one(low, high) ? resident_->of_sample(low) : nullptr;
    if (resident_ && !resident) return {};
    if (bricks_) {
        const Brick* const first = bricks_->of_sample(low);
        const Index3 end = low - Bricks::edge * Bricks::brick_of(low) + Index3::Constant(count - 1);
        const bool in_one = end.maxCoeff() <= Bricks::edge;
        if (in_one && first) return in(*first, Bricks::place_of(low), Bricks::row);
        // Across bricks, samples of any edited one count.
        for (int i = 0; !in_one && i < 8; ++i) {
            const Index3 corner(i & 1 ? high[0] : low[0], i & 2 ? high[1] : low[1],
                                i & 4 ? high[2] : low[2]);
            if (bricks_->of_sample(corner)) return {};
        }
    }
    if (resident) return in(*resident, ResidentBricks::place_of(low), ResidentBricks::row);
    const std::ptrdiff_t place = low[0] + low[1] * row_ + low[2] * slice_;
    return {static_cast<const std::byte*>(data_) + static_cast<std::size_t>(place) * bytes, row_,
            slice_, true};
}

/// Label of a sample, from the labels that cover it.
std::uint8_t Field::label_at(const Index3& at) const noexcept {
    if (!has_sample(at)) return 0;
    const Field& labels = *cover_.labels;
    Index3 there = at;
    if (!cover_.same_grid) {
        const Vec3 index = cover_.turn * at.cast<double>() + cover_.shift;
        there = (index.array() + 0.5).floor().matrix().cast<int>();
    }
    if (!labels.has_sample(there)) return 0;
    return static_cast<const std::uint8_t*>(
        labels.data_)[there[0] + there[1] * labels.row_ + there[2] * labels.slice_];
}

/// Labels of a block of samples.
template <int count>
std::array<std::uint8_t, std::size_t{count} * count * count> Field::labels_of(
    const Index3& low) const noexcept {
    std::array<std::uint8_t, std::size_t{count} * count * count> labels;
    std::uint8_t* out = labels.data();
    const Rows rows = cover_.same_grid ? cover_.labels->stored_rows<count>(low) : Rows{};
    const auto* const label = static_cast<const std::uint8_t*>(rows.first);
    for (int z = 0; z < count; ++z) {
        for (int y = 0; y < count; ++y) {
            for (int x = 0; x < count; ++x) {
                *out++ = label ? label[x + y * rows.row + z * rows.slice]
                               : label_at(low + Index3(x, y, z));
            }
        }
    }
    return labels;
}

/// Whether a sample of a block has such a label.
template <int count>
bool Field::is_labelled(const Index3& low) const noexcept {
    std::uint8_t any = 0;
    for (const std::uint8_t label : labels_of<count>(low)) any |= label;
    return any != 0;
}

/// Updates what is derived from samples and time.
void Field::look() noexcept {
    moment_ = samples_->moment_at(time_);
    data_ = samples_->frames()[moment_.from].volume.data();
    resident_ = samples_->resident();
    bricks_ = samples_->bricks();
    type_ = samples_->type();
    const double outside = cover_.labels ? cover_.background : background_;
    const double low = std::min(samples_->minimum(), outside);
    const double high = std::max(samples_->maximum(), outside);
    range_ = high > low ? high - low : 1.0;
    // Samples far from zero (a float volume of 1e6 +- 1) lose digits in every sum of eight.
    double largest = std::max(std::abs(low), std::abs(high));
    const bool is_far = largest > most_ranges_from_zero * range_;
    offset_ = is_far ? (sign_ > 0 ? low : high) : 0;  // so inverted data gives the same bits
    if (is_far) largest = high - low;
    // Edited, interpolated or shifted samples take the slow path, so that plain ones have no extra
    // cost.
    const bool changing = bricks_ || moment_.weight > 0 || offset_ != 0 || resident_;
    plain_ = changing || cover_.labels ? Index3(Index3::Zero()) : cells_;
    tolerance_ = std::max(1e-12 * range_, 8 * std::numeric_limits<double>::epsilon() * largest);
    lowest_ = (low - offset_) - range_;
    highest_ = (high - offset_) + range_;
}

template <int count>
Field::Rows Field::rows_of(const Index3& low) const {
    if (offset_ != 0 || moment_.weight > 0) return {};
    if (cover_.labels && ((cover_.solid_labels & 1U) != 0 || is_labelled<count>(low))) return {};
    return stored_rows<count>(low);
}

template <int count>
std::array<double, std::size_t{count} * count * count> Field::gathered(const Index3& low) const {
    std::array<double, std::size_t{count} * count * count> samples;
    const auto gather = [&](const Index3& first, const Index3& end, auto&& sample) {
        for (int z = first[2]; z < end[2]; ++z) {
            for (int y = first[1]; y < end[1]; ++y) {
                double* const row = samples.data() + count * (y + count * z);
                for (int x = first[0]; x < end[0]; ++x) row[x] = sample(x, y, z);
            }
        }
    };
    with_type(type_, [&](auto zero) {
        using T = decltype(zero);
        const auto* const from = static_cast<const T*>(data_);
        const auto* const to = static_cast<const T*>(samples_->frames()[moment_.to].volume.data());
        const double weight = moment_.weight;
        const std::ptrdiff_t begin = low[0] + low[1] * row_ + low[2] * slice_;
        const auto in_frames = [&](int x, int y, int z) {
            const std::ptrdiff_t at = begin + x + y * row_ + z * slice_;
            if (!(weight > 0)) return double(from[at]) - offset_;
            return (1 - weight) * double(from[at]) + weight * double(to[at]) - offset_;
        };
        BrickReader<T> reader(resident_, bricks_);
        const auto in_bricks = [&](int x, int y, int z) {
            const T* const sample = reader.find({low[0] + x, low[1] + y, low[2] + z});
            if (sample) return double(*sample) - offset_;
            if (!resident_) return in_frames(x, y, z);
            return (sign_ > 0 ? samples_->maximum() : samples_->minimum()) - offset_;
        };
        const Index3 none = Index3::Zero(), all = Index3::Constant(count);
        const Rows rows = stored_rows<count>(low);
        if (rows.in_frame) {
            gather(none, all, in_frames);
        } else if (const auto* brick = static_cast<const T*>(rows.first)) {
            gather(none, all, [&](int x, int y, int z) {
                return double(brick[x + y * rows.row + z * rows.slice]) - offset_;
            });
        } else {  // across the border of the grid or of bricks
            samples.fill(background_ - offset_);
            const Index3 first = (-low).cwiseMax(none), end = (size_ - low).cwiseMin(all);
            if (bricks_ || resident_) {
                gather(first, end, in_bricks);
            } else {
                gather(first, end, in_frames);
            }
        }
    });
    if (!cover_.labels) return samples;
    const auto labels = labels_of<count>(low);
    for (std::size_t i = 0; i < labels.size(); ++i) {
        if (cover_.solid_labels >> labels[i] & 1U) {
            samples[i] = cover_.solid;
        } else if (labels[i] > 0) {
            samples[i] = cover_.open;
        }
    }
    return samples;
}
// Used by the header and by layers.
template Field::Rows Field::rows_of<3>(const Index3&) const;
template std::array<double, 27> Field::gathered<3>(const Index3&) const;
template std::array<std::uint8_t, 27> Field::labels_of<3>(const Index3&) const noexcept;
template bool Field::is_labelled<3>(const Index3&) const noexcept;

CellSamples Field::other_cell(const Index3& cell) const {
    const Rows rows = rows_of<2>(cell);
    if (!rows.first) return gathered<2>(cell);
    return with_type(type_, [&](auto zero) -> CellSamples {
        const auto* p = static_cast<const decltype(zero)*>(rows.first);
        const auto* q = p + rows.slice;
        return {double(p[0]), double(p[1]), double(p[rows.row]), double(p[rows.row + 1]),
                double(q[0]), double(q[1]), double(q[rows.row]), double(q[rows.row + 1])};
    });
}

Neighbours Field::around(const Index3& at) const {
    return visit_around(at, [](const auto* centre, std::ptrdiff_t row, std::ptrdiff_t slice) {
        Neighbours samples;
        double* out = samples.data();
        for_each_row(centre, row, slice, [&](const auto* first) {
            for (int x = 0; x < 3; ++x) *out++ = double(first[x]);
        });
        return samples;
    });
}

}  // namespace palpate
