// Draws many short lines smoothly and fast: how much of each pixel they cover. No Qt.
#pragma once

#include <cstdint>
#include <vector>

namespace palpate::viewer {

class LineMask {
  public:
    /// [pixels]
    LineMask(int width, int height);

    int width() const { return width_; }
    int height() const { return height_; }
    /// A line of `radius` [pixels] with round ends. Pixel (0, 0) is centred at (0.5, 0.5). What is
    /// outside is left out; where lines meet, nothing is drawn twice.
    void draw(double x0, double y0, double x1, double y1, double radius);
    /// Covered part of each pixel of a row, 0 to 255.
    const std::uint8_t* row(int y) const {
        return covered_.data() + static_cast<std::ptrdiff_t>(y) * width_;
    }

  private:
    void draw_short(double x0, double y0, double x1, double y1, double radius);

    int width_, height_;
    std::vector<std::uint8_t> covered_;
};

}  // namespace palpate::viewer
