// Stage 3, field: gives a density at every point of space, and tells which side of a level is
// solid. All later stages read samples through Field::cell(), eight at a time, or Field::around(),
// 27 at a time. They do not depend on how samples are stored, edited or interpolated between two
// frames.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include "palpate/samples.hpp"

namespace palpate {

/// Which side of the isovalue is solid: above for bright bodies, below for dark ones such as
/// airways.
enum class Solid : std::uint8_t { above, below };

/// Interpolation between samples: `linear` in each tetrahedron of the lattice, which has the exact
/// samples and facets (Corenthy et al. 2012), or `cubic`, whose gradient is continuous
/// (docs/smooth.md). `cubic` is the default wherever there is a choice.
enum class Interpolation : std::uint8_t { linear, cubic };
/// "linear" or "cubic".
std::string_view name_of(Interpolation interpolation);
/// The inverse of name_of; throws std::invalid_argument with the accepted names.
Interpolation interpolation_from(std::string_view name);

/// The eight samples at the corners of a cell, in the data's units, less the field's offset.
/// Corner c has x offset (c & 1), y offset (c >> 1 & 1), z offset (c >> 2 & 1).
using CellSamples = std::array<double, 8>;
/// A sample and its 26 neighbours, in the data's units, less the field's offset. The neighbour at
/// (x, y, z), each -1, 0 or 1, has place 13 + x + 3 y + 9 z.
using Neighbours = std::array<double, 27>;

/// The samples at one moment and their solid side, for the hand to touch. A small value; copies
/// share the samples.
class Field {
  public:
    /// `background` is the density outside the grid. Its default is the data's minimum, or the
    /// maximum where `solid` is below, so that bodies cut off by the border are closed there.
    /// Throws std::invalid_argument for a background that is not finite or beyond float32's range.
    explicit Field(Volume volume, Solid solid = Solid::above,
                   std::optional<double> background = std::nullopt,
                   Interpolation interpolation = Interpolation::cubic);
    /// The same for changing data; a sequence begins at its first moment. Not null.
    explicit Field(std::shared_ptr<const Samples> samples, Solid solid = Solid::above,
                   std::optional<double> background = std::nullopt,
                   Interpolation interpolation = Interpolation::cubic);

    /// Changes to another version of the samples, on the same grid, not null. Background, solid
    /// side and time stay. Neither allocates, locks nor throws. Frees the previous version only if
    /// it is held nowhere else.
    void use(const std::shared_ptr<const Samples>& samples) noexcept;
    /// Goes to a time of a sequence [s], see Samples::moment_at().
    void set_time(double time) noexcept;
    /// Interpolates the same samples in another way from now on.
    void set_interpolation(Interpolation to) noexcept { interpolation_ = to; }

    const Samples& samples() const { return *samples_; }
    const std::shared_ptr<const Samples>& shared_samples() const { return samples_; }
    double time() const { return time_; }
    const Moment& moment() const { return moment_; }
    /// The volume before all edits; of a sequence its first frame, of a large grid its overview.
    const Volume& volume() const { return samples_->volume(); }
    const Geometry& geometry() const { return samples_->geometry(); }
    Solid solid() const { return solid_; }
    Interpolation interpolation() const { return interpolation_; }
    double background() const { return background_; }
    /// +1 for above, -1 for below: sign * (density - isovalue) > 0 is solid.
    double sign() const { return sign_; }
    /// max - min of samples and background [data units], never 0. Tolerances are relative to it.
    double range() const { return range_; }

    /// How far sign * (f - isovalue) may exceed 0 by rounding before a point counts as solid [data
    /// units]: a thousandth of the tolerance of G1 and G2 (proxy.hpp).
    double tolerance() const { return tolerance_; }
    /// cell() subtracts this from every sample [data units]. It is 0, unless the data is so far
    /// from zero that doubles have too few digits left for its range (docs/proxy.md, "Domain").
    double offset() const { return offset_; }
    /// A density computed from cell(), offset included.
    double with_offset(double density) const { return offset_ == 0 ? density : density + offset_; }
    /// A level [data units], minus offset(), limited to a range around the data, as a proxy uses
    /// it. A level far beyond the data has the same effect as one just beyond it, but differences
    /// between such levels would lose digits.
    double within_reach(double level) const { return std::clamp(level, lowest_, highest_); }
    /// 1 / spacing [voxel/mm].
    const Vec3& voxels_per_mm() const { return voxels_per_mm_; }

