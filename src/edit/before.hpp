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
            return double(reinterpret_cast<const decltype(zero)*>(bytes_.data())[place_of(at)]);
        });
    }
    /// So many samples from one on along x, before all edits.
    const std::byte* row(const Index3& at) const {
        const std::size_t each = size_of(samples_.type());
        if (is_large_) return bytes_.data() + place_of(at) * each;
        const Index3& size = samples_.geometry().size;
        const auto from = (std::size_t(at[2]) * std::size_t(size[1]) + std::size_t(at[1])) *
                              std::size_t(size[0]) +
                          std::size_t(at[0]);
        return static_cast<const std::byte*>(samples_.volume().data()) + from * each;
    }

  private:
    bool is_edited(const Index3& at) const {
        return samples_.bricks() && samples_.bricks()->of_sample(at);
    }
    std::size_t place_of(const Index3& at) const {
        const Index3 in = at - box_.low;
        return (std::size_t(in[2]) * std::size_t(size_[1]) + std::size_t(in[1])) *
                   std::size_t(size_[0]) +
               std::size_t(in[0]);
    }

    const Samples& samples_;
    const ReadSamples& read_;
    bool is_large_;
    SampleBox box_;
    Index3 size_ = Index3::Zero();
    std::vector<std::byte> bytes_;
};

}  // namespace palpate
