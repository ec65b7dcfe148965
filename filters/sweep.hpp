// A sweep along z through a strip of samples: smooths them once and twice, row by row. Intermediate
// rows stay in the processor's second-level cache.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>

#include "filters/strips.hpp"

// Loops over rows are compiled twice, the second time for processors with AVX2 (without FMA, so
// both have the same bits). What is called in them has to be part of them. MinGW does not align
// what it spills.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(_WIN32)
#define PALPATE_FOR_AVX2 [[gnu::target("avx2")]]
#endif
#ifdef __GNUC__
#define PALPATE_INLINE [[gnu::always_inline]] inline
#define PALPATE_INLINE_LAMBDA __attribute__((always_inline))
#else
#define PALPATE_INLINE inline
#define PALPATE_INLINE_LAMBDA
#endif

namespace palpate::filters {

#ifdef PALPATE_FOR_AVX2
template <class Work>
PALPATE_FOR_AVX2 void vectorized_avx2(const Work& work) {
    work();
}
#endif
/// Calls work(), which is a PALPATE_INLINE_LAMBDA, as it was compiled for this processor.
template <class Work>
void vectorized(const Work& work) {
#ifdef PALPATE_FOR_AVX2
    if (__builtin_cpu_supports("avx2")) return vectorized_avx2(work);
#endif
    work();
}

/// Returns work(zero) with a zero of the type of the own samples.
template <class Work>
auto with_own_type(const MovedSamples& samples, const Work& work) {
    return samples.floats ? work(float{}) : work(std::uint16_t{});
}

/// a + 2b + c, which is four times their binomial mean. The factor is divided out at the end. It is
/// a power of two, so it changes no bits.
PALPATE_INLINE float binomial(float a, float b, float c) {
    return a + 2 * b + c;
}
PALPATE_INLINE void binomial(const float* a, const float* b, const float* c, float* __restrict out,
                             int count) {
    for (int i = 0; i < count; ++i) out[i] = binomial(a[i], b[i], c[i]);
}

/// A row in the result of a sweep. Pointers point to the sample begin_x.
struct SweptRow {
    int y, z;
    const float* sums;    ///< 64 b [levels], with a sample more at both ends
    std::ptrdiff_t row;   ///< to the sums of the next row
    const float* before;  ///< 1024 Bb but for its smoothing along z: of the slice before,
    const float* here;    ///< of this one,
    const float* after;   ///< and of the next one

    /// b and Bb of a sample
    PALPATE_INLINE float mean(std::ptrdiff_t i) const { return sums[i] * (1.0F / 64); }
    PALPATE_INLINE float twice(std::ptrdiff_t i) const {
        return binomial(before[i], here[i], after[i]) * (1.0F / 4096);
    }
    /// b - Bb
    PALPATE_INLINE float bend(std::ptrdiff_t i) const { return mean(i) - twice(i); }
};

/// How far a sample lies above the least one [levels].
PALPATE_INLINE float in_levels(float own, const Levels& levels) {
    return (own - levels.least) * levels.per_level;
}
PALPATE_INLINE float in_levels(std::uint16_t own, const Levels& levels) {
    return static_cast<float>(own) * levels.per_level;
}
/// What `moved` of 1 means [levels].
inline constexpr float moved_unit = 1.0F / 65536;

/// How much a sample moves at a coarse step, 0 to 1.
PALPATE_INLINE float part_of(float bend, const Levels& levels) {
    return std::min(std::max(2 - std::abs(bend) * (1 / levels.straight), 0.0F), 1.0F);
}

/// How far a sample moves that is to be `to` away from the volume's own, which is `sample`
/// [levels].
PALPATE_INLINE std::int16_t moved_to(float to, float sample, const Levels& levels) {
    const float low = std::max(-levels.half, -sample);
    const float high = std::min(levels.half, levels.top - sample);
    const float units = std::min(std::max(to, low), high) * (1 / moved_unit);
    // Adding and taking this rounds to the nearest whole number.
    constexpr float round = 3 << 22;
    return static_cast<std::int16_t>(static_cast<int>(units + round - round));
}

template <class T>
const T* own_row(const MovedSamples& samples, int y, int z) {
    const std::ptrdiff_t at = z * samples.own_slice + y * samples.row;
    if constexpr (std::is_same_v<T, float>)
        return samples.floats + at;
    else
        return samples.whole + at;
}
inline std::int16_t* moved_row(const MovedSamples& samples, int y, int z) {
    return samples.moved + z * samples.moved_slice + y * samples.row;
}

/// The samples begin to end - 1 of a row, as they are moved [levels]. Beyond its ends it goes on as
/// a straight line would: v(-k) = 2 v(0) - v(k).
template <class T>
PALPATE_INLINE void load_row(const MovedSamples& samples, const Levels& levels, int y, int z,
                             int begin, int end, float* __restrict out) {
    const T* own = own_row<T>(samples, y, z);
    const std::int16_t* moved = samples.moved ? moved_row(samples, y, z) : nullptr;
    const int size = samples.size[0], from = std::max(begin, 0), to = std::min(end, size);
    const auto load = [&](auto apart) PALPATE_INLINE_LAMBDA {
        const auto value = [&](int x) PALPATE_INLINE_LAMBDA {
            const float sample = in_levels(own[x * apart], levels);
            return moved ? sample + static_cast<float>(moved[x * apart]) * moved_unit : sample;
        };
        const auto beyond = [&](int x) {
            const int last = x < 0 ? 0 : size - 1;
            return 2 * value(last) - value(std::clamp(2 * last - x, 0, size - 1));
        };
        for (int x = begin; x < from; ++x) out[x - begin] = beyond(x);
        for (int x = from; x < to; ++x) out[x - begin] = value(x);
        for (int x = to; x < end; ++x) out[x - begin] = beyond(x);
    };
    samples.apart == 1 ? load(std::integral_constant<int, 1>())
                       : load(std::integral_constant<int, 2>());
}

/// The samples begin to end - 1 of a row that may lie beyond the first and the last along y and z.
template <class T>
PALPATE_INLINE void load(const MovedSamples& samples, const Levels& levels, int y, int z, int begin,
                         int end, float* __restrict out, float* __restrict scratch) {
    // out = (2 at the end - mirrored) along y of the same along z
    const int end_y = std::clamp(y, 0, samples.size[1] - 1),
              end_z = std::clamp(z, 0, samples.size[2] - 1);
    load_row<T>(samples, levels, end_y, end_z, begin, end, out);
    if (end_y == y && end_z == z) return;
    const auto add = [&](int at_y, int at_z, float weight) {
        at_y = std::clamp(at_y, 0, samples.size[1] - 1);
        at_z = std::clamp(at_z, 0, samples.size[2] - 1);
        load_row<T>(samples, levels, at_y, at_z, begin, end, scratch);
        for (int i = 0; i < end - begin; ++i) out[i] += weight * scratch[i];
    };
    const int mirrored_y = 2 * end_y - y, mirrored_z = 2 * end_z - z;
    if (end_y != y && end_z != z) {
        add(end_y, end_z, 3);
        add(mirrored_y, end_z, -2);
        add(end_y, mirrored_z, -2);
        add(mirrored_y, mirrored_z, 1);
    } else {
        add(end_y, end_z, 1);
        add(mirrored_y, mirrored_z, -1);
    }
}

/// Smooths the rows of a strip: once (b) and, but for z, twice. Rows of each kind follow each other
/// at the same distance and begin 2 samples before begin_x. Loops over them take `count` samples,
/// whole vectors, of which the last ones are not used.
struct SweepBuffers {
    explicit SweepBuffers(const Strip& strip)
        : rows(strip.end_y - strip.begin_y),
          count((strip.end_x - strip.begin_x + 4 + vector - 1) / vector * vector),
          row(count + vector),
          memory(std::make_unique_for_overwrite<float[]>(std::size_t(row) *
                                                         std::size_t(9 * rows + 15))) {
        std::fill(scratch() + count, scratch() + row, 0.0F);
    }

