// Interpolation of a finer grid from a coarser one, row by row.
#include <algorithm>
#include <vector>

#include "filters/round.hpp"
#include "filters/sweep.hpp"

namespace palpate::filters {
namespace {

/// floor(i / 2)
constexpr int half_of(int i) {
    return i >> 1;
}

/// Some slices of a coarser grid: how much its samples are to be believed, 0 to 65535, where bricks
/// are near. Less where the data bend.
struct Weights {
    Index3 size;
    int begin_z, end_z;
    std::vector<std::uint16_t> values = std::vector<std::uint16_t>(
        std::size_t(end_z - begin_z) * std::size_t(size[0]) * std::size_t(size[1]));

    void compute(const MovedSamples& coarse, const Levels& levels, const Strip& strip) {
        with_own_type(coarse, [&](auto zero) {
            using T = decltype(zero);
            const auto weigh = [&](const SweptRow& row) PALPATE_INLINE_LAMBDA {
                std::uint16_t* __restrict out = at(row.y, row.z);
                for (int x = 0; x < size[0]; ++x) {
                    const float part = part_of(row.bend(x), levels);
                    out[x] = static_cast<std::uint16_t>(static_cast<int>(65535 * part));
                }
            };
            vectorized([&]() PALPATE_INLINE_LAMBDA { sweep<T>(coarse, levels, strip, weigh); });
        });
    }

    /// A row, or the nearest one.
    std::uint16_t* at(int y, int z) {
        const std::ptrdiff_t slice = std::clamp(z, begin_z, end_z - 1) - begin_z;
        return values.data() + (slice * size[1] + std::clamp(y, 0, size[1] - 1)) * size[0];
    }
};

PALPATE_INLINE float cubic(float a, float b, float c, float d) {
    return (9 * (b + c) - (a + d)) * 0.0625F;
}

/// Some rows of a finer grid, interpolated from a coarser one: along y, z and x. A row of the
/// coarser grid has 2 samples more at both ends, and then as many weights.
template <class T>
struct RefinedRows {
    const MovedSamples& coarse;
    const MovedSamples& fine;
    const Levels& levels;
    const TerracedBricks& bricks;
    Weights& weights;
    int begin_y, end_y, begin_z, end_z;
    int rows = end_y - begin_y;
    int row = 2 * (coarse.size[0] + 4);
    int loaded_rows = rows / 2 + 4;
    std::vector<float> memory =
        std::vector<float>(std::size_t(row) * std::size_t(loaded_rows + 4 * rows + 3));

    float* at(int i) { return memory.data() + std::ptrdiff_t{i} * row; }
    float* loaded(int i) { return at(i); }
    float* along_y(int z, int y) { return at(loaded_rows + z % 4 * rows + y - begin_y); }
    float* along_z() { return at(loaded_rows + 4 * rows); }
    float* along_x() { return at(loaded_rows + 4 * rows + 1); }  // and one more
    float* scratch() { return along_x(); }

    PALPATE_INLINE void run() {
        const int first_z = first_coarser(fine, 2);
        int next = half_of(begin_z - first_z) - 1;
        for (int z = begin_z; z < end_z; ++z) {
            const int below = half_of(z - first_z);
            for (; next <= below + 2; ++next) interpolate_along_y(next);
            const bool is_between = (z - first_z) % 2 != 0;
            for (int y = begin_y; y < end_y; ++y) {
                const auto values = [&](int i) { return along_y(below + i + 8, y); };
                if (is_between) between(values(-1), values(0), values(1), values(2), along_z());
                move_row(y, z, is_between ? along_z() : values(0));
            }
        }
    }

    PALPATE_INLINE void interpolate_along_y(int z) {
        const int first_y = first_coarser(fine, 1), first = half_of(begin_y - first_y) - 1;
        for (int i = 0; i < loaded_rows; ++i) load_with_weights(first + i, z, loaded(i));
        for (int y = begin_y; y < end_y; ++y) {
            const auto values = [&](int i) { return loaded(half_of(y - first_y) + i - first); };
            if ((y - first_y) % 2 != 0) {
                between(values(-1), values(0), values(1), values(2), along_y(z + 8, y));
            } else {
                std::copy(values(0), values(0) + row, along_y(z + 8, y));
            }
        }
    }

