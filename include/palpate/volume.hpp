// Stage 1, volume: samples on a regular grid and where that grid lies in space.
// Uses the standard library and Eigen only. Reading files is the task of io/.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "palpate/progress.hpp"

namespace palpate {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Index3 = Eigen::Vector3i;

/// How a sample is stored. Samples stay in this type for the life of the volume.
enum class SampleType : std::uint8_t { uint8, int16, uint16, float32 };

/// Bytes of one sample.
std::size_t size_of(SampleType type);
/// "uint8", "int16", "uint16" or "float32".
std::string_view name_of(SampleType type);
/// The inverse of name_of; throws std::invalid_argument with the accepted names.
SampleType sample_type_from(std::string_view name);

template <class T>
constexpr SampleType sample_type_of() {
    if constexpr (std::is_same_v<T, std::uint8_t>) return SampleType::uint8;
    if constexpr (std::is_same_v<T, std::int16_t>) return SampleType::int16;
    if constexpr (std::is_same_v<T, std::uint16_t>) return SampleType::uint16;
    if constexpr (std::is_same_v<T, float>) return SampleType::float32;
}

/// Calls `work` with a zero of the C++ type that `type` names, and returns its result. The result
/// must have one type for all: with_type(t, [&](auto zero) { return sizeof zero; }).
template <class Work>
constexpr decltype(auto) with_type(SampleType type, Work&& work) {
    switch (type) {
        case SampleType::uint8:
            return std::forward<Work>(work)(std::uint8_t{});
        case SampleType::int16:
            return std::forward<Work>(work)(std::int16_t{});
        case SampleType::uint16:
            return std::forward<Work>(work)(std::uint16_t{});
        case SampleType::float32:
            break;
    }
    return std::forward<Work>(work)(float{});
}

/// A box of samples, both corners in it; empty if `high` is below `low` on some axis.
struct SampleBox {
    Index3 low = Index3::Zero();
    Index3 high = Index3::Constant(-1);

    bool empty() const { return (high.array() < low.array()).any(); }
    bool operator==(const SampleBox&) const = default;
};
/// The smallest box around both; if one is empty, the other one.
SampleBox united(const SampleBox& a, const SampleBox& b);
/// Whether test(index) holds for an index of a box, x fastest. Stops at the first one.
template <class Test>
bool any_index(const SampleBox& box, Test&& test) {
    Index3 at;
    for (at[2] = box.low[2]; at[2] <= box.high[2]; ++at[2]) {
        for (at[1] = box.low[1]; at[1] <= box.high[1]; ++at[1]) {
            for (at[0] = box.low[0]; at[0] <= box.high[0]; ++at[0]) {
                if (test(std::as_const(at))) return true;
            }
        }
    }
    return false;
}
/// Calls visit(index) for each index of a box, x fastest.
template <class Visit>
void for_each_index(const SampleBox& box, Visit&& visit) {
    any_index(box, [&](const Index3& at) {
        visit(at);
        return false;
    });
}

/// The grid in physical space (LPS, millimetres).
/// Sample (i, j, k) lies at origin + direction * (spacing * (i, j, k)); points given in such
/// (possibly fractional) sample coordinates are in *index* space.
struct Geometry {
    Index3 size = Index3::Zero();       ///< samples along each axis; x runs fastest in memory
    Vec3 spacing = Vec3::Ones();        ///< [mm] between neighbouring samples, > 0
    Vec3 origin = Vec3::Zero();         ///< [mm] physical position of sample (0, 0, 0)
    Mat3 direction = Mat3::Identity();  ///< columns: unit vectors of the index axes, orthonormal
    bool oriented = true;  ///< the physical axes are those of the body (LPS), not assumed
    bool measured = true;  ///< the spacing is in millimetres, not assumed

