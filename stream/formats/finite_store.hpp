// A store that replaces samples that are not finite. Private to stream/.
#pragma once

#include <functional>
#include <optional>

#include "palpate/stream/store.hpp"
#include "stream/formats/unpacking_room.hpp"

namespace palpate::stream {

/// NaN and infinities become the least finite sample, as in io::read_volume(). This sample is
/// searched when it is first needed, unless the store gives the range.
class FiniteStore : public Store {
  public:
    const StoreInfo& info() const final { return info_; }
    void read(int level, const SampleBox& box, std::span<std::byte> out,
              std::stop_token stop) const final;

  protected:
    explicit FiniteStore(StoreInfo info = {}) : info_(std::move(info)) {}

    /// Where `count` samples that follow each other go, of which this index is the first.
    using Places = std::function<std::byte*(const Index3& first, std::size_t count)>;
    /// Puts all samples of a box of a level to these places, run by run. Some may not be finite.
    /// Throws as read().
    virtual void put(int level, const SampleBox& box, const Places& to,
                     const std::stop_token& stop) const = 0;
    /// Whether pieces of a level fit into the memory for unpacking.
    virtual bool can_unpack(int) const { return true; }

    StoreInfo info_;

  private:
    double least_finite(const std::stop_token& stop) const;
    double searched(const std::stop_token& stop) const;

    mutable UnpackingRoom searching_{1};  // for one thread; others wait, or are stopped
    mutable std::optional<double> least_finite_;
};

}  // namespace palpate::stream