    float* at(int i) { return memory.get() + std::ptrdiff_t{i} * row; }
    float* loaded(int y) { return at(y + 2); }  // -2 to rows + 1
    float* flat(int z, int y) { return at(rows + 4 + z % 3 * (rows + 2) + y + 1); }  // -1 to rows
    float* mean(int z, int y) { return at(4 * rows + 10 + z % 2 * (rows + 2) + y + 1); }
    float* twice(int z, int y) { return at(6 * rows + 14 + z % 3 * rows + y); }
    float* scratch() { return at(9 * rows + 14); }

    static constexpr int vector = 8;
    int rows, count;
    std::ptrdiff_t row;
    std::unique_ptr<float[]> memory;
};

/// Calls each(SweptRow) for the rows of a strip, slice by slice.
template <class T, class Each>
PALPATE_INLINE void sweep(const MovedSamples& samples, const Levels& levels, const Strip& strip,
                          const Each& each) {
    SweepBuffers buffers(strip);
    const int rows = buffers.rows, count = buffers.count / buffers.vector * buffers.vector;
    const auto number = [&](int z) { return z - strip.begin_z + 6; };  // above 0
    for (int z = strip.begin_z - 2; z < strip.end_z + 2; ++z) {
        float* __restrict const scratch = buffers.scratch();
        for (int y = -2; y < rows + 2; ++y) {
            load<T>(samples, levels, strip.begin_y + y, z, strip.begin_x - 2,
                    strip.begin_x - 2 + count, buffers.loaded(y), scratch);
        }
        const bool has_mean = z >= strip.begin_z;  // of the slice before
        for (int y = -1; y < rows + 1; ++y) {
            binomial(buffers.loaded(y - 1), buffers.loaded(y), buffers.loaded(y + 1), scratch,
                     count);
            float* __restrict const flat = buffers.flat(number(z), y) + 1;
            if (!has_mean) {
                binomial(scratch, scratch + 1, scratch + 2, flat, count);
                continue;
            }
            const float* const first = buffers.flat(number(z - 2), y) + 1;
            const float* const second = buffers.flat(number(z - 1), y) + 1;
            float* __restrict const mean = buffers.mean(number(z - 1), y) + 1;
            for (int i = 0; i < count; ++i) {
                const float third = binomial(scratch[i], scratch[i + 1], scratch[i + 2]);
                flat[i] = third;
                mean[i] = binomial(first[i], second[i], third);
            }
        }
        if (!has_mean) continue;
        for (int y = 0; y < rows; ++y) {
            const auto mean = [&](int at) { return buffers.mean(number(z - 1), at) + 1; };
            binomial(mean(y - 1), mean(y), mean(y + 1), scratch, count);
            binomial(scratch, scratch + 1, scratch + 2, buffers.twice(number(z - 1), y), count);
            if (z < strip.begin_z + 2) continue;
            each(SweptRow{strip.begin_y + y, z - 2, buffers.mean(number(z - 2), y) + 2, buffers.row,
                          buffers.twice(number(z - 3), y), buffers.twice(number(z - 2), y),
                          buffers.twice(number(z - 1), y)});
        }
    }
}

}  // namespace palpate::filters
