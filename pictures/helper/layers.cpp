// Blends drawings, pixel by pixel.
#include "pictures/helper/layers.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace palpate::pictures {
namespace {

unsigned char mixed(unsigned char below, unsigned char above, unsigned alpha) {
    return static_cast<unsigned char>((below * (255 - alpha) + above * alpha + 127) / 255);
}

}  // namespace

void lay_over(Layer& picture, const std::vector<Layer>& panes) {
    std::vector<const Layer*> here;
    for (std::size_t i = 0; i < picture.depth.size(); ++i) {
        here.clear();
        for (const Layer& pane : panes) {
            if (pane.depth[i] < std::min(1.0F, picture.depth[i])) here.push_back(&pane);
        }
        std::ranges::sort(
            here, [i](const Layer* a, const Layer* b) { return a->depth[i] > b->depth[i]; });
        for (const Layer* const pane : here) {
            const unsigned alpha = pane->rgba[4 * i + 3];
            for (std::size_t c = 4 * i; c < 4 * i + 3; ++c) {
                picture.rgba[c] = mixed(picture.rgba[c], pane->rgba[c], alpha);
            }
        }
    }
}

void shine_through(Layer& picture, const Layer& hidden, double opacity) {
    const auto alpha = static_cast<unsigned>(255 * opacity);
    for (std::size_t i = 0; i < picture.depth.size(); ++i) {
        if (hidden.depth[i] >= 1 || hidden.depth[i] <= picture.depth[i] + 1e-6F) continue;
        for (std::size_t c = 4 * i; c < 4 * i + 3; ++c) {
            picture.rgba[c] = mixed(picture.rgba[c], hidden.rgba[c], alpha);
        }
    }
}

void lay_over(Layer& picture, const Layer& overlay) {
    for (std::size_t i = 0; i < picture.depth.size(); ++i) {
        const unsigned alpha = overlay.rgba[4 * i + 3];
        for (std::size_t c = 4 * i; alpha > 0 && c < 4 * i + 3; ++c) {
            const unsigned below = (picture.rgba[c] * (255 - alpha) + 127) / 255;
            picture.rgba[c] = static_cast<unsigned char>(std::min(255U, below + overlay.rgba[c]));
        }
    }
}

std::vector<unsigned char> reduced(const Layer& picture, int width, int height, int scale) {
    const auto step = static_cast<std::size_t>(scale), row = static_cast<std::size_t>(width);
    const std::size_t w = row / step, h = static_cast<std::size_t>(height) / step;
    const auto blocks = static_cast<unsigned>(scale * scale);
    std::vector<unsigned char> pixels;
    pixels.reserve(3 * w * h);
    for (std::size_t y = 0; y < h; ++y) {
        for (std::size_t x = 0; x < w; ++x) {
            std::array<unsigned, 3> sum{};
            for (std::size_t j = 0; j < step; ++j) {
                for (std::size_t i = 0; i < step; ++i) {
                    const std::size_t at = 4 * ((y * step + j) * row + x * step + i);
                    for (std::size_t c = 0; c < 3; ++c) sum[c] += picture.rgba[at + c];
                }
            }
            for (const unsigned s : sum) {
                pixels.push_back(static_cast<unsigned char>((s + blocks / 2) / blocks));
            }
        }
    }
    return pixels;
}

}  // namespace palpate::pictures
