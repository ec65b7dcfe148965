// Layers as they are shown and edited: what is seen of them, what they are called, changes that
// keep their order, and the force along a stroke through them. Plain values.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/viewer/model/look.hpp"
#include "palpate/renderer.hpp"
#include "palpate/servo.hpp"

namespace palpate::viewer {

/// Null: no layers.
using SharedLayers = std::shared_ptr<const Layers>;

inline Colour colour_of(const palpate::Layer& layer) {
    return {layer.colour[0], layer.colour[1], layer.colour[2]};
}
/// How many of their surfaces, the first ones, are levels of the data, not labels.
inline std::size_t levels_in(const SharedLayers& layers) {
    return layers ? level_count(*layers) : 0;
}
/// By label, but where the labels lie is still to be read.
inline bool lack_labels(const SharedLayers& layers) {
    return layers && layers->by_label && !layers->labels;
}

/// The look with the surfaces of layers before those beside the felt one. In the scene the
/// outermost is the felt one, whose mesh is there already; slices have a contour of each. By label,
/// surfaces are those of the overlay, and the isovalue has none.
Look scene_look(Look look, const SharedLayers& layers);
Look slice_look(Look look, const SharedLayers& layers);

/// Sentences of felt_words(), in which %1 and %2 stand for names.
struct FeltWords {
    std::string on = "on %1", in = "in %1", both = "on %1, in %2";
    std::string from_inside = "on %1, from inside";
};

/// "on bone, in skin": the layer that is touched and those that the SCP is in, the innermost first.
/// Empty: none.
std::string felt_words(const LayersFelt& felt, const SharedLayers& layers,
                       const FeltWords& words = {});

/// Whether they are the same, in everything that files keep.
bool same(const SharedLayers& one, const SharedLayers& other);

/// A level between those of its neighbours, at least `gap` away; the old one if there is no room
/// [data units].
struct LevelRoom {
    double low, high;
};
LevelRoom room_of(const Layers& layers, std::size_t layer, double gap);

/// What a layer's surface feels like, without its gradient; where neither the layer nor a curve
/// says it, as the settings have it. A puncture force that nothing gives is infinite. By label, of
/// a curve its greatest value: the density at the surface is not the same everywhere.
double property_at(const Layers& layers, std::size_t layer, HapticProperty property,
                   const RendererSettings& settings);

/// A knot from which a curve begins, with the value that counts so far; of a puncture force that is
/// never 1 N.
Curve::Knot first_knot(HapticProperty property, double at, const RendererSettings& settings);

/// [N/mm] What the device renders of a layer's stiffness where it cannot render it stably with its
/// damping and the viscosity on either side.
std::optional<double> lowered_stiffness(const Layers& layers, std::size_t layer,
                                        const RendererSettings& settings);

/// One more, in the widest room that levels leave between `low` and `high` [data units]; glass.
/// `layers` must have room: fewer than Layers::most_layers. The second is its number.
/// `name` is followed by the number.
std::pair<Layers, std::size_t> with_another(Layers layers, Solid solid, double low, double high,
                                            const std::string& name);
/// The layer `from` at the place `to` in their order, or without it. By label, the places of labels
/// follow.
Layers moved_layer(Layers layers, std::size_t from, std::size_t to);
Layers without_layer(Layers layers, std::size_t layer);
Layers first_layer(double level, const std::string& name);

/// Values of layers to go back to, and forward again.
class LayersHistory {
  public:
    /// `most_labels` [bytes]: of all labels of steps to go back to.
    explicit LayersHistory(std::size_t most_labels = std::size_t{512} << 20)
        : most_labels_(most_labels) {}

    /// `before` has changed. `goes_on`: the change continues the last one (a drag), so that both
    /// are one step.
    void keep(const SharedLayers& before, bool goes_on);
    /// The value to take instead of `now`; nothing: there is none.
    std::optional<SharedLayers> undo(const SharedLayers& now);
    std::optional<SharedLayers> redo(const SharedLayers& now);
    bool can_undo() const { return !past_.empty(); }
    bool can_redo() const { return !future_.empty(); }
    void clear();

  private:
    void bound();

    static constexpr std::size_t most = 200;
    std::size_t most_labels_;
    std::vector<SharedLayers> past_, future_;
};

class Stroke {
  public:
    struct Point {
        double depth = 0;  ///< [mm, physical] of the hand along the stroke, from its first contact
        double force = 0;  ///< [N]
        int layer = -1;    ///< that is touched; -1: none
    };
    static constexpr std::size_t most_points = 20'000;
    static constexpr double pause = 2;  ///< [s] outside of all layers, after which another begins

    /// Takes a snapshot of a session with layers. True if the points have changed. The time of a
    /// recording that is played may jump: then the stroke begins anew.
    bool add(const Snapshot& now);
    void clear() { *this = {}; }
    const std::vector<Point>& points() const { return points_; }

  private:
    std::vector<Point> points_;
    Vec3 origin_ = Vec3::Zero();  // [mm, physical] the first contact
    Vec3 into_ = Vec3::Zero();    // unit, physical axes, into the solid
    double time_ = 0;             // [s] of the last tick
    double inside_at_ = 0;        // [s] when layers were felt last
    bool begun_ = false;
};

}  // namespace palpate::viewer
