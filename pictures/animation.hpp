// Combines PNGs of one size into an animated PNG (APNG). Browsers play it; other programs show its
// first picture.
#pragma once

#include <span>
#include <string>

namespace palpate::pictures {

/// The bytes of an animated PNG that shows each picture for `seconds`, again and again. Throws
/// std::invalid_argument unless there is a picture, all are PNGs of one size and kind of pixel
/// without a palette, and the time is above 0 and at most 60.
std::string animation_of(std::span<const std::string> pngs, double seconds);

}  // namespace palpate::pictures
