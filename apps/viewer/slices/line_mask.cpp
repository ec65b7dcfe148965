// Computes the distance of each pixel near a line to the line.
#include "apps/viewer/slices/line_mask.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::viewer {
namespace {

/// [pixels] A longer line is cut, so that the box round it is not mostly empty.
constexpr double longest = 8;

}  // namespace

LineMask::LineMask(int width, int height)
    : width_(std::max(width, 0)),
      height_(std::max(height, 0)),
      covered_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), 0) {}

void LineMask::draw(double x0, double y0, double x1, double y1, double radius) {
    if (!std::isfinite(x0 + y0 + x1 + y1)) return;
    const double margin = radius + 1;
    // The part inside the picture, for a line may be far longer than it (Liang and Barsky 1984).
    double from = 0, to = 1;
    const auto clip = [&](double start, double length, double low, double high) {
        if (length == 0) {
            if (start < low || start > high) to = -1;
            return;
        }
        const double a = (low - start) / length, b = (high - start) / length;
        from = std::max(from, std::min(a, b));
        to = std::min(to, std::max(a, b));
    };
    const double dx = x1 - x0, dy = y1 - y0;
    clip(x0, dx, -margin, width_ + margin);
    clip(y0, dy, -margin, height_ + margin);
    if (!(from <= to)) return;
    const double length = (to - from) * std::sqrt(dx * dx + dy * dy);
    const int parts = std::max(1, static_cast<int>(std::ceil(length / longest)));
    for (int i = 0; i < parts; ++i) {
        const double a = from + (to - from) * i / parts, b = from + (to - from) * (i + 1) / parts;
        draw_short(x0 + a * dx, y0 + a * dy, x0 + b * dx, y0 + b * dy, radius);
    }
}

void LineMask::draw_short(double x0, double y0, double x1, double y1, double radius) {
    const auto fx0 = static_cast<float>(x0), fy0 = static_cast<float>(y0);
    const auto dx = static_cast<float>(x1 - x0), dy = static_cast<float>(y1 - y0);
    const auto r = static_cast<float>(radius);
    const float squared = dx * dx + dy * dy;
    const float scale = squared > 0 ? 1 / squared : 0;
    const double reach = radius + 0.5;
    const float outer = (r + 0.5F) * (r + 0.5F);                  // beyond this nothing is covered,
    const float inner = r > 0.5F ? (r - 0.5F) * (r - 0.5F) : -1;  // up to this all
    const auto pixel = [](double at, int count) {
        return static_cast<int>(std::clamp(std::floor(at), 0.0, double(count)));
    };
    const int left = pixel(std::min(x0, x1) - reach, width_);
    const int right = pixel(std::max(x0, x1) + reach + 1, width_);
    const int top = pixel(std::min(y0, y1) - reach, height_);
    const int bottom = pixel(std::max(y0, y1) + reach + 1, height_);
    for (int y = top; y < bottom; ++y) {
        std::uint8_t* const covered = covered_.data() + static_cast<std::ptrdiff_t>(y) * width_;
        const float py = static_cast<float>(y) + 0.5F - fy0;
        for (int x = left; x < right; ++x) {
            const float px = static_cast<float>(x) + 0.5F - fx0;
            const float along = std::clamp((px * dx + py * dy) * scale, 0.0F, 1.0F);
            const float ex = px - along * dx, ey = py - along * dy;
            const float away = ex * ex + ey * ey;
            if (away >= outer) continue;
            const float near = away <= inner ? 1 : r + 0.5F - std::sqrt(away);
            const auto value = static_cast<std::uint8_t>(255 * std::min(near, 1.0F));
            covered[x] = std::max(covered[x], value);
        }
    }
}

}  // namespace palpate::viewer