    /// The samples of the cell whose lowest corner is `cell` (index space), minus offset(); any
    /// cell in space. Samples that are not in memory count as solid; no proxy meets them
    /// (docs/streaming.md).
    CellSamples cell(const Index3& cell) const {
        return with_type(type_, [&](auto zero) { return cell_of<decltype(zero)>(cell); });
    }
    /// The sample `at` (index space) with its neighbours, less offset(); any sample in space.
    Neighbours around(const Index3& at) const;
    /// The same samples in place: returns visit(centre, row, slice). `centre` points to the sample.
    /// Its neighbours in x are next to it, those in y are `row` away, and those in z `slice`.
    /// Samples that do not lie like that (at the border, edited, between frames) are first
    /// gathered, as doubles.
    template <class Visit>
    auto visit_around(const Index3& at, Visit&& visit) const {
        Gathered gathered;
        return visit_around(at, visit, gathered);
    }
    /// Samples that can be read directly from one array: the address of the first one, and the
    /// distances of neighbours in y and z. Null: they cannot.
    struct Rows {
        const void* first = nullptr;
        std::ptrdiff_t row = 0, slice = 0;
        bool in_frame = false;  ///< of the moment, not in a brick
    };
    /// For a caller that reads one place several times, so that its samples are found only once.
    struct Gathered {
        bool done = false;  ///< the caller resets it for another place
        int work = 0;       ///< of the slow reads so far (ProxySettings::step_budget)
        Rows rows;          ///< their place in memory. Null: they were gathered into `samples`
        Neighbours samples;
    };
    template <class Visit>
    auto visit_around(const Index3& at, Visit&& visit, Gathered& gathered) const;
    /// The most that this adds to Gathered::work.
    int work_of_samples() const { return cover_.same_grid ? 1 : 3; }
    /// True where all eight samples of `cell` are background.
    bool is_background(const Index3& cell) const {
        // One unsigned comparison an axis covers both ends, here and in cell_of().
        const auto beyond = [&](int a) {
            return static_cast<unsigned>(cell[a] + 1) > static_cast<unsigned>(size_[a]);
        };
        return beyond(0) || beyond(1) || beyond(2);
    }
    /// True where the sample `at` and all its neighbours are background.
    bool is_background_around(const Index3& at) const {
        const auto beyond = [&](int a) {
            return static_cast<unsigned>(at[a] + 1) > static_cast<unsigned>(size_[a] + 1);
        };
        return beyond(0) || beyond(1) || beyond(2);
    }

  private:
    friend struct LabelCover;

    template <class T>
    CellSamples cell_of(const Index3& cell) const;
    /// The stored samples of a block of count^3 samples, 2 or 3 along each axis. Null if the field
    /// has other values there, for example edited ones.
    template <int count>
    Rows stored_rows(const Index3& low) const;
    template <int count>
    Rows rows_of(const Index3& low) const;
    template <int count>
    std::array<double, std::size_t{count} * count * count> gathered(const Index3& low) const;
    CellSamples other_cell(const Index3& cell) const;
    bool has_sample(const Index3& at) const {
        const auto inside = [&](int a) {
            return static_cast<unsigned>(at[a]) < static_cast<unsigned>(size_[a]);
        };
        return inside(0) && inside(1) && inside(2);
    }
    void cover(const std::shared_ptr<const Field>& labels, std::uint32_t solid_labels, double open,
               double solid) noexcept;
    std::uint8_t label_at(const Index3& at) const noexcept;
    template <int count>
    std::array<std::uint8_t, std::size_t{count} * count * count> labels_of(
        const Index3& low) const noexcept;
    template <int count>
    bool is_labelled(const Index3& low) const noexcept;
    void look() noexcept;

    std::shared_ptr<const Samples> samples_;
    double time_ = 0;
    Moment moment_;
    const void* data_ = nullptr;  // of the frame before the moment
    const ResidentBricks* resident_ = nullptr;
    const Bricks* bricks_ = nullptr;
    std::ptrdiff_t row_ = 0;    // samples between neighbours in y
    std::ptrdiff_t slice_ = 0;  // samples between neighbours in z
    double background_ = 0;
    double range_ = 1;
    double tolerance_ = 0;
    double offset_ = 0;
    double lowest_ = 0, highest_ = 0;  // levels that a proxy uses
    Vec3 voxels_per_mm_;
    double sign_ = 1;
    Index3 size_, cells_;  // samples, and cells between them
    Index3 plain_;  // cells along each axis whose samples at data_ are those of the field; 0 if
                    // they change
    SampleType type_ = SampleType::uint8;
    Solid solid_ = Solid::above;
    Interpolation interpolation_ = Interpolation::cubic;

