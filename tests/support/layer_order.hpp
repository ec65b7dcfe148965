// Judges a renderer with layers from the outside, tick by tick, by the exact lowest and highest
// density on each straight piece of the proxy's path. Only surfaces that gave way are passed, and
// only surfaces that were touched and pressed give way.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "palpate/renderer.hpp"
#include "support/cubic_guarantees.hpp"
#include "support/fields.hpp"
#include "support/layer.hpp"
#include "support/paper_lattice.hpp"

namespace palpate::support {

/// Surfaces at these parts of a field's range from its isovalue, with the same stiffness.
struct LayerPlan {
    std::vector<double> parts, forces;
    std::vector<double> stiffnesses;
    double static_friction = 0;
};
inline Layers planned_layers(const TestField& test, const LayerPlan& plan) {
    Layers layers;
    for (std::size_t i = 0; i < plan.parts.size(); ++i) {
        const double off = plan.parts[i] * test.field.range() * test.field.sign();
        Layer layer = layer_of("layer " + std::to_string(i), test.isovalue + off,
                               plan.stiffnesses[i], plan.forces[i]);
        layer[HapticProperty::static_friction] = plan.static_friction;
        layer[HapticProperty::dynamic_friction] = 0.8 * plan.static_friction;
        layers.layers.push_back(layer);
    }
    return layers;
}

struct LayerTally {
    int ticks = 0, ahead = 0, behind = 0, recovering = 0, out_of_budget = 0, most_pieces = 0;
    int punctures = 0, outward = 0, several = 0, closings = 0, forces_known = 0;
    double worst = -1;  ///< how far a path left what was open [range]
};

class LayerOrder {
  public:
    LayerOrder(const Field& field, const Layers& layers)
        : layers_(layers), random_(77), renderer_(made(field, layers)) {
        for (const Layer& l : layers.layers) {
            uniform_ &=
                l[HapticProperty::stiffness] == layers.layers[0][HapticProperty::stiffness] &&
                l[HapticProperty::static_friction] == 0.0;
        }
    }

    /// One tick, judged. Stop at the first failure (testing::Test::HasFailure).
    Tick tick(const Vec3& hip) {
        const Renderer before = renderer_;
        path_.clear();
        const StepObserver observer{[](const Step& step, void* self) {
                                        static_cast<LayerOrder*>(self)->path_.push_back(step);
                                    },
                                    this};
        time_ += 0.001;
        const Tick tick = render(renderer_, {.time = time_, .position = hip}, observer);
        judge(before, tick);
        return tick;
    }
    const LayerTally& tally() const { return tally_; }
    void print(const std::string& name) const {
        const LayerTally& t = tally_;
        std::printf(
            "[ evidence ] %-22s ticks %d  ahead %d  behind %d  punctures %d (outward %d, ticks "
            "with several %d)  closings %d  first forces known %d  pieces at most %d  out of "
            "budget %d  worst %.1e\n",
            name.c_str(), t.ticks, t.ahead, t.behind, t.punctures, t.outward, t.several, t.closings,
            t.forces_known, t.most_pieces, t.out_of_budget, t.worst);
    }

  private:
    static constexpr double tolerance = 1e-9;  // of the range

    static Renderer made(const Field& field, const Layers& layers) {
        RendererSettings settings;
        settings.layers = std::make_shared<Layers>(layers);
        return make_renderer(field, layers.layers.front().level, settings);
    }
    const Field& field() const { return renderer_.field; }
    int count() const { return static_cast<int>(layers_.layers.size()); }
    /// How far a density is inside of a layer's surface [range].
    double depth(long double density, int layer) const {
        return double(field().sign() * (density - (long double)(layers_.layers[layer].level)) /
                      field().range());
    }

