// Volume: geometry of a sampled grid, its samples and their range.
#include "palpate/volume.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "palpate/names.hpp"

namespace palpate {
namespace {

struct Range {
    double minimum, maximum;
};

/// Least and greatest of the samples, and 0, or NaN if one is not finite. For several samples at
/// the same time, because compilers do not reorder comparisons of floats.
template <class T>
struct RunningRange {
    static constexpr std::size_t lanes = 64 / sizeof(T);
    std::array<T, lanes> low, high, nought{};

    RunningRange() {
        low.fill(std::numeric_limits<T>::max());
        high.fill(std::numeric_limits<T>::lowest());
    }
    void add(const T* samples, std::size_t count) {
        for (std::size_t i = 0; i < count; ++i) {
            const T s = samples[i];
            low[i] = s < low[i] ? s : low[i];
            high[i] = s > high[i] ? s : high[i];
            if constexpr (std::is_floating_point_v<T>) nought[i] += T{} * s;
        }
    }
};

template <class T>
Range range_of(std::span<const T> samples, const OnProgress& progress) {
    constexpr std::size_t between = std::size_t{1} << 20;
    RunningRange<T> range;
    for (std::size_t at = 0; at < samples.size(); at += between) {
        const auto some = samples.subspan(at, std::min(between, samples.size() - at));
        std::size_t i = 0;
        for (; i + range.lanes <= some.size(); i += range.lanes) range.add(&some[i], range.lanes);
        range.add(some.data() + i, some.size() - i);
        if (progress) progress(1);
    }
    const T low = *std::min_element(range.low.begin(), range.low.end());
    const T high = *std::max_element(range.high.begin(), range.high.end());
    const bool finite = std::ranges::all_of(range.nought, [](T n) { return n == 0; });
    if (!finite) {
        throw std::invalid_argument(
            "some samples are not finite (NaN or infinity): replace them, for example by the "
            "background value");
    }
    return {static_cast<double>(low), static_cast<double>(high)};
}

template <class T>
std::span<const T> span_of(const void* data, const Geometry& geometry) {
    return {static_cast<const T*>(data), static_cast<std::size_t>(sample_count(geometry))};
}

}  // namespace

std::size_t size_of(SampleType type) {
    return with_type(type, [](auto s) { return sizeof s; });
}

std::string_view name_of(SampleType type) {
    return enum_name(type);
}

SampleType sample_type_from(std::string_view name) {
    return named<SampleType>(name);
}

SampleBox united(const SampleBox& a, const SampleBox& b) {
    if (a.empty()) return b;
    if (b.empty()) return a;
    return {a.low.cwiseMin(b.low), a.high.cwiseMax(b.high)};
}

SampleBox whole_box(const Geometry& geometry) {
    return {Index3::Zero(), geometry.size - Index3::Ones()};
}

std::int64_t sample_count(const Geometry& geometry) {
    return geometry.size.cast<std::int64_t>().prod();
}

Vec3 physical_from_index(const Geometry& g, const Vec3& index) {
    return g.origin + g.direction * g.spacing.cwiseProduct(index);
}

Vec3 index_from_physical(const Geometry& g, const Vec3& physical) {
    return (g.direction.transpose() * (physical - g.origin)).cwiseQuotient(g.spacing);
}

Vec3 grid_axes_from_physical(const Geometry& g, const Vec3& physical) {
    return g.direction.transpose() * physical;
}

Vec3 physical_from_grid_axes(const Geometry& g, const Vec3& grid) {
    return g.direction * grid;
}

Vec3 physical_centre(const Geometry& g) {
    return physical_from_index(g, 0.5 * (g.size.cast<double>() - Vec3::Ones()));
}

void check(const Geometry& g) {
    if ((g.size.array() < 1).any()) {
        throw std::invalid_argument("every size must be at least 1 sample");
    }
    if ((g.size.array() > 1 << 20).any()) {
        throw std::invalid_argument("more than 1048576 samples along one axis");
    }
    // So that products of a few lengths keep their digits.
    if (!(g.spacing.array() >= 1e-30).all() || !(g.spacing.array() <= 1e30).all()) {
        throw std::invalid_argument("every spacing must be a number from 1e-30 to 1e30 mm");
    }
    if (!g.origin.allFinite()) throw std::invalid_argument("the origin is not finite");
    const Mat3 should_be_identity = g.direction.transpose() * g.direction;
    if (!g.direction.allFinite() ||
        !((should_be_identity - Mat3::Identity()).cwiseAbs().array() < 1e-4).all()) {
        throw std::invalid_argument(
            "the direction cosines are not orthonormal (a sheared or degenerate grid): resample "
            "the volume on a rectangular grid");
    }
}

Geometry orthonormal(const Geometry& geometry) {
    Geometry result = geometry;
    Mat3& d = result.direction;
    // Each step squares the error, which is at most 1e-4 at first.
    for (int i = 0; i < 4; ++i) {
        const Mat3 error = d.transpose() * d - Mat3::Identity();
        if (error.cwiseAbs().maxCoeff() <= 1e-14) break;
        d -= Mat3(0.5 * d * error);
    }
    return result;
}

template <class T>
Volume::Volume(const Geometry& geometry, std::vector<T> samples) {
    const std::size_t bytes = samples.size() * sizeof(T);
    auto owner = std::make_shared<const std::vector<T>>(std::move(samples));
    *this = Volume(geometry, sample_type_of<T>(), std::shared_ptr<const void>(owner, owner->data()),
                   bytes);
}
template Volume::Volume(const Geometry&, std::vector<std::uint8_t>);
template Volume::Volume(const Geometry&, std::vector<std::int16_t>);
template Volume::Volume(const Geometry&, std::vector<std::uint16_t>);
template Volume::Volume(const Geometry&, std::vector<float>);

Volume::Volume(const Geometry& geometry, SampleType type, std::shared_ptr<const void> samples,
               std::size_t bytes, const OnProgress& progress)
    : geometry_(geometry), type_(type), samples_(std::move(samples)) {
    check(geometry);
    geometry_ = orthonormal(geometry);
    if (this->bytes() != bytes) {
        throw std::invalid_argument("the geometry asks for " + std::to_string(this->bytes()) +
                                    " bytes of samples, there are " + std::to_string(bytes));
    }
    const Range range = with_type(type, [&](auto s) {
        return range_of(span_of<decltype(s)>(samples_.get(), geometry_), progress);
    });
    minimum_ = range.minimum;
    maximum_ = range.maximum;
}

std::size_t Volume::bytes() const {
    return static_cast<std::size_t>(sample_count(geometry_)) * size_of(type_);
}

template <class T>
std::span<const T> Volume::samples() const {
    if (sample_type_of<T>() != type_) {
        throw std::invalid_argument("the samples are stored as " + std::string(name_of(type_)));
    }
    return span_of<T>(samples_.get(), geometry_);
}
template std::span<const std::uint8_t> Volume::samples() const;
template std::span<const std::int16_t> Volume::samples() const;
template std::span<const std::uint16_t> Volume::samples() const;
template std::span<const float> Volume::samples() const;

double Volume::sample(const Index3& i) const {
    return with_type(type_, [&](auto s) {
        const auto* const samples = static_cast<const decltype(s)*>(samples_.get());
        return static_cast<double>(samples[sample_place(i, geometry_.size)]);
    });
}

namespace {

/// Samples between two reports of progress: milliseconds.
constexpr std::size_t reported_samples = std::size_t{1} << 18;

/// Room for the samples of a volume, of which none is written yet.
std::shared_ptr<float[]> room_for(const Geometry& geometry) {
    return std::shared_ptr<float[]>(new float[static_cast<std::size_t>(sample_count(geometry))]);
}

/// (1 2 1)/4 along one axis, in place. Many runs of the axes below at a time: `run` neighbours in
/// memory are neighbours across the axis, and `count` such runs follow each other along it.
void smooth_along(std::span<float> samples, std::size_t run, std::size_t count,
                  ReportedItems& reported) {
    const std::size_t most = std::min(run, std::size_t{4096});  // they stay in the cache
    std::vector<float> before(most), here(most);
    for (std::size_t from = 0; from < samples.size();) {
        const std::size_t width = std::min(most, run - from % run);
        float* at = samples.data() + from;
        std::copy_n(at, width, before.begin());
        for (std::size_t k = 0; k < count; ++k, at += run) {
            const float* after = k + 1 < count ? at + run : at;
            std::copy_n(at, width, here.begin());
            for (std::size_t i = 0; i < width; ++i) {
                at[i] = 0.25F * before[i] + 0.5F * here[i] + 0.25F * after[i];
            }
            std::swap(before, here);
            reported.done(width);
        }
        from += width;
        if (from % run == 0) from += run * (count - 1);
    }
}

}  // namespace

Volume smoothed(const Volume& volume, int passes, const OnProgress& progress) {
    if (passes < 0 || passes > 64) {
        throw std::invalid_argument("a volume is smoothed 0 to 64 times, not " +
                                    std::to_string(passes) + " times");
    }
    if (passes == 0) return volume;
    const Geometry& geometry = volume.geometry();
    const auto made = room_for(geometry);
    const std::span<float> samples(made.get(), static_cast<std::size_t>(sample_count(geometry)));
    const auto times = 1 + 3 * static_cast<std::size_t>(passes);
    ReportedItems reported(progress, times * samples.size(), reported_samples);
    with_type(volume.type(), [&](auto s) {
        const auto* const from = volume.samples<decltype(s)>().data();
        const auto row = static_cast<std::size_t>(geometry.size[0]);
        for (std::size_t at = 0; at < samples.size(); at += row) {
            std::copy_n(from + at, row, samples.begin() + static_cast<std::ptrdiff_t>(at));
            reported.done(row);
        }
    });
    const auto size = geometry.size.cast<std::size_t>().eval();
    for (int pass = 0; pass < passes; ++pass) {
        smooth_along(samples, 1, size[0], reported);
        smooth_along(samples, size[0], size[1], reported);
        smooth_along(samples, size[0] * size[1], size[2], reported);
    }
    return {geometry, SampleType::float32, made, samples.size_bytes(), progress};
}

Volume sharpened(const Volume& volume, const OnProgress& progress) {
    const Geometry& geometry = volume.geometry();
    const Index3 size = geometry.size;
    const auto made = room_for(geometry);
    const std::span<float> samples(made.get(), static_cast<std::size_t>(sample_count(geometry)));
    ReportedItems reported(progress, samples.size(), reported_samples);
    with_type(volume.type(), [&](auto s) {
        const auto* const from = volume.samples<decltype(s)>().data();
        const std::array<std::ptrdiff_t, 3> stride{1, size[0], std::ptrdiff_t{size[0]} * size[1]};
        std::ptrdiff_t at = 0;
        for (Index3 i = Index3::Zero(); i[2] < size[2]; ++i[2]) {
            for (i[1] = 0; i[1] < size[1]; ++i[1]) {
                for (i[0] = 0; i[0] < size[0]; ++i[0], ++at) {
                    const double here = from[at];
                    double laplacian = 0;
                    for (int a = 0; a < 3; ++a) {
                        if (i[a] > 0) laplacian += from[at - stride[a]] - here;
                        if (i[a] + 1 < size[a]) laplacian += from[at + stride[a]] - here;
                    }
                    made[at] = static_cast<float>(here - 0.125 * laplacian);
                }
                reported.done(static_cast<std::size_t>(size[0]));
            }
        }
    });
    return {geometry, SampleType::float32, made, samples.size_bytes(), progress};
}

}  // namespace palpate