    PALPATE_INLINE void load_with_weights(int y, int z, float* __restrict out) {
        const int width = coarse.size[0];
        load<T>(coarse, levels, y, z, -2, width + 2, out, scratch());
        const std::uint16_t* const from = weights.at(y, z);
        float* const to = out + row / 2 + 2;
        for (int x = 0; x < width; ++x) to[x] = static_cast<float>(from[x]) * (1.0F / 65535);
        to[-2] = to[-1] = to[0];
        to[width] = to[width + 1] = to[width - 1];
    }

    PALPATE_INLINE void between(const float* a, const float* b, const float* c, const float* d,
                                float* __restrict out) const {
        for (int i = 0; i < row / 2; ++i) out[i] = cubic(a[i], b[i], c[i], d[i]);
        for (int i = row / 2; i < row; ++i) out[i] = 0.5F * (b[i] + c[i]);
    }

    /// `from`: a row of the coarser grid.
    PALPATE_INLINE void move_row(int y, int z, const float* from) {
        float* __restrict values = along_x();
        float* __restrict parts = values + row;
        const float* const weight = from + row / 2;
        for (int i = 1; i < row / 2 - 2; ++i) {
            values[2 * i] = from[i];
            values[2 * i + 1] = cubic(from[i - 1], from[i], from[i + 1], from[i + 2]);
            parts[2 * i] = weight[i];
            parts[2 * i + 1] = 0.5F * (weight[i] + weight[i + 1]);
        }
        const int first =
            4 - first_coarser(fine, 0);  // of the samples of the finer grid in `values`
        values += first;
        parts += first;
        bricks.for_others(fine, y, z, 0, fine.size[0],
                          [&](int begin, int end) { std::fill(parts + begin, parts + end, 0.0F); });
        const T* own = own_row<T>(fine, y, z);
        std::int16_t* const moved = moved_row(fine, y, z);
        const auto move = [&](int x) PALPATE_INLINE_LAMBDA {
            const float sample = in_levels(own[x], levels);
            const float before = static_cast<float>(moved[x]) * moved_unit;
            moved[x] = moved_to(before + parts[x] * (values[x] - sample - before), sample, levels);
        };
        if (is_coarser(fine, 1, y) && is_coarser(fine, 2, z)) {  // others read every second one
            for (int x = 1 - first_coarser(fine, 0); x < fine.size[0]; x += 2) move(x);
        } else {
            for (int x = 0; x < fine.size[0]; ++x) move(x);
        }
    }
};

}  // namespace

void refine(const MovedSamples& samples, const Levels& levels, const TerracedBricks& bricks,
            const Parallel& parallel, const std::function<void(int)>& at_slab) {
    const Index3& size = samples.size;
    const MovedSamples coarse = every_second(samples);
    if (coarse.size.minCoeff() == 0) return at_slab(size[2]);
    constexpr int most_slices = 32, rows = 16;
    for (int begin_z = 0; begin_z < size[2]; begin_z += most_slices) {
        const int end_z = std::min(begin_z + most_slices, size[2]);
        const int first_z = first_coarser(samples, 2);
        // Calls work(begin_y, end_y) for the rows of a grid whose samples are `apart`, where bricks
        // are so near that interpolation needs them.
        const auto for_rows = [&](int apart, int height, const auto& work) {
            parallel((height + rows - 1) / rows, [&](int i) {
                const int begin = i * rows, end = std::min(begin + rows, height);
                const int near = 4 * (apart - 1);
                if (bricks.any(samples, std::max(apart * begin - near, 0),
                               std::min(apart * end + near, size[1]), begin_z, end_z)) {
                    work(begin, end);
                }
            });
        };
        Weights weights{coarse.size, std::max(half_of(begin_z - first_z), 0),
                        std::min(half_of(end_z - 1 - first_z) + 2, coarse.size[2])};
        for_rows(2, coarse.size[1], [&](int begin, int end) {
            weights.compute(coarse, levels,
                            {0, coarse.size[0], begin, end, weights.begin_z, weights.end_z});
        });
        for_rows(1, size[1], [&](int begin, int end) {
            with_own_type(samples, [&](auto zero) {
                RefinedRows<decltype(zero)> refined{coarse, samples, levels,  bricks, weights,
                                                    begin,  end,     begin_z, end_z};
                vectorized([&]() PALPATE_INLINE_LAMBDA { refined.run(); });
            });
        });
        at_slab(end_z - begin_z);
    }
}

}  // namespace palpate::filters