    long double reference(const Vec3l& index, bool slow) const {
        const bool is_cubic = field().interpolation() == Interpolation::cubic;
        if (!slow) {
            const Vec3 at = index.cast<double>();
            return is_cubic ? value_at(field(), cubic::locate(at)) : value_at(field(), locate(at));
        }
        if (!is_cubic) return paper_value(field(), index.cast<double>());
        return cubic_value(index, [&](const Index3& at) { return paper_sample(field(), at); })
            .value;
    }
    long double reference(const Vec3& physical) const {
        return reference(index_from_physical(field().geometry(), physical).cast<long double>(),
                         true);
    }
    /// The density most in this direction (1: inwards, -1: outwards) on a segment (physical).
    long double farthest(const Vec3& from, const Vec3& to, double direction, bool slow) const {
        const Vec3 a = index_from_physical(field().geometry(), from);
        const Vec3 b = index_from_physical(field().geometry(), to);
        const double sign = direction * field().sign();
        if (field().interpolation() == Interpolation::cubic) {
            return sign * greatest_on_cubic_segment(a, b, [&](const Vec3l& index) {
                       return sign * reference(index, slow);
                   });
        }
        return sign * greatest_on_segment(a, b, sign, [&](const Vec3& index) {
                   return double(reference(index.cast<long double>(), slow));
               });
    }

    void judge(const Renderer& before, const Tick& tick) {
        ++tally_.ticks;
        const ProxyUpdate& p = tick.proxy;
        ASSERT_TRUE(p.scp.allFinite() && tick.force.allFinite());
        ASSERT_LE(tick.force.norm(), 3.3 + 1e-12);
        ASSERT_LE(p.tetrahedra, renderer_.settings.proxy.step_budget);
        tally_.most_pieces = std::max(tally_.most_pieces, p.tetrahedra);
        tally_.out_of_budget += p.status == UpdateStatus::out_of_budget;
        tally_.recovering += p.status == UpdateStatus::recovering;
        const bool stays = before.proxy.placed && !was_recovering_;
        was_recovering_ = p.status == UpdateStatus::recovering;
        if (was_recovering_) {
            ASSERT_EQ(tick.force, Vec3(0, 0, 0));
            ASSERT_FALSE(stays) << "recovers, although nothing has changed";
        }
        if (stays) judge_path(before, tick);
        if (testing::Test::HasFatalFailure()) return;
        if (stays) judge_forces(before, tick);
        if (testing::Test::HasFatalFailure()) return;
        judge_end(before, tick);
    }

    void judge_path(const Renderer& before, const Tick& tick) {
        int outer = before.layers.outer, inner = before.layers.inner;
        std::array<bool, Layers::most_layers> touched{};
        Vec3 from = before.proxy.scp_physical;
        const auto touch = [&](const Vec3& at) {
            const long double density =
                reference(index_from_physical(field().geometry(), at).cast<long double>(), false);
            for (int l = 0; l < count(); ++l) {
                touched[l] |= std::abs(depth(density, l)) <= tolerance;
            }
        };
        touch(from);
        int opened = 0;
        for (const Step& step : path_) {
            if (step.kind == StepKind::goal) continue;
            const bool slow = random_.chance(0.03);
            const long double high = farthest(from, step.point, 1, slow);
            const long double low = farthest(from, step.point, -1, slow);
            while (inner < count() && depth(high, inner) > tolerance && touched[inner] &&
                   opened < tick.layers.punctured) {
                ++inner;
                ++opened;
            }
            while (outer > 0 && -depth(low, outer - 1) > tolerance && touched[outer - 1] &&
                   opened < tick.layers.punctured) {
                --outer;
                ++opened;
                ++tally_.outward;
            }
            double worst = -1;
            if (inner < count()) worst = std::max(worst, depth(high, inner));
            if (outer > 0) worst = std::max(worst, -depth(low, outer - 1));
            tally_.worst = std::max(tally_.worst, worst);
            ASSERT_LE(worst, tolerance)
                << "left what was open, inside " << outer << " to " << inner << " layers";
            touch(step.point);
            from = step.point;
        }
        ASSERT_LT((from - tick.proxy.scp).norm(), 1e-6) << "the path ends at the SCP";
    }

