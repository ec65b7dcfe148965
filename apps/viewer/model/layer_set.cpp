// Looks, words and changes of layers, and the points of a stroke through them.
#include "apps/viewer/model/layer_set.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>
#include <span>
#include <utility>

#include "palpate/io/layers_file.hpp"

namespace palpate::viewer {
namespace {

constexpr double glass = 0.35;
constexpr double infinity = std::numeric_limits<double>::infinity();

SeenSurface seen(const Layer& layer, bool shown) {
    return {layer.level, colour_of(layer), layer.opacity, shown};
}

void put_first(std::vector<SeenSurface>& surfaces, const Layers& layers, std::size_t from,
               bool shown) {
    std::vector<SeenSurface> all;
    for (std::size_t i = from; i < level_count(layers); ++i) {
        all.push_back(seen(layers.layers[i], shown));
    }
    surfaces.insert(surfaces.begin(), all.begin(), all.end());
}

/// The value that holds if neither a layer nor a curve gives one.
double of_session(HapticProperty property, const RendererSettings& settings) {
    using enum HapticProperty;
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

/// Samples of labels are their layer's number and 1; a label without a layer is 0.
void renumber(Layers& layers, const Layers& before) {
    if (!layers.labels) return;
    std::array<std::uint8_t, 256> to{};
    for (std::size_t i = level_count(before); i < before.layers.size(); ++i) {
        const auto labels = std::span(layers.layers).subspan(level_count(layers));
        const auto at = std::ranges::find(labels, before.layers[i].level, &Layer::level);
        const auto now = layers.layers.end() - (labels.end() - at);
        if (now == layers.layers.end()) continue;
        to[i + 1] = static_cast<std::uint8_t>(now - layers.layers.begin() + 1);
    }
    const Volume& volume = layers.labels->volume();
    const auto samples = volume.samples<std::uint8_t>();
    std::vector<std::uint8_t> numbers(samples.begin(), samples.end());
    for (std::uint8_t& number : numbers) number = to[number];
    layers.labels = std::make_shared<const Field>(Volume(volume.geometry(), std::move(numbers)),
                                                  Solid::above, 0.0);  // outside: no layer
}

Layer another(const Layers& layers, double level, const std::string& name) {
    static constexpr std::array<double, 3> colours[] = {{0.34, 0.56, 0.75}, {0.84, 0.37, 0.25},
                                                        {0.45, 0.65, 0.35}, {0.80, 0.62, 0.80},
                                                        {0.90, 0.80, 0.35}, {0.40, 0.70, 0.70}};
    Layer layer;
    layer.level = level;
    layer.colour = colours[layers.layers.size() % std::size(colours)];
    layer.opacity = glass;
    std::size_t number = layers.layers.size() + 1;
    do {
        layer.name = name + ' ' + std::to_string(number++);
    } while (std::ranges::count(layers.layers, layer.name, &Layer::name) > 0);
    return layer;
}

}  // namespace

Look scene_look(Look look, const SharedLayers& layers) {
    if (!have_surfaces(layers)) return look;
    if (levels_in(layers) == 0) {
        look.surface = false;
        return look;
    }
    const SeenSurface outer = seen(layers->layers.front(), look.surface);
    look.surface_colour = outer.colour;
    look.surface_opacity = outer.opacity;
    put_first(look.surfaces, *layers, 1, look.surface);
    return look;
}

Look slice_look(Look look, const SharedLayers& layers) {
    if (layers) put_first(look.surfaces, *layers, 0, true);
    return look;
}

std::string felt_words(const LayersFelt& felt, const SharedLayers& layers, const FeltWords& words) {
    if (!layers) return {};
    const int count = static_cast<int>(layers->layers.size());
    const auto name = [&](int layer) {
        return layers->layers[static_cast<std::size_t>(layer)].name;
    };
    const bool on = felt.touched >= 0 && felt.touched < count;
    const int innermost = std::min(static_cast<int>(felt.inside), count) - 1;
    const bool in_label = innermost >= 0 && is_label(*layers, std::size_t(innermost));
    const bool from_inside = in_label && felt.touched == innermost;
    // Labels do not nest.
    const int outermost = in_label ? innermost : 0;
    std::string inside;
    for (int layer = innermost; !from_inside && layer >= outermost; --layer) {
        inside += (inside.empty() ? "" : ", ") + name(layer);
    }
    if (!on && inside.empty()) return {};
    std::string text = from_inside ? words.from_inside : inside.empty() ? words.on : words.both;
    if (!on) text = words.in;
    const auto put = [&text](const std::string& place, const std::string& what) {
        if (const auto at = text.find(place); at != std::string::npos) text.replace(at, 2, what);
    };
    put("%2", inside);
    put("%1", on ? name(felt.touched) : inside);
    return text;
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
    for (std::size_t i = 0; i < level_count(layers); ++i) {
        const Layer& other = layers.layers[i];
        if (other.level < level) room.low = std::max(room.low, other.level + gap);
        if (other.level > level) room.high = std::min(room.high, other.level - gap);
    }
    return {std::min(room.low, level), std::max(room.high, level)};
}

double property_at(const Layers& layers, std::size_t layer, HapticProperty property,
                   const RendererSettings& settings) {
    const Layer& at = layers.layers[layer];
    if (at[property]) return *at[property];
    const Curve& curve = layers[property].density;
    if (!curve.knots.empty() && is_label(layers, layer)) {
        return std::ranges::max(curve.knots, {}, &Curve::Knot::value).value;
    }
    if (!curve.knots.empty()) return curve(at.level);
    return of_session(property, settings);
}

Curve::Knot first_knot(HapticProperty property, double at, const RendererSettings& settings) {
    const double value = of_session(property, settings);
    return {at, std::isfinite(value) ? value : 1};
}

std::optional<double> lowered_stiffness(const Layers& layers, std::size_t layer,
                                        const RendererSettings& settings) {
    using enum HapticProperty;
    ForceSettings force = settings.force;
    force.stiffness = property_at(layers, layer, stiffness, settings);
    force.damping = property_at(layers, layer, damping, settings);
    force.viscosity = property_at(layers, layer, viscosity, settings);
    // A label may have any other label as its neighbour.
    const std::size_t first = layers.by_label || layer == 0 ? 0 : layer - 1;
    const std::size_t end = layers.by_label ? layers.layers.size() : layer;
    if (first == 0) force.viscosity = std::max(force.viscosity, settings.force.viscosity);
    for (std::size_t i = first; i < end; ++i) {
        force.viscosity = std::max(force.viscosity, property_at(layers, i, viscosity, settings));
    }
    const double rendered = stable(force, settings.device).stiffness;
    return rendered < force.stiffness ? std::optional(rendered) : std::nullopt;
}

std::pair<Layers, std::size_t> with_another(Layers layers, Solid solid, double low, double high,
                                            const std::string& name) {
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
    const Layer added = another(layers, level, name);
    const double sign = solid == Solid::above ? 1 : -1;
    const auto behind = std::ranges::find_if(
        layers.layers, [&](const Layer& layer) { return sign * layer.level > sign * level; });
    const auto at = static_cast<std::size_t>(behind - layers.layers.begin());
    layers.layers.insert(behind, added);
    return {std::move(layers), at};
}

Layers moved_layer(Layers layers, std::size_t from, std::size_t to) {
    const Layer moved = layers.layers[from];
    const SharedLayers before = std::make_shared<const Layers>(layers);
    layers.layers.erase(layers.layers.begin() + static_cast<std::ptrdiff_t>(from));
    layers.layers.insert(layers.layers.begin() + static_cast<std::ptrdiff_t>(to), moved);
    renumber(layers, *before);
    return layers;
}

Layers without_layer(Layers layers, std::size_t layer) {
    const SharedLayers before = std::make_shared<const Layers>(layers);
    layers.layers.erase(layers.layers.begin() + static_cast<std::ptrdiff_t>(layer));
    if (layers.by_label && layer < layers.levels_beside_labels) --layers.levels_beside_labels;
    renumber(layers, *before);
    return layers;
}

Layers first_layer(double level, const std::string& name) {
    Layers layers;
    layers.name = "Own layers";
    Layer layer = another(layers, level, name);
    layer.opacity = 1;
    layers.layers.push_back(layer);
    return layers;
}

void LayersHistory::keep(const SharedLayers& before, bool goes_on) {
    future_.clear();
    if (goes_on && !past_.empty()) return;
    past_.push_back(before);
    bound();
}

/// The oldest steps go: where there are too many, or their labels take too much memory.
void LayersHistory::bound() {
    if (past_.size() > most) past_.erase(past_.begin());
    std::set<const Field*> labels;
    std::size_t bytes = 0;
    for (std::size_t i = past_.size(); i-- > 0;) {
        if (!past_[i] || !past_[i]->labels || !labels.insert(past_[i]->labels.get()).second) {
            continue;
        }
        bytes += static_cast<std::size_t>(sample_count(past_[i]->labels->geometry()));
        if (bytes <= most_labels_) continue;
        past_.erase(past_.begin(), past_.begin() + static_cast<std::ptrdiff_t>(i) + 1);
        return;
    }
}

std::optional<SharedLayers> LayersHistory::undo(const SharedLayers& now) {
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

namespace {

// Nearer to the last point than this nothing is added: a hand at rest adds nothing.
constexpr double unseen_mm = 0.01, unseen_newtons = 0.005;

}  // namespace

bool Stroke::add(const Snapshot& now) {
    const Tick& tick = now.session.tick;
    const bool jumped = begun_ && (tick.time < time_ || tick.time > time_ + pause);
    if (jumped) clear();
    time_ = tick.time;
    const bool felt = tick.layers.touched >= 0 || tick.layers.inside > 0;
    if (felt) inside_at_ = tick.time;
    if (!felt && (!begun_ || tick.time < inside_at_ + pause)) return jumped;
    if (!felt) {
        begun_ = false;  // what was felt stays until the next contact
        return jumped;
    }
    if (!tick.proxy.hip.allFinite() || !tick.proxy.scp.allFinite()) return jumped;
    if (!begun_) {
        if (tick.layers.touched < 0) return jumped;
        points_.clear();
        origin_ = tick.proxy.scp;
        const Vec3 pull = tick.proxy.hip - tick.proxy.scp;
        into_ = now.normal.norm() > 0.5 ? Vec3(-now.normal) : Vec3(pull.normalized());
        if (into_.dot(pull) < 0) into_ = -into_;  // met from inside
        begun_ = true;
    }
    const Point point{(tick.proxy.hip - origin_).dot(into_), tick.force.norm(),
                      tick.layers.touched};
    if (!points_.empty()) {
        const Point& last = points_.back();
        if (last.layer == point.layer && std::abs(last.depth - point.depth) < unseen_mm &&
            std::abs(last.force - point.force) < unseen_newtons) {
            return jumped;
        }
    }
    if (points_.size() >= most_points) points_.erase(points_.begin(), points_.begin() + 1000);
    points_.push_back(point);
    return true;
}

}  // namespace palpate::viewer
