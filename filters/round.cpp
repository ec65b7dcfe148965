// One round of dequantization. Slices a step apart form a chain that no other slice enters, except
// for the first and the last of the volume, which stand for all beyond them. So a chain needs three
// slices of what is between its samples and the result, and the volume one copy.
#include "filters/round.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace palpate::filters {
namespace {

using Slice = std::vector<float>;

/// out = (a + 2b + c) / 4.
void binomial(const float* a, const float* b, const float* c, float* out, int count) {
    for (int i = 0; i < count; ++i) out[i] = 0.25F * (a[i] + 2 * b[i] + c[i]);
}

/// The same along a row, over neighbours `step` apart; those beyond its ends count as the ends.
void binomial_along(const float* row, float* out, int count, int step) {
    const int inner = std::max(step, count - step);  // from here on the right neighbour is the end
    const int outer = std::min(step, count);         // up to here the left one
    const auto near = [&](int i) {
        const float a = row[std::max(i - step, 0)], c = row[std::min(i + step, count - 1)];
        out[i] = 0.25F * (a + 2 * row[i] + c);
    };
    for (int i = 0; i < outer; ++i) near(i);
    if (inner > step) binomial(row, row + step, row + 2 * step, out + step, inner - step);
    for (int i = std::min(inner, count); i < count; ++i) near(i);
}

class Round {
  public:
    Round(const Volume& volume, std::span<float> state, const RoundSettings& settings,
          const ForRows& rows)
        : volume_(volume),
          state_(state),
          settings_(settings),
          rows_(rows),
          nx_(volume.geometry().size[0]),
          ny_(volume.geometry().size[1]),
          nz_(volume.geometry().size[2]) {
        for (Slice* slice :
             {&flat_[0], &flat_[1], &flat_[2], &mean_[0], &mean_[1], &twice_[0], &twice_[1],
              &twice_[2], &flat_first_, &flat_last_, &twice_first_, &twice_last_}) {
            slice->resize(std::size_t(nx_) * std::size_t(ny_));
        }
    }

    void run(const std::function<void()>& at_slice) {
        keep_border(0, std::min(settings_.step, nz_ - 1), flat_first_, twice_first_);
        keep_border(nz_ - 1, std::max(nz_ - 1 - settings_.step, 0), flat_last_, twice_last_);
        for (int first = 0; first < std::min(settings_.step, nz_); ++first) {
            run_chain(first, at_slice);
        }
    }

  private:
    std::size_t row(int y) const { return std::size_t(y) * std::size_t(nx_); }
    std::size_t slice(int z) const { return std::size_t(z) * row(ny_); }

    /// Row y of `from`, smoothed along y and x, into `to`. `scratch` holds a row.
    void flatten(const float* from, float* to, int y, float* scratch) const {
        const int below = std::max(y - settings_.step, 0);
        const int above = std::min(y + settings_.step, ny_ - 1);
        binomial(from + row(below), from + row(y), from + row(above), scratch, nx_);
        binomial_along(scratch, to + row(y), nx_, settings_.step);
    }

    void flatten_slice(const float* from, float* to) const {
        rows_(ny_, [&](int begin, int end) {
            Slice scratch(std::size_t(nx_), 0.0F);
            for (int y = begin; y < end; ++y) flatten(from, to, y, scratch.data());
        });
    }

    /// What stands for all slices beyond the border at z: smoothed once and twice. `inside` is the
    /// slice a step inside.
    void keep_border(int z, int inside, Slice& flat, Slice& twice) {
        flatten_slice(state_.data() + slice(z), flat.data());
        flatten_slice(state_.data() + slice(inside), flat_[0].data());
        binomial(flat.data(), flat.data(), flat_[0].data(), mean_[0].data(), int(row(ny_)));
        flatten_slice(mean_[0].data(), twice.data());
    }

    void run_chain(int first, const std::function<void()>& at_slice) {
        const int count = (nz_ - 1 - first) / settings_.step + 1;
        const auto state_of = [&](int k) {
            return state_.data() + slice(first + k * settings_.step);
        };
        const auto flat_of = [&](int k) -> Slice& {
            return k < 0 ? flat_first_ : k == count ? flat_last_ : flat_[std::size_t(k % 3)];
        };
        const auto twice_of = [&](int k) -> Slice& {
            return k < 0 ? twice_first_ : k == count ? twice_last_ : twice_[std::size_t(k % 3)];
        };
        const auto mean_of = [&](int k) -> Slice& { return mean_[std::size_t(k % 2)]; };
        flatten_slice(state_of(0), flat_of(0).data());
        for (int k = 0; k <= count; ++k) {
            if (k < count) {
                rows_(ny_, [&](int begin, int end) {
                    Slice scratch(std::size_t(nx_), 0.0F);
                    for (int y = begin; y < end; ++y) {
                        const std::size_t at = row(y);
                        if (k + 1 < count) {
                            flatten(state_of(k + 1), flat_of(k + 1).data(), y, scratch.data());
                        }
                        binomial(&flat_of(k - 1)[at], &flat_of(k)[at], &flat_of(k + 1)[at],
                                 &mean_of(k)[at], nx_);
                    }
                });
            }
            rows_(ny_, [&](int begin, int end) {
                Slice scratch(std::size_t(nx_), 0.0F);
                for (int y = begin; y < end; ++y) {
                    if (k < count)
                        flatten(mean_of(k).data(), twice_of(k).data(), y, scratch.data());
                    if (k == 0) continue;
                    const std::size_t at = row(y);
                    binomial(&twice_of(k - 2)[at], &twice_of(k - 1)[at], &twice_of(k)[at],
                             scratch.data(), nx_);
                    move_row(first + (k - 1) * settings_.step, y, &mean_of(k - 1)[at],
                             scratch.data());
                }
            });
            if (k > 0) at_slice();
        }
    }

    /// u = 2b - Bb, kept within half a level of the volume's sample and inside its range.
    void move_row(int z, int y, const float* mean, const float* twice) const {
        const std::size_t at = slice(z) + row(y);
        float* state = state_.data() + at;
        const float half = settings_.half, per_straight = 1 / settings_.straight;
        const float least = settings_.least, greatest = settings_.greatest;
        with_type(volume_.type(), [&](auto zero) {
            const auto* own = static_cast<const decltype(zero)*>(volume_.data()) + at;
            for (int i = 0; i < nx_; ++i) {
                const auto sample = static_cast<float>(own[i]);
                const float bend = mean[i] - twice[i];
                const float low = std::max(sample - half, least);
                const float high = std::min(sample + half, greatest);
                const float moved = std::min(std::max(mean[i] + bend, low), high);
                const float part =
                    std::min(std::max(2 - std::abs(bend) * per_straight, 0.0F), 1.0F);
                state[i] += part * (moved - state[i]);
            }
        });
    }

    const Volume& volume_;
    std::span<float> state_;
    const RoundSettings& settings_;
    const ForRows& rows_;
    int nx_, ny_, nz_;
    std::array<Slice, 3> flat_;   ///< of the chain's slices k - 1 to k + 1: smoothed in the slice
    std::array<Slice, 2> mean_;   ///< k - 1, k: smoothed in space
    std::array<Slice, 3> twice_;  ///< k - 2 to k: that, smoothed in the slice once more
    Slice flat_first_, flat_last_, twice_first_, twice_last_;
};

}  // namespace

void run_round(const Volume& volume, std::span<float> state, const RoundSettings& settings,
               const ForRows& rows, const std::function<void()>& at_slice) {
    Round(volume, state, settings, rows).run(at_slice);
}

}  // namespace palpate::filters
