// The hands in the window: how many there are at most, and their colours.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "palpate/servo.hpp"
#include "pictures/scene.hpp"

namespace palpate::viewer {

inline constexpr int most_hands = 2;

/// A value for each hand. Hands are numbered from 1.
template <class T>
class PerHand {
  public:
    T& operator[](int hand) { return values_.at(static_cast<std::size_t>(hand - 1)); }
    const T& operator[](int hand) const { return values_.at(static_cast<std::size_t>(hand - 1)); }
    auto begin() { return values_.begin(); }
    auto begin() const { return values_.begin(); }
    auto end() { return values_.end(); }
    auto end() const { return values_.end(); }

  private:
    std::array<T, most_hands> values_{};
};

/// Nothing: there is no such hand, or no tick yet.
using HandSnapshots = PerHand<std::optional<Snapshot>>;

struct HandColours {
    pictures::Colour hip, scp;
};
/// The second hand has the lighter blue and the lighter red (Okabe and Ito).
inline HandColours colours_of(int hand) {
    if (hand == 1) return {pictures::hip_colour, pictures::scp_colour};
    return {{0.337, 0.706, 0.914}, {0.902, 0.624, 0}};
}

}  // namespace palpate::viewer
