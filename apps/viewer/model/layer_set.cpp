// Looks, words and changes of layers.
#include "apps/viewer/model/layer_set.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "palpate/io/layers_file.hpp"

namespace palpate::viewer {
namespace {

constexpr double glass = 0.35;
constexpr double infinity = std::numeric_limits<double>::infinity();

SeenSurface seen(const Layer& layer, bool shown) {
    SeenSurface surface;
    surface.level = layer.level;
    surface.colour = {layer.colour[0], layer.colour[1], layer.colour[2]};
    surface.opacity = layer.opacity;
    surface.shown = shown;
    return surface;
}

void put_first(std::vector<SeenSurface>& surfaces, const Layers& layers, std::size_t from,
               bool shown) {
    std::vector<SeenSurface> all;
    for (std::size_t i = from; i < layers.layers.size(); ++i) {
        all.push_back(seen(layers.layers[i], shown));
    }
    surfaces.insert(surfaces.begin(), all.begin(), all.end());
}

Layer another(const Layers& layers, double level) {
    static constexpr std::array<double, 3> colours[] = {{0.34, 0.56, 0.75}, {0.84, 0.37, 0.25},
                                                        {0.45, 0.65, 0.35}, {0.80, 0.62, 0.80},
                                                        {0.90, 0.80, 0.35}, {0.40, 0.70, 0.70}};
    Layer layer;
    layer.level = level;
    layer.colour = colours[layers.layers.size() % std::size(colours)];
    layer.opacity = glass;
    const auto taken = [&](const std::string& name) {
        return std::ranges::count(layers.layers, name, &Layer::name) > 0;
    };
    for (std::size_t number = layers.layers.size() + 1; layer.name.empty(); ++number) {
        const std::string name = "layer " + std::to_string(number);
        if (!taken(name)) layer.name = name;
    }
    return layer;
}

}  // namespace

Look scene_look(Look look, const SharedLayers& layers) {
    if (!have_surfaces(layers)) return look;
    const SeenSurface outer = seen(layers->layers.front(), look.surface);
    look.surface_colour = outer.colour;
    look.surface_opacity = outer.opacity;
    put_first(look.surfaces, *layers, 1, look.surface);
    return look;
}

Look slice_look(Look look, const SharedLayers& layers) {
    if (have_surfaces(layers)) put_first(look.surfaces, *layers, 0, true);
    return look;
}

std::string felt_words(const LayersFelt& felt, const SharedLayers& layers) {
    if (!layers) return {};
    const int count = static_cast<int>(layers->layers.size());
    const auto name = [&](int layer) {
        return layers->layers[static_cast<std::size_t>(layer)].name;
    };
    std::string words;
    if (felt.touched >= 0 && felt.touched < count) words = "on " + name(felt.touched);
    const int inside = std::min(static_cast<int>(felt.inside), count);
    for (int layer = inside - 1; layer >= 0; --layer) {
        if (layer < inside - 1) {
            words += ", ";
        } else {
            words += words.empty() ? "in " : ", in ";
        }
        words += name(layer);
    }
    return words;
}

bool same(const SharedLayers& one, const SharedLayers& other) {
    if (one == other || !one || !other) return one == other;
    io::LayersFile a, b;
    a.layers = *one;
    b.layers = *other;
    return io::text_of(a) == io::text_of(b);
}

LevelRoom room_of(const Layers& layers, std::size_t layer, double gap) {
    const double level = layers.layers[layer].level;
    LevelRoom room{-infinity, infinity};
    for (const Layer& other : layers.layers) {
        if (other.level < level) room.low = std::max(room.low, other.level + gap);
        if (other.level > level) room.high = std::min(room.high, other.level - gap);
    }
    return {std::min(room.low, level), std::max(room.high, level)};
}

double property_at(const Layers& layers, std::size_t layer, HapticProperty property,
                   const RendererSettings& settings) {
    using enum HapticProperty;
    const Layer& at = layers.layers[layer];
    if (at[property]) return *at[property];
    const Curve& curve = layers[property].density;
    if (!curve.knots.empty()) return curve(at.level);
    switch (property) {
        case stiffness:
            return settings.force.stiffness;
        case static_friction:
            return settings.proxy.friction.static_coefficient;
        case dynamic_friction:
            return settings.proxy.friction.dynamic_coefficient;
        case damping:
            return settings.force.damping;
        case viscosity:
            return settings.force.viscosity;
        case puncture_force:
            return infinity;
        case drag:
            break;
    }
    return 0;
}

std::optional<double> lowered_stiffness(const Layers& layers, std::size_t layer,
                                        const RendererSettings& settings) {
    using enum HapticProperty;
    ForceSettings force = settings.force;
    force.stiffness = property_at(layers, layer, stiffness, settings);
    force.damping = property_at(layers, layer, damping, settings);
    const double outside =
        layer > 0 ? property_at(layers, layer - 1, viscosity, settings) : settings.force.viscosity;
    force.viscosity = std::max(outside, property_at(layers, layer, viscosity, settings));
    const double rendered = stable(force, settings.device).stiffness;
    return rendered < force.stiffness ? std::optional(rendered) : std::nullopt;
}

std::pair<Layers, std::size_t> with_another(Layers layers, Solid solid, double low, double high) {
    std::vector<double> levels{low, high};
    for (const Layer& layer : layers.layers) levels.push_back(layer.level);
    std::ranges::sort(levels);
    double level = 0.5 * (low + high), widest = -1;
    for (std::size_t i = 1; i < levels.size(); ++i) {
        const double room = levels[i] - levels[i - 1];
        if (room <= widest) continue;
        widest = room;
        level = 0.5 * (levels[i] + levels[i - 1]);
    }
    const Layer added = another(layers, level);
    const double sign = solid == Solid::above ? 1 : -1;
    const auto behind = std::ranges::find_if(
        layers.layers, [&](const Layer& layer) { return sign * layer.level > sign * level; });
    const auto at = static_cast<std::size_t>(behind - layers.layers.begin());
    layers.layers.insert(behind, added);
    return {std::move(layers), at};
}

Layers first_layer(double level) {
    Layers layers;
    layers.name = "Own layers";
    Layer layer = another(layers, level);
    layer.opacity = 1;
    layers.layers.push_back(layer);
    return layers;
}

void LayersHistory::keep(const SharedLayers& now, bool goes_on) {
    future_.clear();
    if (goes_on && !past_.empty()) return;
    past_.push_back(now);
    if (past_.size() > most) past_.erase(past_.begin());
}

std::optional<SharedLayers> LayersHistory::undo(const SharedLayers& now) {
    // A change that was refused left no trace in `now`.
    while (!past_.empty() && past_.back() == now) past_.pop_back();
    if (past_.empty()) return std::nullopt;
    SharedLayers before = past_.back();
    past_.pop_back();
    future_.push_back(now);
    return before;
}

std::optional<SharedLayers> LayersHistory::redo(const SharedLayers& now) {
    if (future_.empty()) return std::nullopt;
    SharedLayers after = future_.back();
    future_.pop_back();
    past_.push_back(now);
    return after;
}

void LayersHistory::clear() {
    past_.clear();
    future_.clear();
}

}  // namespace palpate::viewer
