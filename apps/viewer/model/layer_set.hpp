// Layers as they are shown and edited: what is seen of them, what they are called, and changes that
// keep their order. Plain values.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/viewer/model/look.hpp"
#include "palpate/renderer.hpp"

namespace palpate::viewer {

/// Null: no layers.
using SharedLayers = std::shared_ptr<const Layers>;

inline bool have_surfaces(const SharedLayers& layers) {
    return layers && !layers->layers.empty();
}

/// The look with the surfaces of layers before those beside the felt one. In the scene the
/// outermost is the felt one, whose mesh is there already; slices have a contour of each.
Look scene_look(Look look, const SharedLayers& layers);
Look slice_look(Look look, const SharedLayers& layers);

/// "on bone, in skin": the layer that is touched and those that the SCP is in, the innermost first.
/// Empty: none.
std::string felt_words(const LayersFelt& felt, const SharedLayers& layers);

/// Whether they are the same, in everything that files keep.
bool same(const SharedLayers& one, const SharedLayers& other);

/// A level between those of its neighbours, at least `gap` away; the old one if there is no room
/// [data units].
struct LevelRoom {
    double low, high;
};
LevelRoom room_of(const Layers& layers, std::size_t layer, double gap);

/// What a layer's surface feels like, without its gradient; where neither the layer nor a curve
/// says it, as the settings have it. A puncture force that nothing gives is infinite.
double property_at(const Layers& layers, std::size_t layer, HapticProperty property,
                   const RendererSettings& settings);

/// [N/mm] What the device renders of a layer's stiffness where it cannot render it stably with its
/// damping and the viscosity on either side.
std::optional<double> lowered_stiffness(const Layers& layers, std::size_t layer,
                                        const RendererSettings& settings);

/// One more, in the widest room that levels leave between `low` and `high` [data units]; glass.
/// `layers` must have room: fewer than Layers::most_layers. The second is its number.
std::pair<Layers, std::size_t> with_another(Layers layers, Solid solid, double low, double high);
/// A set of one layer at this level.
Layers first_layer(double level);

/// Values of layers to go back to, and forward again.
class LayersHistory {
  public:
    /// `now` is about to change. `goes_on`: the change continues the last one (a drag), so that
    /// both are one step.
    void keep(const SharedLayers& now, bool goes_on);
    /// The value to take instead of `now`; nothing: there is none.
    std::optional<SharedLayers> undo(const SharedLayers& now);
    std::optional<SharedLayers> redo(const SharedLayers& now);
    bool can_undo() const { return !past_.empty(); }
    bool can_redo() const { return !future_.empty(); }
    void clear();

  private:
    static constexpr std::size_t most = 200;
    std::vector<SharedLayers> past_, future_;
};

}  // namespace palpate::viewer
