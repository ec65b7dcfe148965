// The surfaces of layers, and which of them gave way: levels of the density, labels, or both.
// At any moment one field with a level ahead and perhaps one behind is solid where the SCP
// may not be; all questions are put to that field (docs/layers.md).
#pragma once

#include "palpate/field.hpp"
#include "palpate/layers.hpp"

namespace palpate {

/// The layers before and behind the SCP, whose friction it may meet; -1: none.
struct NextLayers {
    int ahead = -1, behind = -1;
};

/// Makes a state that has lost its set and its covered field one of these layers again; null, or a
/// state of no set: it begins anew.
void restore_set(LayerState& state, const std::shared_ptr<const Layers>& layers,
                 const Field& density) noexcept;

/// Levels nest, so the SCP lies between two of them. Labels cover the density: those that the SCP
/// may be in count as free, the others as solid.
class Tissues {
  public:
    Tissues(const std::shared_ptr<const Layers>& layers, LayerState& state, Proxy& proxy,
            const Field& density);

    /// Inside one of so many layers, the first ones, is inside all before it.
    int nested() const { return levels_; }
    /// What the proxy touches.
    const Field& field() const { return state_.covered ? *state_.covered : density_; }
    Proxy& proxy() { return proxy_; }
    /// True where the state is that of other layers.
    bool is_stale() const;
    /// How many layers a point is inside of; in a label, one more than that.
    int inside_at(const Vec3& physical);
    /// The same by levels alone.
    int without_labels_at(const Vec3& physical) const;
    /// Forgets what gave way: the SCP is inside this many layers.
    void begin(int inside);
    /// Writes into the proxy what it may not leave.
    NextLayers bound();
    /// To be called with each new update, before what follows.
    void look(const ProxyUpdate& update);
    int touched(const ProxyUpdate& update) const;
    int inside(const ProxyUpdate& update) const;
    /// The layer on the other side of the surface touched; -1: none.
    int beyond(const ProxyUpdate& update) const;
    /// The surface touched gives way; `at` is where it counts as open. False, and nothing changes,
    /// where the SCP would not be free.
    bool open(const ProxyUpdate& update, const Vec3& at);
    /// Closes what gave way and is farther than this [mm] from the SCP, as far as the SCP stays
    /// free. So it is moved neither by what opens nor by what closes, and no spring gains energy.
    void close(const ProxyUpdate& update, double farthest);
    /// True while a surface that gave way has not closed.
    bool is_open() const {
        return (state_.open & (state_.open - 1)) != 0 ||
               (may_be_in(0) && state_.outer < state_.inner);
    }
    /// Density of the data at a surface [data units].
    double density_at_surface(int layer) const;
    double density_at_scp(const ProxyUpdate& update) const {
        return state_.covered ? value_at(density_, update.scp) : update.density;
    }

  private:
    struct Bounds {
        double ahead = 0;  // levels of field() [data units]
        std::optional<double> behind;
        double open = 0, solid = 0;  // labels that the SCP may be in, and the others
    };
    /// Of the samples round a point, the nearer the more.
    struct Shares {
        std::array<double, 32> of{};  // by label; 0: without one
        double beyond = 0;            // without one and beyond the level ahead
        std::array<double, Layers::most_layers + 1> inside{};  // without one, inside so many levels
    };
    static constexpr int none = -1, at_level = -2;

    bool has_labels() const { return layers_.by_label && layers_.labels && count_ > 0; }
    bool may_be_in(int tissue) const { return (state_.open >> tissue & 1U) != 0; }
    bool has_level_ahead() const { return may_be_in(0) && state_.inner < levels_; }
    double level(int layer) const { return layers_.layers[static_cast<std::size_t>(layer)].level; }
    int inside_at(double density) const;
    Bounds bounds() const;
    void cover();
    bool is_free() const;
    template <class Change>
    bool change_where_free(Change&& change);
    Shares shares_at(const Vec3& physical) const;
    int largest(const Shares& shares, std::uint32_t among) const;
    int first_to_hold() const;
    bool leave_labels(const Shares& shares);
    void close_labels(const ProxyUpdate& update, double farthest);

    const std::shared_ptr<const Layers>& set_;
    const Layers& layers_;
    const int count_, levels_;
    LayerState& state_;
    Proxy& proxy_;
    const Field& density_;
    int here_ = 0;      // the label that the SCP is in; 0: none
    int ahead_ = none;  // the label touched, none, or the level ahead
};

}  // namespace palpate
