// Levels and labels: what bounds the proxy, and which surface it touches.
#include "layers/tissues.hpp"

#include <algorithm>
#include <bit>
#include <limits>

#include "palpate/density.hpp"

namespace palpate {

LevelTissues::LevelTissues(const Layers& layers, LayerState& state, Proxy& proxy,
                           const Field& field)
    : layers_(layers),
      count_(static_cast<int>(layers.layers.size())),
      state_(state),
      proxy_(proxy),
      field_(field) {}

int LevelTissues::inside_at(double density) const {
    int inside = 0;
    while (inside < count_ &&
           field_.sign() * (density - level(inside)) > on_level * field_.range()) {
        ++inside;
    }
    return inside;
}

int LevelTissues::inside_at(const Vec3& physical) const {
    return inside_at(value_at(field_, physical));
}

void LevelTissues::begin(int inside) {
    state_.layer_count = count_;
    state_.inner = state_.outer = inside;
    state_.labels.reset();
    if (count_ == 0) proxy_.behind.reset();
}

NextLayers LevelTissues::bound() {
    if (count_ == 0) return {};
    const bool ahead = state_.inner<count_, behind = state_.outer> 0;
    proxy_.isovalue =
        ahead ? level(state_.inner) : field_.sign() * std::numeric_limits<double>::infinity();
    proxy_.behind.reset();
    if (behind) proxy_.behind = level(state_.outer - 1);
    return {ahead ? state_.inner : -1, behind ? state_.outer - 1 : -1};
}

int LevelTissues::touched(const ProxyUpdate& update) const {
    if (update.mode != Mode::constrained || count_ == 0) return -1;
    if (update.behind) return state_.outer - 1;
    return state_.inner < count_ ? state_.inner : -1;
}

int LevelTissues::inside(const ProxyUpdate& update) const {
    if (update.mode == Mode::constrained) return update.behind ? state_.outer : state_.inner;
    return std::clamp(inside_at(update.density), state_.outer, state_.inner);
}

int LevelTissues::beyond(const ProxyUpdate& update) const {
    return update.behind ? state_.outer - 2 : state_.inner;
}

void LevelTissues::open(const ProxyUpdate& update, const Vec3& at) {
    state_.opening[touched(update)] = at;
    update.behind ? --state_.outer : ++state_.inner;
}

void LevelTissues::close(const ProxyUpdate& update, double farthest) {
    for (int layer = state_.inner - 1; layer >= state_.outer; --layer) {
        if ((update.scp - state_.opening[layer]).norm() <= farthest) continue;
        if (inside(update) > layer) {
            state_.outer = layer + 1;
            return;
        }
        state_.inner = layer;
    }
}

double LevelTissues::density_at_surface(int layer) const {
    return layer >= 0 ? level(layer) : proxy_.isovalue;
}

LabelTissues::LabelTissues(const Layers& layers, LayerState& state, Proxy& proxy,
                           const Field& density)
    : layers_(layers),
      state_(state),
      open_label_(std::countr_zero(state.open)),
      data_proxy_(proxy),
      density_(density) {
    if (is_stale()) return;
    state_.labels->set_interpolation(density.interpolation());
}

bool LabelTissues::is_stale() const {
    return state_.layer_count != static_cast<int>(layers_.layers.size()) || !state_.labels ||
           state_.labels->shared_samples() != layers_.labels->shared_samples();
}

double LabelTissues::share(const Vec3& physical, std::uint32_t labels) const {
    Field& field = *state_.labels;
    field.show_labels(labels);
    const double value = value_at(field, physical);
    field.show_labels(all() & ~state_.open);
    return value;
}

int LabelTissues::largest(const Vec3& physical, std::uint32_t among) const {
    // std::has_single_bit() is a function call on most processors.
    const auto is_single = [&] { return (among & (among - 1)) == 0; };
    if (among == 0) return -1;
    if (is_single()) return std::countr_zero(among);
    const Vec3 index = index_from_physical(state_.labels->geometry(), physical);
    among &= state_.labels->labels_around((index.array() + 0.5).floor().matrix().cast<int>());
    if (among == 0) return -1;
    if (is_single()) return std::countr_zero(among);
    int best = -1;
    double most = 0;
    for (int label = 0; label <= static_cast<int>(layers_.layers.size()); ++label) {
        if (!(among >> label & 1U)) continue;
        const double of_label = share(physical, std::uint32_t{1} << label);
        if (of_label <= most) continue;
        most = of_label;
        best = label;
    }
    return best;
}

int LabelTissues::inside_at(const Vec3& physical) const {
    if (!state_.labels) return 0;
    return std::max(0, largest(physical, all()));
}

void LabelTissues::begin(int inside) {
    if (is_stale()) {
        state_.layer_count = static_cast<int>(layers_.layers.size());
        state_.labels = *layers_.labels;
        state_.labels->set_interpolation(density_.interpolation());
        state_.label_proxy = {};
        state_.label_proxy.isovalue = 0.5;
    }
    state_.open = std::uint32_t{1} << inside;
    state_.labels->show_labels(all() & ~state_.open);
    data_proxy_.behind.reset();
}

NextLayers LabelTissues::bound() {
    return {state_.touched, -1};
}

void LabelTissues::look(const ProxyUpdate& update) {
    const bool constrained = update.mode == Mode::constrained;
    open_label_ = std::max(0, largest(update.scp, state_.open));
    closed_label_ = constrained ? largest(update.scp, all() & ~state_.open) : -1;
}

int LabelTissues::touched(const ProxyUpdate& update) const {
    if (update.mode != Mode::constrained || closed_label_ < 0) return -1;
    // Between two layers it is the surface of the later one.
    return std::max(closed_label_, open_label_) - 1;
}

int LabelTissues::inside(const ProxyUpdate&) const {
    return open_label_;
}

int LabelTissues::beyond(const ProxyUpdate&) const {
    return closed_label_ - 1;
}

void LabelTissues::open(const ProxyUpdate&, const Vec3& at) {
    state_.open |= std::uint32_t{1} << closed_label_;
    state_.label_opening = at;
    state_.labels->show_labels(all() & ~state_.open);
}

void LabelTissues::close(const ProxyUpdate& update, double farthest) {
    if (!is_open() || (update.scp - state_.label_opening).norm() <= farthest) return;
    const std::uint32_t here = std::uint32_t{1} << inside(update);
    // Where three layers meet none may have half: there they stay open.
    if (share(update.scp, all() & ~here) > 0.5) return;
    state_.open = here;
    state_.labels->show_labels(all() & ~state_.open);
}

double LabelTissues::density_at_surface(int) const {
    return state_.label_proxy.placed ? value_at(density_, state_.label_proxy.scp_physical)
                                     : density_.background();
}

double LabelTissues::density_at_scp(const ProxyUpdate& update) const {
    return value_at(density_, update.scp);
}

void LabelTissues::finish() {
    const Proxy& moved = state_.label_proxy;
    data_proxy_.scp_physical = moved.scp_physical;
    data_proxy_.interpolation = density_.interpolation();
    data_proxy_.scp = locate(density_.interpolation(),
                             index_from_physical(density_.geometry(), moved.scp_physical));
    data_proxy_.mode = moved.mode;
    data_proxy_.placed = moved.placed;
    data_proxy_.sliding = moved.sliding;
}

}  // namespace palpate
