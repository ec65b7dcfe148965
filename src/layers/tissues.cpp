// Finds the levels that bound the proxy in layers, and the layer that it touches.
#include "layers/tissues.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "layers/cover.hpp"
#include "palpate/field.hpp"
#include "proxy/update.hpp"

namespace palpate {
namespace {

/// Closer to a level than this [range], the SCP counts as outside of it.
constexpr double on_level = 1e-9;

constexpr double infinity_of(double sign) {
    return sign * std::numeric_limits<double>::infinity();
}

Index3 nearest_sample(const Field& field, const Vec3& physical) {
    const Vec3 index = index_from_physical(field.geometry(), physical);
    return (index.array() + 0.5).floor().matrix().cast<int>();
}

}  // namespace

bool keep_for(LayerState& state, const std::shared_ptr<const Layers>& after) noexcept {
    if (!state.set || !after) return false;
    const Layers& before = *state.set;
    const bool same = before.layers.size() == after->layers.size() &&
                      level_count(before) == level_count(*after) &&
                      before.by_label == after->by_label && before.labels == after->labels;
    if (same) state.set = after;
    return same;
}

void forget_layers(LayerState& state, Proxy& proxy, const Field& data) noexcept {
    const bool elsewhere = state.covered && !(state.covered->geometry() == data.geometry());
    state = {};
    proxy.behind.reset();
    proxy.turned = false;
    if (elsewhere && proxy.placed) put_on_lattice(proxy, data);
}

/// By labels: the field that the proxy touches, not covered yet.
static std::optional<Field> to_cover(const Layers& layers, const Field& density) {
    if (!layers.by_label || !layers.labels || layers.layers.empty()) return std::nullopt;
    Field field = level_count(layers) > 0 ? density : *layers.labels;
    field.set_interpolation(density.interpolation());
    return field;
}

void restore_set(LayerState& state, const std::shared_ptr<const Layers>& layers,
                 const Field& density) noexcept {
    if (!layers || state.layer_count != static_cast<int>(layers->layers.size())) {
        state = {};
        return;
    }
    state.set = layers;
    state.covered = to_cover(*layers, density);
    // Until the next tick.
    if (state.covered) LabelCover::put(*state.covered, layers->labels, 0, 0, 0);
}

Tissues::Tissues(const std::shared_ptr<const Layers>& layers, LayerState& state, Proxy& proxy,
                 const Field& density)
    : set_(layers),
      layers_(*layers),
      count_(static_cast<int>(layers_.layers.size())),
      levels_(static_cast<int>(level_count(layers_))),
      state_(state),
      proxy_(proxy),
      density_(density) {
    if (is_stale() || !state_.covered) return;
    Field& covered = *state_.covered;
    covered.set_interpolation(density.interpolation());
    if (levels_ > 0) {
        if (covered.shared_samples() != density.shared_samples()) {
            covered.use(density.shared_samples());
        }
        covered.set_time(density.time());
    }
    cover();
}

bool Tissues::is_stale() const {
    return state_.set != set_ || state_.layer_count != count_ || state_.level_count != levels_ ||
           state_.covered.has_value() != has_labels() ||
           (state_.covered && LabelCover::of(*state_.covered) != layers_.labels.get());
}

/// Levels of the density where no label is near. Labels that the SCP may be in lie before the level
/// ahead, the others as far beyond it: so the surface between two of them is the half level.
Tissues::Bounds Tissues::bounds() const {
    if (state_.covered && levels_ == 0) return {.ahead = 0.5, .behind = {}, .open = 0, .solid = 1};
    const double sign = density_.sign();
    Bounds bounds;
    bounds.ahead = has_level_ahead() ? level(state_.inner) : infinity_of(sign);
    if (may_be_in(0) && state_.outer > 0) bounds.behind = level(state_.outer - 1);
    if (!state_.covered) return bounds;
    double half = 0.5 * sign * density_.range();
    if (!has_level_ahead()) {
        const Samples& samples = density_.samples();
        bounds.ahead = (sign > 0 ? samples.maximum() : samples.minimum()) + half;
    }
    if (bounds.behind) half = 0.5 * (bounds.ahead - *bounds.behind);
    bounds.open = bounds.ahead - half;
    bounds.solid = bounds.ahead + half;
    return bounds;
}

void Tissues::cover() {
    if (!state_.covered) return;
    const std::uint32_t all = (std::uint32_t{2} << count_) - 1;
    const Bounds now = bounds();
    LabelCover::put(*state_.covered, layers_.labels, all & ~state_.open, now.open, now.solid);
}

/// Whether an update would leave the SCP where it is, as far as solids go.
bool Tissues::is_free() const {
    const Field& now = field();
    const Bounds bound = bounds();
    const bool cubic = now.interpolation() == Interpolation::cubic;
    // A hair less than the excess at which a cubic site counts as inside.
    const double most = cubic ? 1.9e-11 * now.range() : now.tolerance();
    const double value = value_at(now, scp_in(now, proxy_));
    return now.sign() * (value - bound.ahead) <= most &&
           !(bound.behind && now.sign() * (*bound.behind - value) > most);
}

/// Changes what is open if the SCP is free then.
template <class Change>
bool Tissues::change_where_free(Change&& change) {
    const auto [open, outer, inner] = std::tuple(state_.open, state_.outer, state_.inner);
    change();
    cover();
    // Levels alone: what opens is next to the SCP, and what closes is where it is not.
    if (!state_.covered || is_free()) return true;
    state_.open = open;
    state_.outer = outer;
    state_.inner = inner;
    cover();
    return false;
}

Tissues::Shares Tissues::shares_at(const Vec3& physical) const {
    const Field& now = field();
    const Vec3 index = index_from_physical(now.geometry(), physical);
    const Index3 nearest = nearest_sample(now, physical);
    Neighbours densities{};
    if (levels_ > 0) densities = density_.around(nearest);
    const auto labels = LabelCover::around(now, nearest);
    const double ahead = bounds().ahead;
    Mat3 along;  // of the three samples along each axis
    for (int a = 0; a < 9; ++a) {
        along(a % 3, a / 3) =
            std::max(0.0, 1.5 - std::abs(index[a / 3] - nearest[a / 3] + 1 - a % 3));
    }
    Shares shares;
    for (int i = 0; i < 27; ++i) {
        const double weight = along(i % 3, 0) * along(i / 3 % 3, 1) * along(i / 9, 2);
        if (weight == 0) continue;
        shares.of[labels[i]] += weight;
        if (labels[i] > 0 || levels_ == 0) continue;
        const double density = density_.with_offset(densities[static_cast<std::size_t>(i)]);
        if (density_.sign() * (density - ahead) > 0) shares.beyond += weight;
        shares.inside[static_cast<std::size_t>(inside_at(density))] += weight;
    }
    return shares;
}

/// The one of these tissues (bits as in LayerState::open) with the largest share. -1: none has any.
int Tissues::largest(const Shares& shares, std::uint32_t among) const {
    int best = -1;
    double most = 0;
    for (std::size_t tissue = 0; tissue <= layers_.layers.size(); ++tissue) {
        if (!(among >> tissue & 1U) || !(shares.of[tissue] > most)) continue;
        most = shares.of[tissue];
        best = static_cast<int>(tissue);
    }
    return best;
}

int Tissues::inside_at(double density) const {
    int inside = 0;
    const double least = on_level * density_.range();
    while (inside < levels_ && density_.sign() * (density - level(inside)) > least) ++inside;
    return inside;
}

int Tissues::without_labels_at(const Vec3& physical) const {
    return levels_ > 0 ? inside_at(value_at(density_, physical)) : 0;
}

int Tissues::inside_at(const Vec3& physical) {
    const int label = state_.covered ? largest(shares_at(physical), ~std::uint32_t{0}) : 0;
    return label > 0 ? label : without_labels_at(physical);
}

/// Nobody comes from a label behind a level that never gives way.
int Tissues::first_to_hold() const {
    int first = 0;
    const auto gives_way = [this](int layer) {
        return std::isfinite(property_of(layers_, layer, HapticProperty::puncture_force,
                                         level(layer), 0, std::numeric_limits<double>::infinity()));
    };
    while (first < levels_ && gives_way(first)) ++first;
    return first;
}

void Tissues::begin(int inside) {
    if (is_stale()) {
        forget_layers(state_, proxy_, density_);
        state_.set = set_;
        state_.layer_count = count_;
        state_.level_count = levels_;
        state_.covered = to_cover(layers_, density_);
        if (state_.covered && levels_ == 0 && proxy_.placed) {
            put_on_lattice(proxy_, *state_.covered);
        }
    }
    const bool in_label = inside > levels_;
    state_.open = in_label ? std::uint32_t{1} << inside : 1;
    state_.inner = state_.outer = in_label ? 0 : inside;
    if (count_ == 0) proxy_.behind.reset();
    cover();
}

NextLayers Tissues::bound() {
    if (count_ == 0) return {};
    const Bounds now = bounds();
    proxy_.isovalue = now.ahead;
    proxy_.behind = now.behind;
    const int behind = now.behind ? state_.outer - 1 : -1;
    const int next = has_level_ahead() ? state_.inner : -1;
    // Which label is ahead is known when it is touched: until then, that of the last tick.
    const bool touched_ahead = state_.covered && state_.touched >= 0 && state_.touched != behind;
    return {touched_ahead ? state_.touched : next, behind};
}

void Tissues::look(const ProxyUpdate& update) {
    const bool meets_ahead = update.mode == Mode::constrained && !update.behind;
    here_ = 0;
    ahead_ = none;
    if (!state_.covered || !LabelCover::is_near(field(), nearest_sample(field(), update.scp))) {
        if (meets_ahead) ahead_ = !may_be_in(0) ? 0 : has_level_ahead() ? at_level : none;
        return;
    }
    const Shares shares = shares_at(update.scp);
    here_ = std::max(0, largest(shares, state_.open));
    if (!meets_ahead) return;
    ahead_ = largest(shares, ~state_.open);
    const double share = ahead_ >= 0 ? shares.of[static_cast<std::size_t>(ahead_)] : 0;
    if (has_level_ahead() && (ahead_ < 0 || shares.beyond > share)) ahead_ = at_level;
}

int Tissues::touched(const ProxyUpdate& update) const {
    if (update.mode != Mode::constrained || (!update.behind && ahead_ == none)) return -1;
    if (update.behind) return state_.outer - 1;
    if (ahead_ == at_level) return state_.inner;
    // Between two labels it is the surface of the later one.
    return std::max(ahead_, here_) - 1;
}

int Tissues::inside(const ProxyUpdate& update) const {
    if (here_ > 0 || state_.outer == state_.inner) return here_ > 0 ? here_ : state_.inner;
    if (update.mode == Mode::constrained && update.behind) return state_.outer;
    if (update.mode == Mode::constrained && ahead_ == at_level) return state_.inner;
    return std::clamp(inside_at(update.density), state_.outer, state_.inner);
}

int Tissues::beyond(const ProxyUpdate& update) const {
    if (update.behind) return state_.outer - 2;
    if (ahead_ == at_level) return state_.inner;
    return (ahead_ > 0 ? ahead_ : without_labels_at(update.scp)) - 1;
}

bool Tissues::open(const ProxyUpdate& update, const Vec3& at) {
    if (update.behind || ahead_ == at_level) {
        const auto layer = static_cast<std::size_t>(touched(update));
        const bool opened =
            change_where_free([&] { update.behind ? --state_.outer : ++state_.inner; });
        if (opened) state_.opening[layer] = at;
        return opened;
    }
    const bool opened = ahead_ == 0 && levels_ > 0
                            ? leave_labels(shares_at(update.scp))
                            : change_where_free([&] { state_.open |= std::uint32_t{1} << ahead_; });
    if (opened) state_.label_opening = at;
    return opened;
}

/// From labels to where none is given: between those two levels between which most of the samples
/// there are, of those where the SCP is free.
bool Tissues::leave_labels(const Shares& shares) {
    const int most = first_to_hold();
    std::array<bool, Layers::most_layers + 1> tried{};
    for (int n = 0; n <= most; ++n) {
        int best = -1;
        for (int i = 0; i <= most; ++i) {
            const auto k = static_cast<std::size_t>(i);
            if (tried[k] || !(shares.inside[k] > 0)) continue;
            if (best < 0 || shares.inside[k] > shares.inside[static_cast<std::size_t>(best)])
                best = i;
        }
        if (best < 0) return false;
        tried[static_cast<std::size_t>(best)] = true;
        const auto go_there = [&] {
            state_.open |= 1U;
            state_.inner = state_.outer = best;
        };
        if (change_where_free(go_there)) return true;
    }
    return false;
}

void Tissues::close(const ProxyUpdate& update, double farthest) {
    close_labels(update, farthest);
    if (here_ > 0 || !may_be_in(0)) return;
    for (int layer = state_.inner - 1; layer >= state_.outer; --layer) {
        const Vec3& at = state_.opening[static_cast<std::size_t>(layer)];
        if ((update.scp - at).norm() <= farthest) continue;
        const bool beyond = inside(update) > layer;
        const bool closed =
            change_where_free([&] { beyond ? state_.outer = layer + 1 : state_.inner = layer; });
        if (closed && beyond) return;
    }
}

/// All but what the SCP is in. Where three tissues meet none may have half: there they stay open.
void Tissues::close_labels(const ProxyUpdate& update, double farthest) {
    const bool open = (state_.open & (state_.open - 1)) != 0;
    if (!open || (update.scp - state_.label_opening).norm() <= farthest) return;
    change_where_free([&] { state_.open = std::uint32_t{1} << here_; });
}

double Tissues::density_at_surface(int layer) const {
    if (layer >= 0 && layer < levels_) return level(layer);
    if (!state_.covered) return proxy_.isovalue;
    return proxy_.placed ? value_at(density_, proxy_.scp_physical) : density_.background();
}

}  // namespace palpate
