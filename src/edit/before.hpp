// The samples before an edit, also where they are not in memory.
#pragma once

#include <vector>

#include "palpate/edit.hpp"

namespace palpate {

/// The samples before an edit. Those of a large grid have to be fetched first.
class Before {
  public:
    Before(const Samples& samples, const ReadSamples& read)
        : samples_(samples), read_(read), is_large_(samples.resident() != nullptr) {}

    const Samples& samples() const { return samples_; }
    bool is_large() const { return is_large_; }
    Index3 last() const { return samples_.geometry().size - Index3::Ones(); }

    /// Of a large grid: makes a box, which is cut to the grid, known to sample().
    void fetch(const SampleBox& box) {
        box_ = {box.low.cwiseMax(Index3::Zero()), box.high.cwiseMin(last())};
        size_ = box_.high - box_.low + Index3::Ones();
        bytes_.resize(static_cast<std::size_t>(size_.cast<std::int64_t>().prod()) *
                      size_of(samples_.type()));
        read_(box_, bytes_);
    }
    double sample(const Index3& at) const {
        if (!is_large_ || is_edited(at)) return samples_.sample(at);
        return with_type(samples_.type(), [&](auto zero) {
            return double(reinterpret_cast<const decltype(zero)*>(bytes_.data())[fetched(at)]);
        });
    }
    /// So many samples from one on along x, before all edits.
    const std::byte* row(const Index3& at) const {
        const auto each = static_cast<std::ptrdiff_t>(size_of(samples_.type()));
        if (is_large_) return bytes_.data() + fetched(at) * each;
        return static_cast<const std::byte*>(samples_.volume().data()) +
               sample_place(at, samples_.geometry().size) * each;
    }

  private:
    bool is_edited(const Index3& at) const {
        return samples_.bricks() && samples_.bricks()->of_sample(at);
    }
    /// Place among the fetched samples.
    std::ptrdiff_t fetched(const Index3& at) const { return sample_place(at - box_.low, size_); }

    const Samples& samples_;
    const ReadSamples& read_;
    bool is_large_;
    SampleBox box_;
    Index3 size_ = Index3::Zero();
    std::vector<std::byte> bytes_;
};

}  // namespace palpate