    /// Labels over the samples.
    struct Cover {
        std::shared_ptr<const Field> labels;  // null: none
        std::uint32_t solid_labels = 0;
        double open = 0, solid = 0;  // [data units] less the field's offset
        double background = 0;       // where samples without a label are not solid
        bool same_grid = true;
        Mat3 turn = Mat3::Identity();  // index of a label = turn * index of a sample + shift
        Vec3 shift = Vec3::Zero();
    };
    Cover cover_;
};

template <class T>
inline CellSamples Field::cell_of(const Index3& cell) const {
    // One unsigned comparison an axis covers both ends of the grid.
    const bool plain = static_cast<unsigned>(cell[0]) < static_cast<unsigned>(plain_[0]) &&
                       static_cast<unsigned>(cell[1]) < static_cast<unsigned>(plain_[1]) &&
                       static_cast<unsigned>(cell[2]) < static_cast<unsigned>(plain_[2]);
    if (!plain) return other_cell(cell);
    const T* p = static_cast<const T*>(data_) + (cell[0] + cell[1] * row_ + cell[2] * slice_);
    const T* q = p + slice_;
    return {double(p[0]), double(p[1]), double(p[row_]), double(p[row_ + 1]),
            double(q[0]), double(q[1]), double(q[row_]), double(q[row_ + 1])};
}

/// Calls visit(first) for each row of three of the 27 samples that Field::visit_around() shows.
template <class T, class Visit>
inline void for_each_row(const T* centre, std::ptrdiff_t row, std::ptrdiff_t slice, Visit&& visit) {
    // Written out: loops over so little would take as much time as the rest.
    const T* const first = centre - 1;
    visit(first - slice - row);
    visit(first - slice);
    visit(first - slice + row);
    visit(first - row);
    visit(first);
    visit(first + row);
    visit(first + slice - row);
    visit(first + slice);
    visit(first + slice + row);
}

template <class Visit>
inline auto Field::visit_around(const Index3& at, Visit&& visit, Gathered& kept) const {
    // The lowest and the highest of the eight cells that meet at the sample.
    const auto is_plain = [&](int a) { return at[a] > 0 && at[a] < plain_[a]; };
    if (is_plain(0) && is_plain(1) && is_plain(2)) {
        const std::ptrdiff_t offset = at[0] + at[1] * row_ + at[2] * slice_;
        return with_type(type_, [&](auto zero) {
            return visit(static_cast<const decltype(zero)*>(data_) + offset, row_, slice_);
        });
    }
    if (!kept.done) {
        const Index3 low(at[0] - 1, at[1] - 1, at[2] - 1);
        kept.done = true;
        kept.work += work_of_samples();
        kept.rows = rows_of<3>(low);
        if (!kept.rows.first) kept.samples = gathered<3>(low);
    }
    if (const Rows& rows = kept.rows; rows.first) {
        return with_type(type_, [&](auto zero) {
            const auto* first = static_cast<const decltype(zero)*>(rows.first);
            return visit(first + 1 + rows.row + rows.slice, rows.row, rows.slice);
        });
    }
    return visit(static_cast<const double*>(kept.samples.data()) + 13, std::ptrdiff_t{3},
                 std::ptrdiff_t{9});
}

/// A field of a volume or of shared samples as in the paper, Interpolation::linear. The other
/// arguments are those of Field.
template <class Data>
Field linear_field(Data&& data, Solid solid = Solid::above,
                   std::optional<double> background = std::nullopt) {
    return Field(std::forward<Data>(data), solid, background, Interpolation::linear);
}

/// Density at a physical point [mm], with the field's interpolation; the background outside the
/// grid. The point must be finite. For observers: the proxy has faster ways.
double value_at(const Field& field, const Vec3& physical);
/// Gradient there, in physical axes [data units / mm].
Vec3 gradient_at(const Field& field, const Vec3& physical);
/// True if all samples within `radius` [mm] of a point [mm, physical], and those that the field
/// needs between them, are in memory.
bool is_resident(const Field& field, const Vec3& centre, double radius) noexcept;
/// The coarsest level of detail of the samples around a point [mm, physical]: 0 is the grid's own.
int level_at(const Field& field, const Vec3& physical) noexcept;

}  // namespace palpate
