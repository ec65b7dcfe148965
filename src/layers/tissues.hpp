// Where the surfaces of layers lie, and which of them gave way: by levels of the density, or by
// labels. Both have the same members, and a tick is written for either.
#pragma once

#include "palpate/layers.hpp"

namespace palpate {

/// The layers before and behind the SCP, whose friction it may meet; -1: none.
struct NextLayers {
    int ahead = -1, behind = -1;
};

/// Surfaces are levels in order, so the SCP lies between two of them.
class LevelTissues {
  public:
    /// Inside a layer is inside all before it.
    static constexpr bool nested = true;

    LevelTissues(const Layers& layers, LayerState& state, Proxy& proxy, const Field& field);

    const Field& field() const { return field_; }
    Proxy& proxy() { return proxy_; }
    /// True where the state is that of other layers.
    bool is_stale() const { return state_.layer_count != count_; }
    /// How many layers a point is inside of.
    int inside_at(const Vec3& physical) const;
    /// Forgets what gave way: the SCP is inside this many layers.
    void begin(int inside);
    /// Writes into the proxy what it may not leave.
    NextLayers bound();
    /// To be called with each new update, before what follows.
    void look(const ProxyUpdate&) {}
    int touched(const ProxyUpdate& update) const;
    int inside(const ProxyUpdate& update) const;
    /// The layer on the other side of the surface touched; -1: none.
    int beyond(const ProxyUpdate& update) const;
    /// The surface touched gives way; `at` is where it counts as open.
    void open(const ProxyUpdate& update, const Vec3& at);
    /// Closes what gave way and is farther than this [mm] from the SCP.
    void close(const ProxyUpdate& update, double farthest);
    /// True while a surface that gave way has not closed.
    bool is_open() const { return state_.outer < state_.inner; }
    /// Density at a surface [data units].
    double density_at_surface(int layer) const;
    double density_at_scp(const ProxyUpdate& update) const { return update.density; }
    void finish() {}

  private:
    double level(int layer) const { return layers_.layers[layer].level; }
    int inside_at(double density) const;

    const Layers& layers_;
    const int count_;
    LayerState& state_;
    Proxy& proxy_;
    const Field& field_;
};

/// Surfaces are half levels of the smooth field of labels: 1 in the layers that the SCP may not be
/// in, 0 in the others.
class LabelTissues {
  public:
    static constexpr bool nested = false;

    LabelTissues(const Layers& layers, LayerState& state, Proxy& proxy, const Field& density);

    const Field& field() const { return *state_.labels; }
    Proxy& proxy() { return state_.label_proxy; }
    bool is_stale() const;
    /// One more than the layer that a point is in.
    int inside_at(const Vec3& physical) const;
    void begin(int inside);
    NextLayers bound();
    void look(const ProxyUpdate& update);
    int touched(const ProxyUpdate& update) const;
    int inside(const ProxyUpdate& update) const;
    int beyond(const ProxyUpdate& update) const;
    void open(const ProxyUpdate& update, const Vec3& at);
    void close(const ProxyUpdate& update, double farthest);
    bool is_open() const { return (state_.open & (state_.open - 1)) != 0; }
    double density_at_surface(int layer) const;
    double density_at_scp(const ProxyUpdate& update) const;
    /// Puts the proxy, which was moved on the lattice of the labels, on that of the data.
    void finish();

  private:
    /// Of these labels the one with the largest share of a point; -1: none has any.
    int largest(const Vec3& physical, std::uint32_t among) const;
    double share(const Vec3& physical, std::uint32_t labels) const;
    std::uint32_t all() const { return (std::uint32_t{2} << layers_.layers.size()) - 1; }

    const Layers& layers_;
    LayerState& state_;
    int open_label_ = 0;     // of those that the SCP may be in the one with the largest share
    int closed_label_ = -1;  // of the others; -1: nothing is touched
    Proxy& data_proxy_;
    const Field& density_;
};

}  // namespace palpate