    /// Compares the grids. `oriented` and `measured` do not count.
    bool operator==(const Geometry& other) const {
        return size == other.size && spacing == other.spacing && origin == other.origin &&
               direction == other.direction;
    }
};

/// All samples of a grid.
SampleBox whole_box(const Geometry& geometry);
/// Number of samples, as 64 bit.
std::int64_t sample_count(const Geometry& geometry);
/// Place of a sample among those of a grid of this size, x fastest.
inline std::ptrdiff_t sample_place(const Index3& at, const Index3& size) {
    return (std::ptrdiff_t{at[2]} * size[1] + at[1]) * size[0] + at[0];
}
/// index -> physical [mm].
Vec3 physical_from_index(const Geometry& geometry, const Vec3& index);
/// physical [mm] -> index. The direction is orthonormal, so its transpose is its inverse.
Vec3 index_from_physical(const Geometry& geometry, const Vec3& physical);
/// A displacement or force from physical axes to the grid's own axes (still mm or N), and back.
Vec3 grid_axes_from_physical(const Geometry& geometry, const Vec3& physical);
Vec3 physical_from_grid_axes(const Geometry& geometry, const Vec3& grid);
/// The centre of the grid [mm, physical].
Vec3 physical_centre(const Geometry& geometry);
/// Throws std::invalid_argument, with the reason, unless every size is >= 1, every spacing from
/// 1e-30 to 1e30 mm, the origin finite, and the direction orthonormal to 1e-4 (mirrored is
/// allowed).
void check(const Geometry& geometry);
/// The same with the nearest direction that is orthonormal to all digits, as volumes and samples
/// store it. With a direction of few digits, as in some files, a transform and its inverse would
/// not cancel, and a proxy could gain energy. A direction that is orthonormal to 1e-14 stays as it
/// is. The geometry has to pass check().
Geometry orthonormal(const Geometry& geometry);

/// Immutable samples with their geometry and range. A cheap value: copies share the samples.
class Volume {
  public:
    /// Takes ownership of `samples` (x fastest, then y, then z).
    /// Throws std::invalid_argument if the geometry is not valid, the count of samples is not the
    /// geometry's, or a float sample is not finite.
    template <class T>
    Volume(const Geometry& geometry, std::vector<T> samples);
    /// Adopts samples allocated elsewhere (a mapped file, shared memory); the deleter of `samples`
    /// releases them. `bytes` is checked against the geometry. `progress` is called with 1 while
    /// the range is found. Throws as above.
    Volume(const Geometry& geometry, SampleType type, std::shared_ptr<const void> samples,
           std::size_t bytes, const OnProgress& progress = {});

    const Geometry& geometry() const { return geometry_; }
    SampleType type() const { return type_; }
    /// Least and greatest sample, in the data's units.
    double minimum() const { return minimum_; }
    double maximum() const { return maximum_; }
    /// maximum - minimum, or 1 for a constant volume. Tolerances are relative to it.
    double range() const { return maximum_ > minimum_ ? maximum_ - minimum_ : 1.0; }
    /// The samples; T must be the stored type (std::invalid_argument otherwise).
    template <class T>
    std::span<const T> samples() const;
    const void* data() const { return samples_.get(); }
    std::size_t bytes() const;
    /// One sample as double; the index must be inside the grid.
    double sample(const Index3& index) const;

  private:
    Geometry geometry_;
    SampleType type_ = SampleType::uint8;
    std::shared_ptr<const void> samples_;
    double minimum_ = 0;
    double maximum_ = 0;
};

/// The volume smoothed with the binomial kernel (1 2 1)/4 along each axis, `passes` times, as
/// float32; samples beyond the border count as those on it. Gentle ramps stored in few bits have
/// steps, and a proxy is caught in them. One pass removes most steps (docs/results/fidelity.md),
/// but blurs structures thinner than about two voxels. 0 passes return the volume itself. Throws
/// std::invalid_argument for fewer than 0 or more than 64.
Volume smoothed(const Volume& volume, int passes = 1, const OnProgress& progress = {});

/// s - (discrete Laplacian of s) / 8, as float32; samples beyond the border count as those on it.
/// The smooth field of these samples is nearer to the original value at each sample: thin
/// structures keep their height, and curved surfaces their place. Noise is sharpened as well.
/// Samples may leave the data's range by up to 0.75 of it.
Volume sharpened(const Volume& volume, const OnProgress& progress = {});

}  // namespace palpate
