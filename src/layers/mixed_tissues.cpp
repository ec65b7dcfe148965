// Levels beside labels: what bounds the proxy, and which of both it touches.
#include <algorithm>
#include <cmath>
#include <limits>

#include "layers/tissues.hpp"
#include "palpate/density.hpp"

namespace palpate {

MixedTissues::MixedTissues(const Layers& layers, LayerState& state, Proxy& proxy,
                           const Field& density)
    : layers_(layers),
      levels_(static_cast<int>(layers.levels_beside_labels)),
      state_(state),
      proxy_(proxy),
      density_(density) {
    if (is_stale()) return;
    Field& both = *state_.labels;
    if (both.shared_samples() != density.shared_samples()) both.use(density.shared_samples());
    both.set_time(density.time());
    both.set_interpolation(density.interpolation());
    cover();
}

bool MixedTissues::is_stale() const {
    return state_.layer_count != static_cast<int>(layers_.layers.size()) || !state_.labels ||
           state_.labels->covering_labels() != layers_.labels.get();
}

/// Labels that the SCP may be in lie before the level ahead, the others as far beyond it: so the
/// surface between two of them is the half level.
MixedTissues::Bounds MixedTissues::bounds() const {
    const double sign = density_.sign();
    Bounds bounds;
    double half = 0.5 * sign * density_.range();
    const Samples& samples = density_.samples();
    const double most = sign > 0 ? samples.maximum() : samples.minimum();
    const bool has_level = may_be_in(0) && state_.inner < levels_;
    bounds.ahead = has_level ? level(state_.inner) : most + half;
    if (may_be_in(0) && state_.outer > 0) {
        bounds.behind = level(state_.outer - 1);
        half = 0.5 * (bounds.ahead - *bounds.behind);
    }
    bounds.open = bounds.ahead - half;
    bounds.solid = bounds.ahead + half;
    return bounds;
}

void MixedTissues::cover() {
    const std::uint32_t all = (std::uint32_t{2} << layers_.layers.size()) - 1;
    const Bounds now = bounds();
    state_.labels->cover(layers_.labels, all & ~state_.open, now.open, now.solid);
}

MixedTissues::Shares MixedTissues::shares_at(const Vec3& physical) const {
    const Vec3 index = index_from_physical(density_.geometry(), physical);
    const Index3 nearest = (index.array() + 0.5).floor().matrix().cast<int>();
    const Neighbours densities = density_.around(nearest);
    const double ahead = bounds().ahead - density_.offset();
    Shares shares;
    for (int i = 0; i < 27; ++i) {
        const Index3 at = nearest + Index3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
        const Vec3 away = (index - at.cast<double>()).cwiseAbs();
        const double weight = (1.5 - away.array()).max(0).prod();
        const int label = state_.labels->covering_label(at);
        shares.of[static_cast<std::size_t>(label)] += weight;
        const double excess = density_.sign() * (densities[static_cast<std::size_t>(i)] - ahead);
        if (label == 0 && excess > 0) shares.beyond += weight;
    }
    return shares;
}

/// Of these tissues (bits as in LayerState::open) the one with the largest share; -1: none has any.
int MixedTissues::largest(const Shares& shares, std::uint32_t among) const {
    int best = -1;
    double most = 0;
    for (std::size_t tissue = 0; tissue <= layers_.layers.size(); ++tissue) {
        if (!(among >> tissue & 1U) || !(shares.of[tissue] > most)) continue;
        most = shares.of[tissue];
        best = static_cast<int>(tissue);
    }
    return best;
}

int MixedTissues::without_labels_at(const Vec3& physical) const {
    const double density = value_at(density_, physical);
    int inside = 0;
    const double least = on_level * density_.range();
    while (inside < levels_ && density_.sign() * (density - level(inside)) > least) ++inside;
    return inside;
}

/// Nobody comes from a label behind a level that never gives way.
int MixedTissues::first_to_hold() const {
    int first = 0;
    const auto gives_way = [this](int layer) {
        return std::isfinite(property_of(layers_, layer, HapticProperty::puncture_force,
                                         level(layer), 0, std::numeric_limits<double>::infinity()));
    };
    while (first < levels_ && gives_way(first)) ++first;
    return first;
}

int MixedTissues::inside_at(const Vec3& physical) const {
    const int label = std::max(0, largest(shares_at(physical), ~std::uint32_t{0}));
    return label > 0 ? label : without_labels_at(physical);
}

void MixedTissues::begin(int inside) {
    if (is_stale()) {
        state_.layer_count = static_cast<int>(layers_.layers.size());
        state_.labels = density_;
    }
    const bool in_label = inside > levels_;
    state_.open = in_label ? std::uint32_t{1} << inside : 1;
    state_.inner = state_.outer = in_label ? 0 : inside;
    cover();
}

NextLayers MixedTissues::bound() {
    const Bounds now = bounds();
    proxy_.isovalue = now.ahead;
    proxy_.behind = now.behind;
    const int behind = now.behind ? state_.outer - 1 : -1;
    const int next = may_be_in(0) && state_.inner < levels_ ? state_.inner : -1;
    // Which surface is ahead is known when it is touched: until then, that of the last tick.
    const bool touched_ahead = state_.touched >= 0 && state_.touched != behind;
    return {touched_ahead ? state_.touched : next, behind};
}

void MixedTissues::look(const ProxyUpdate& update) {
    const bool meets_ahead = update.mode == Mode::constrained && !update.behind;
    const bool has_level = may_be_in(0) && state_.inner < levels_;
    const Vec3 index = index_from_physical(density_.geometry(), update.scp);
    const Index3 nearest = (index.array() + 0.5).floor().matrix().cast<int>();
    here_ = 0;
    ahead_ = none;
    if (!state_.labels->is_covered_around(nearest)) {
        if (meets_ahead) ahead_ = !may_be_in(0) ? 0 : has_level ? at_level : none;
        return;
    }
    const Shares shares = shares_at(update.scp);
    here_ = std::max(0, largest(shares, state_.open));
    if (!meets_ahead) return;
    ahead_ = largest(shares, ~state_.open);
    const double share = ahead_ >= 0 ? shares.of[static_cast<std::size_t>(ahead_)] : 0;
    if (has_level && (ahead_ < 0 || shares.beyond > share)) ahead_ = at_level;
}

int MixedTissues::touched(const ProxyUpdate& update) const {
    if (update.mode != Mode::constrained || (!update.behind && ahead_ == none)) return -1;
    if (update.behind) return state_.outer - 1;
    if (ahead_ == at_level) return state_.inner;
    // Between two labels it is the surface of the later one.
    return std::max(ahead_, here_) - 1;
}

int MixedTissues::inside(const ProxyUpdate& update) const {
    if (here_ > 0 || state_.outer == state_.inner) return here_ > 0 ? here_ : state_.inner;
    if (update.mode == Mode::constrained && update.behind) return state_.outer;
    if (update.mode == Mode::constrained && ahead_ == at_level) return state_.inner;
    return std::clamp(without_labels_at(update.scp), state_.outer, state_.inner);
}

int MixedTissues::beyond(const ProxyUpdate& update) const {
    if (update.behind) return state_.outer - 2;
    if (ahead_ == at_level) return state_.inner;
    return (ahead_ > 0 ? ahead_ : without_labels_at(update.scp)) - 1;
}

void MixedTissues::open(const ProxyUpdate& update, const Vec3& at) {
    if (update.behind || ahead_ == at_level) {
        state_.opening[static_cast<std::size_t>(touched(update))] = at;
        update.behind ? --state_.outer : ++state_.inner;
    } else {
        state_.label_opening = at;
        state_.open |= std::uint32_t{1} << ahead_;
        if (ahead_ == 0) {
            state_.inner = state_.outer = std::min(without_labels_at(update.scp), first_to_hold());
        }
    }
    cover();
}

void MixedTissues::close(const ProxyUpdate& update, double farthest) {
    close_labels(update, farthest);
    if (here_ > 0 || !may_be_in(0)) return;
    for (int layer = state_.inner - 1; layer >= state_.outer; --layer) {
        const Vec3& at = state_.opening[static_cast<std::size_t>(layer)];
        if ((update.scp - at).norm() <= farthest) continue;
        if (inside(update) > layer) {
            state_.outer = layer + 1;
            break;
        }
        state_.inner = layer;
    }
    cover();
}

/// All but what the SCP is in.
void MixedTissues::close_labels(const ProxyUpdate& update, double farthest) {
    const bool open = (state_.open & (state_.open - 1)) != 0;
    if (!open || (update.scp - state_.label_opening).norm() <= farthest) return;
    const std::uint32_t before = state_.open;
    state_.open = std::uint32_t{1} << here_;
    cover();
    const double excess = value_at(*state_.labels, update.scp) - bounds().ahead;
    // Where three tissues meet none may have half: there they stay open.
    if (density_.sign() * excess > density_.tolerance()) state_.open = before;
    cover();
}

double MixedTissues::density_at_surface(int layer) const {
    if (layer >= 0 && layer < levels_) return level(layer);
    return proxy_.placed ? value_at(density_, proxy_.scp_physical) : density_.background();
}

double MixedTissues::density_at_scp(const ProxyUpdate& update) const {
    return value_at(density_, update.scp);
}

}  // namespace palpate
