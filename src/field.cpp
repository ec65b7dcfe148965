// Field: reads the eight samples of any cell: background outside the grid, and inside it edited
// samples, those between two frames, and bricks of a large grid.
#include "palpate/field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "palpate/names.hpp"

namespace palpate {
namespace {

/// Data at most this many times their range from zero are felt as they are: there the tolerance is
/// 9.3e-10 of the range, just within what G1 and G2 grant. From others an offset is taken.
constexpr double most_ranges_from_zero = 1 << 19;

/// The eight corners of a cell in samples of type T; `at` is its lowest one.
template <class T>
CellSamples corners(const void* data, std::ptrdiff_t at, std::ptrdiff_t row, std::ptrdiff_t slice) {
    const T* p = static_cast<const T*>(data) + at;
    const T* q = p + slice;
    return {double(p[0]), double(p[1]), double(p[row]), double(p[row + 1]),
            double(q[0]), double(q[1]), double(q[row]), double(q[row + 1])};
}

CellSamples corners(SampleType type, const void* data, std::ptrdiff_t at, std::ptrdiff_t row,
                    std::ptrdiff_t slice) {
    return with_type(type,
                     [&](auto zero) { return corners<decltype(zero)>(data, at, row, slice); });
}

}  // namespace

std::string_view name_of(Interpolation interpolation) {
    return interpolation == Interpolation::cubic ? "cubic" : "linear";
}

Interpolation interpolation_from(std::string_view name) {
    for (const Interpolation known : {Interpolation::linear, Interpolation::cubic}) {
        if (name == name_of(known)) return known;
    }
    const std::string names[] = {"linear", "cubic"};
    throw std::invalid_argument("there is no field '" + std::string(name) +
                                "': " + use_one_of(names, name));
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

int Field::covering_label(const Index3& at) const noexcept {
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

bool Field::is_covered_around(const Index3& at) const noexcept {
    unsigned any = 0;
    if (cover_.same_grid && is_inner(at)) {
        const auto* label = static_cast<const std::uint8_t*>(cover_.labels->data_) +
                            (at[0] + at[1] * row_ + at[2] * slice_);
        for (const std::ptrdiff_t z : {-slice_, std::ptrdiff_t{0}, slice_}) {
            for (const std::ptrdiff_t y : {z - row_, z, z + row_}) {
                for (int x = -1; x <= 1; ++x) any |= label[y + x];
            }
        }
        return any != 0;
    }
    for (int i = 0; i < 27 && any == 0; ++i) {
        any = unsigned(covering_label(at + Index3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)));
    }
    return any != 0;
}

/// Turns a block of samples, less offset(), into what they count as under the labels.
template <std::size_t count>
void Field::cover_samples(const Index3& low,
                          std::array<double, count * count * count>& samples) const {
    constexpr int side = static_cast<int>(count);
    double* sample = samples.data();
    for (int z = low[2]; z < low[2] + side; ++z) {
        for (int y = low[1]; y < low[1] + side; ++y) {
            for (int x = low[0]; x < low[0] + side; ++x, ++sample) {
                *sample = covered(covering_label({x, y, z}), *sample);
            }
        }
    }
}

/// A block where samples and labels lie as they were read, on one grid.
template <std::size_t count>
std::array<double, count * count * count> Field::plain_covered(const Index3& low) const {
    return with_type(type_, [&](auto zero) {
        const std::ptrdiff_t begin = low[0] + low[1] * row_ + low[2] * slice_;
        const auto* sample = static_cast<const decltype(zero)*>(data_) + begin;
        const auto* label = static_cast<const std::uint8_t*>(cover_.labels->data_) + begin;
        std::array<double, count * count * count> samples;
        double* out = samples.data();
        for (std::size_t z = 0; z < count; ++z, sample += slice_, label += slice_) {
            for (std::size_t y = 0; y < count; ++y) {
                const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(y) * row_;
                for (std::size_t x = 0; x < count; ++x) {
                    *out++ = covered(label[row + std::ptrdiff_t(x)],
                                     double(sample[row + std::ptrdiff_t(x)]));
                }
            }
        }
        return samples;
    });
}

/// Updates what is derived from samples and time.
void Field::look() noexcept {
    moment_ = samples_->moment_at(time_);
    data_ = samples_->frames()[moment_.from].volume.data();
    resident_ = samples_->resident();
    resident_ball_ = {};
    bricks_ = samples_->bricks();
    type_ = samples_->type();
    const double outside = cover_.labels ? cover_.background : background_;
    const double low = std::min(samples_->minimum(), outside);
    const double high = std::max(samples_->maximum(), outside);
    range_ = high > low ? high - low : 1.0;
    // Samples far from zero (a float volume of 1e6 +- 1) lose digits in every sum of eight.
    double largest = std::max(std::abs(low), std::abs(high));
    offset_ = largest > most_ranges_from_zero * range_ ? low : 0;
    if (offset_ != 0) largest = high - low;
    // Edited, interpolated or shifted samples take the slow path, so that plain ones have no extra
    // cost.
    const bool changing = bricks_ || moment_.weight > 0 || offset_ != 0 || resident_;
    const Index3 none = Index3::Zero();
    plain_ = changing || cover_.labels ? none : cells_;
    cover_.plain = changing || !cover_.labels || !cover_.same_grid ? none : cells_;
    tolerance_ = std::max(1e-12 * range_, 8 * std::numeric_limits<double>::epsilon() * largest);
    lowest_ = (low - offset_) - range_;
    highest_ = (high - offset_) + range_;
    reads_bricks_ = resident_ && offset_ == 0 && !cover_.labels;
}

/// As stored_cell(), which costs more calls.
template <class T>
CellSamples Field::resident_cell(const Index3& cell) const {
    const auto inside = [&](int a) {
        return static_cast<unsigned>(cell[a]) < static_cast<unsigned>(cells_[a]);
    };
    if (inside(0) && inside(1) && inside(2) && !(bricks_ && bricks_->of_cell(cell))) {
        if (const ResidentBrick* brick = resident_->of_sample(cell)) {
            return corners<T>(brick->samples.get(), ResidentBricks::place_of(cell),
                              ResidentBricks::row, ResidentBricks::slice);
        }
    }
    return other_cell(cell);
}
template CellSamples Field::resident_cell<std::uint8_t>(const Index3&) const;
template CellSamples Field::resident_cell<std::int16_t>(const Index3&) const;
template CellSamples Field::resident_cell<std::uint16_t>(const Index3&) const;
template CellSamples Field::resident_cell<float>(const Index3&) const;

CellSamples Field::other_cell(const Index3& cell) const {
    const auto is_plain = [&](int a) {
        return static_cast<unsigned>(cell[a]) < static_cast<unsigned>(cover_.plain[a]);
    };
    if (is_plain(0) && is_plain(1) && is_plain(2)) return plain_covered<2>(cell);
    CellSamples samples = uncovered_cell(cell);
    if (cover_.labels) cover_samples<2>(cell, samples);
    return samples;
}

CellSamples Field::uncovered_cell(const Index3& cell) const {
    CellSamples samples = absolute_cell(cell);
    if (offset_ != 0) {
        for (double& sample : samples) sample -= offset_;
    }
    return samples;
}

Neighbours Field::around(const Index3& at) const {
    return visit_around(at, [](const auto* centre, std::ptrdiff_t row, std::ptrdiff_t slice) {
        Neighbours samples;
        double* out = samples.data();
        for (const std::ptrdiff_t z : {-slice, std::ptrdiff_t{0}, slice}) {
            for (const std::ptrdiff_t y : {z - row, z, z + row}) {
                for (int x = -1; x <= 1; ++x) *out++ = double(centre[y + x]);
            }
        }
        return samples;
    });
}

/// A block of samples that lie as they were read, at the border; not less offset().
template <class T, std::size_t count>
std::array<double, count * count * count> Field::clipped(const Index3& low) const {
    constexpr int side = static_cast<int>(count);
    const auto in_grid = [&](int axis, int place) { return place >= 0 && place < size_[axis]; };
    std::array<bool, count> has_column{};
    bool has_any = false;
    for (int x = 0; x < side; ++x) has_any |= has_column[x] = in_grid(0, low[0] + x);
    std::array<double, count * count * count> samples;
    double* out = samples.data();
    for (int z = low[2]; z < low[2] + side; ++z) {
        for (int y = low[1]; y < low[1] + side; ++y) {
            const bool has_row = has_any && in_grid(2, z) && in_grid(1, y);
            const T* row = static_cast<const T*>(data_);
            if (has_row) row += low[0] + y * row_ + z * slice_;
            for (int x = 0; x < side; ++x) {
                *out++ = has_row && has_column[x] ? double(row[x]) : background_;
            }
        }
    }
    return samples;
}

Neighbours Field::other_around(const Index3& at) const {
    const auto is_plain = [&](int a) { return at[a] > 0 && at[a] < cover_.plain[a]; };
    const Index3 low = at - Index3::Ones();
    if (is_plain(0) && is_plain(1) && is_plain(2)) return plain_covered<3>(low);
    Neighbours samples = uncovered_around(at);
    if (cover_.labels) cover_samples<3>(low, samples);
    return samples;
}

Neighbours Field::uncovered_around(const Index3& at) const {
    Neighbours samples;
    if (resident_ && has_sample(at) && !resident_->of_sample(at)) {
        samples.fill(most_solid() - offset_);
        return samples;
    }
    if (lies_as_read() && !is_inner(at)) {
        samples = with_type(
            type_, [&](auto zero) { return clipped<decltype(zero), 3>(at - Index3::Ones()); });
        if (offset_ != 0) {
            for (double& sample : samples) sample -= offset_;
        }
        return samples;
    }
    if (resident_ || !is_inner(at)) {
        for (int i = 0; i < 27; ++i) {
            const Index3 next = at + Index3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
            samples[std::size_t(i)] = sample_at(next) - offset_;
        }
        return samples;
    }
    // By the eight cells that meet at the sample: they know bricks, moments and the background.
    for (unsigned octant = 0; octant < 8; ++octant) {
        const Index3 side(octant & 1, octant >> 1 & 1, octant >> 2 & 1);
        const CellSamples cell = uncovered_cell(at - Index3::Ones() + side);
        for (unsigned corner = 0; corner < 8; ++corner) {
            const int x = side[0] + static_cast<int>(corner & 1);
            const int y = side[1] + static_cast<int>(corner >> 1 & 1);
            const int z = side[2] + static_cast<int>(corner >> 2 & 1);
            samples[x + 3 * y + 9 * z] = cell[corner];
        }
    }
    return samples;
}

CellSamples Field::absolute_cell(const Index3& cell) const {
    const bool inside = (cell.array() >= 0).all() && (cell.array() < cells_.array()).all();
    if (!inside && lies_as_read()) {
        return with_type(type_, [&](auto zero) { return clipped<decltype(zero), 2>(cell); });
    }
    if (!inside) {
        CellSamples samples;
        for (int corner = 0; corner < 8; ++corner) {
            samples[corner] =
                sample_at(cell + Index3(corner & 1, corner >> 1 & 1, corner >> 2 & 1));
        }
        return samples;
    }
    return stored_cell(cell);
}

/// True if a cell that meets at a sample inside the grid lies in an edited brick.
bool Field::is_edited_around(const Index3& at) const {
    const Index3 low = at - Index3::Ones();
    if (((low.array() / Bricks::cells) == (at.array() / Bricks::cells)).all()) {
        return bricks_->of_cell(at);
    }
    bool edited = false;
    for (int side = 0; side < 8; ++side) {
        const Index3 cell(low[0] + (side & 1), low[1] + (side >> 1 & 1), low[2] + (side >> 2));
        edited = edited || bricks_->of_cell(cell);
    }
    return edited;
}

/// What samples that are not in memory count as [data units].
double Field::most_solid() const {
    return sign_ > 0 ? samples_->maximum() : samples_->minimum();
}

/// One sample anywhere in space [data units].
double Field::sample_at(const Index3& at) const {
    if (!has_sample(at)) return background_;
    if (resident_ && !resident_->of_sample(at)) return most_solid();
    return samples_->sample(at, moment_);
}

/// Of a cell inside the grid, as they are stored.
CellSamples Field::stored_cell(const Index3& cell) const {
    const ResidentBrick* resident = resident_ ? resident_->of_sample(cell) : nullptr;
    if (resident_ && !resident) {
        CellSamples samples;
        samples.fill(most_solid());
        return samples;
    }
    if (bricks_) {
        if (const std::byte* brick = bricks_->of_cell(cell)) {
            constexpr std::ptrdiff_t row = Bricks::samples, slice = row * Bricks::samples;
            const auto at = (cell[0] & 15) + (cell[1] & 15) * row + (cell[2] & 15) * slice;
            return corners(type_, brick, at, row, slice);
        }
    }
    if (resident) {
        return corners(type_, resident->samples.get(), ResidentBricks::place_of(cell),
                       ResidentBricks::row, ResidentBricks::slice);
    }
    const std::ptrdiff_t at = cell[0] + cell[1] * row_ + cell[2] * slice_;
    CellSamples samples = corners(type_, data_, at, row_, slice_);
    if (moment_.weight > 0) {
        const void* next = samples_->frames()[moment_.to].volume.data();
        const CellSamples later = corners(type_, next, at, row_, slice_);
        for (int i = 0; i < 8; ++i) {
            samples[i] = (1 - moment_.weight) * samples[i] + moment_.weight * later[i];
        }
    }
    return samples;
}

}  // namespace palpate
