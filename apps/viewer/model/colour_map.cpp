// Colour maps by their colours at even distances.
#include "apps/viewer/model/colour_map.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace palpate::viewer {
namespace {

using pictures::Colour;

struct ColourMap {
    std::string name;
    std::vector<Colour> colours;
};

std::vector<ColourMap> all_maps() {
    return {{"grey", {{0, 0, 0}, {1, 1, 1}}},
            {"hot", {{0, 0, 0}, {0.9, 0, 0}, {1, 0.82, 0}, {1, 1, 1}}},
            {"bone", {{0, 0, 0}, {0.32, 0.32, 0.44}, {0.65, 0.78, 0.78}, {1, 1, 1}}},
            // After matplotlib's, at eighths.
            {"viridis",
             {{0.267, 0.005, 0.329},
              {0.279, 0.175, 0.483},
              {0.230, 0.322, 0.546},
              {0.173, 0.449, 0.558},
              {0.128, 0.567, 0.551},
              {0.158, 0.684, 0.502},
              {0.369, 0.789, 0.383},
              {0.678, 0.864, 0.190},
              {0.993, 0.906, 0.144}}},
            // After Moreland 2009, at quarters.
            {"cool-warm",
             {{0.230, 0.299, 0.754},
              {0.552, 0.690, 0.996},
              {0.865, 0.865, 0.865},
              {0.959, 0.598, 0.477},
              {0.706, 0.016, 0.150}}},
            {"spectrum", {{0, 0, 0.5}, {0, 0, 1}, {0, 1, 1}, {1, 1, 0}, {1, 0, 0}, {0.5, 0, 0}}}};
}

Colour mixed(const Colour& a, const Colour& b, double t) {
    return {std::lerp(a.red, b.red, t), std::lerp(a.green, b.green, t),
            std::lerp(a.blue, b.blue, t)};
}

std::uint32_t packed(const Colour& c) {
    const auto byte = [](double part) {
        return static_cast<std::uint32_t>(std::lround(255 * std::clamp(part, 0.0, 1.0)));
    };
    return 0xff000000U | byte(c.red) << 16 | byte(c.green) << 8 | byte(c.blue);
}

}  // namespace

std::vector<std::string> colour_map_names() {
    std::vector<std::string> names;
    for (const ColourMap& map : all_maps()) names.push_back(map.name);
    return names;
}

ColourTable colour_table(const std::string& name) {
    const auto maps = all_maps();
    const auto found = std::ranges::find(maps, name, &ColourMap::name);
    if (found == maps.end()) throw std::invalid_argument("no colour map '" + name + "'");
    const auto& colours = found->colours;
    ColourTable table{};
    for (std::size_t i = 0; i < table.size(); ++i) {
        const double at = double(i) / 255 * double(colours.size() - 1);
        const auto before = std::min(static_cast<std::size_t>(at), colours.size() - 2);
        table[i] = packed(mixed(colours[before], colours[before + 1], at - double(before)));
    }
    return table;
}

pictures::Colour label_colour(int value) {
    // Hues a golden section apart are far from each other, however many there are.
    const double turn = std::abs(0.618034 * value), hue = 6 * (turn - std::floor(turn));
    const auto channel = [&](double at) {
        const double away = std::abs(std::fmod(hue + at, 6.0) - 3);
        return 0.25 + 0.65 * std::clamp(away - 1, 0.0, 1.0);
    };
    return {channel(0), channel(4), channel(2)};
}

}  // namespace palpate::viewer
