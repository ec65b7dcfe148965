// Where the surfaces of layers lie, and which of them gave way: by levels of the density, by
// labels, or by both. All have the same members, and a tick is written for each.
#pragma once

#include "palpate/layers.hpp"

namespace palpate {

/// Closer to a level than this [range], the SCP counts as outside of it.
inline constexpr double on_level = 1e-9;

/// The layers before and behind the SCP, whose friction it may meet; -1: none.
struct NextLayers {
    int ahead = -1, behind = -1;
};

/// Surfaces are levels in order, so the SCP lies between two of them.
class LevelTissues {
  public:
    LevelTissues(const Layers& layers, LayerState& state, Proxy& proxy, const Field& field);

    /// Inside one of so many layers, the first ones, is inside all before it.
    int nested() const { return count_; }
    const Field& field() const { return field_; }
    Proxy& proxy() { return proxy_; }
    /// True where the state is that of other layers.
    bool is_stale() const { return state_.layer_count != count_; }
    /// How many layers a point is inside of.
    int inside_at(const Vec3& physical) const;
    /// The same without layers that do not nest.
    int without_labels_at(const Vec3& physical) const { return inside_at(physical); }
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
    LabelTissues(const Layers& layers, LayerState& state, Proxy& proxy, const Field& density);

    int nested() const { return 0; }
    const Field& field() const { return *state_.labels; }
    Proxy& proxy() { return state_.label_proxy; }
    bool is_stale() const;
    /// One more than the layer that a point is in.
    int inside_at(const Vec3& physical) const;
    int without_labels_at(const Vec3&) const { return 0; }
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

/// Surfaces are levels of the density where no label is given, and labels elsewhere: levels of one
/// field of both, on the lattice of the data (Field::cover).
class MixedTissues {
  public:
    MixedTissues(const Layers& layers, LayerState& state, Proxy& proxy, const Field& density);

    int nested() const { return levels_; }
    const Field& field() const { return *state_.labels; }
    Proxy& proxy() { return proxy_; }
    bool is_stale() const;
    int inside_at(const Vec3& physical) const;
    int without_labels_at(const Vec3& physical) const;
    void begin(int inside);
    NextLayers bound();
    void look(const ProxyUpdate& update);
    int touched(const ProxyUpdate& update) const;
    int inside(const ProxyUpdate& update) const;
    int beyond(const ProxyUpdate& update) const;
    void open(const ProxyUpdate& update, const Vec3& at);
    void close(const ProxyUpdate& update, double farthest);
    bool is_open() const {
        return (state_.open & (state_.open - 1)) != 0 ||
               (may_be_in(0) && state_.outer < state_.inner);
    }
    double density_at_surface(int layer) const;
    double density_at_scp(const ProxyUpdate& update) const;
    void finish() {}

  private:
    struct Bounds {
        double ahead = 0;  // levels of the field of both [data units]
        std::optional<double> behind;
        double open = 0, solid = 0;  // labels that the SCP may be in, and the others
    };
    /// Of the samples round a point, the nearer the more.
    struct Shares {
        std::array<double, 32> of{};  // by label; 0: without one
        double beyond = 0;            // without one and beyond the level ahead
    };
    static constexpr int none = -1, at_level = -2;

    bool may_be_in(int tissue) const { return (state_.open >> tissue & 1U) != 0; }
    double level(int layer) const { return layers_.layers[static_cast<std::size_t>(layer)].level; }
    Bounds bounds() const;
    void cover();
    Shares shares_at(const Vec3& physical) const;
    int largest(const Shares& shares, std::uint32_t among) const;
    int first_to_hold() const;
    void close_labels(const ProxyUpdate& update, double farthest);

    const Layers& layers_;
    const int levels_;
    LayerState& state_;
    Proxy& proxy_;
    const Field& density_;
    int here_ = 0;      // the label that the SCP is in; 0: none
    int ahead_ = none;  // the label touched, none, or the level ahead
};

}  // namespace palpate
