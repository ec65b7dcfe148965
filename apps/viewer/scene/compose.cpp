// Sorts the layers at each pixel by their depth.
#include "apps/viewer/scene/compose.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpate::viewer {
namespace {

/// `front` over `back`, of one pixel.
void put_over(const unsigned char* front, const std::array<double, 4>& back,
              std::array<double, 4>& out) {
    const double a = front[3] / 255.0;
    const double alpha = a + (1 - a) * back[3];
    for (std::size_t c = 0; c < 3; ++c) {
        out[c] = alpha > 0 ? (a * front[c] + (1 - a) * back[3] * back[c]) / alpha : 0;
    }
    out[3] = alpha;
}

}  // namespace

Layer composed(std::vector<Layer> layers, const Layer& solid) {
    if (layers.empty()) return {};
    if (layers.size() == 1) return std::move(layers.front());
    Layer result = std::move(layers.front());
    layers.erase(layers.begin());
    std::vector<std::pair<float, const unsigned char*>> at;
    std::vector<unsigned char> first(4);
    for (std::size_t i = 0; i < result.depth.size(); ++i) {
        unsigned char* const pixel = result.rgba.data() + 4 * i;
        at.clear();
        const auto add = [&](float depth, const unsigned char* rgba) {
            if (depth < 1 && depth < solid.depth[i] && rgba[3] > 0) at.emplace_back(depth, rgba);
        };
        std::copy_n(pixel, 4, first.begin());
        add(result.depth[i], first.data());
        for (const Layer& layer : layers) add(layer.depth[i], layer.rgba.data() + 4 * i);
        std::ranges::sort(at, {}, [](const auto& one) { return one.first; });
        std::array<double, 4> sum{};
        for (auto one = at.rbegin(); one != at.rend(); ++one) {
            const std::array<double, 4> back = sum;
            put_over(one->second, back, sum);
        }
        result.depth[i] = at.empty() ? 1 : at.front().first;
        for (std::size_t c = 0; c < 3; ++c) {
            pixel[c] = static_cast<unsigned char>(std::lround(sum[c]));
        }
        pixel[3] = static_cast<unsigned char>(std::lround(255 * sum[3]));
    }
    return result;
}

}  // namespace palpate::viewer