    /// What gives way first has to be pressed by its puncture force; with springs and without
    /// friction it is known that it then does.
    void judge_forces(const Renderer& before, const Tick& tick) {
        Proxy proxy = before.proxy;
        const LayerState& state = before.layers;
        proxy.isovalue =
            state.inner < count() ? layers_.layers[state.inner].level : field().sign() * HUGE_VAL;
        proxy.behind.reset();
        if (state.outer > 0) proxy.behind = layers_.layers[state.outer - 1].level;
        ProxySettings settings;
        settings.friction = friction_of(state.inner);
        settings.behind = friction_of(state.outer - 1);
        const ProxyUpdate u = update_exact(proxy, field(), tick.proxy.hip, settings);
        if (u.status != UpdateStatus::done) return;
        const int layer = u.mode == Mode::free ? -1 : u.behind ? state.outer - 1 : state.inner;
        if (layer < 0) {
            ASSERT_EQ(tick.layers.punctured, 0) << "nothing is touched";
            return;
        }
        const Layer& l = layers_.layers[layer];
        const double force = *l[HapticProperty::stiffness] * (u.scp - u.hip).norm();
        const double most = *l[HapticProperty::puncture_force];
        if (tick.layers.punctured > 0) {
            ASSERT_GE(force, most * (1 - 1e-9)) << "gave way too soon";
        }
        if (!uniform_) return;
        ++tally_.forces_known;
        ASSERT_TRUE(tick.layers.punctured > 0 || force <= most * (1 + 1e-9)) << "holds too long";
    }
    Friction friction_of(int layer) const {
        if (layer < 0 || layer >= count()) return {};
        return {*layers_.layers[layer][HapticProperty::static_friction],
                *layers_.layers[layer][HapticProperty::dynamic_friction]};
    }

    void judge_end(const Renderer& before, const Tick& tick) {
        const LayerState& was = before.layers;
        const LayerState& is = renderer_.layers;
        const LayersFelt& felt = tick.layers;
        tally_.punctures += felt.punctured;
        tally_.several += felt.punctured > 1;
        ASSERT_TRUE(0 <= is.outer && is.outer <= is.inner && is.inner <= count());
        ASSERT_LE(felt.punctured, 8);
        const long double density = reference(tick.proxy.scp);
        int least = 0, most = 0;
        for (int l = 0; l < count(); ++l) {
            least += depth(density, l) > tolerance;
            most += depth(density, l) >= -tolerance;
        }
        ASSERT_TRUE(least <= felt.inside && felt.inside <= most)
            << int(felt.inside) << " but it is " << least << " to " << most;
        ASSERT_TRUE(is.outer <= most && least <= is.inner);
        if (tick.proxy.status != UpdateStatus::done) return;
        if (was.layer_count == count()) {
            const int more = std::max(0, was.outer - is.outer) + std::max(0, is.inner - was.inner);
            ASSERT_LE(more, felt.punctured);
            tally_.closings += (was.inner - was.outer) + felt.punctured > is.inner - is.outer;
        }
        for (int l = is.outer; l < is.inner; ++l) {
            ASSERT_LE((tick.proxy.scp - is.opening[l]).norm(), layers_.closing) << "stays open";
        }
        ASSERT_EQ(felt.touched >= 0, tick.proxy.mode == Mode::constrained);
        if (felt.touched < 0) {
            ASSERT_EQ(tick.proxy.scp, tick.proxy.hip);
            return;
        }
        ++(tick.proxy.behind ? tally_.behind : tally_.ahead);
        ASSERT_LE(std::abs(depth(density, felt.touched)), tolerance) << "not at what it touches";
        ASSERT_EQ(felt.inside, felt.touched + (tick.proxy.behind ? 1 : 0));
    }

    Layers layers_;
    bool uniform_ = true;  // no friction, one stiffness: forces are known
    Random random_;
    Renderer renderer_;
    double time_ = 0;
    bool was_recovering_ = false;
    std::vector<Step> path_;
    LayerTally tally_;
};

}  // namespace palpate::support
