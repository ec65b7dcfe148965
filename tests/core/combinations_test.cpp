// The guarantees of the proxy (G1 to G5) and of tools (T1 to T5) for every combination of field,
// surfaces, tool and samples. The test judges whole ticks by its own evaluation of the field.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <sstream>

#include "support/combinations.hpp"
#include "support/cubic_guarantees.hpp"
#include "support/tool_guarantees.hpp"

using namespace palpate;
using namespace palpate::support;

namespace every {
using namespace support::combinations;
namespace {

constexpr double off_surface = 1e-9;  // [range]

struct Tally {
    int ticks = 0, contacts = 0, at_labels = 0, waits = 0, recovering = 0, unfinished = 0;
    int changed = 0;  // ticks in which surfaces opened or closed
    int punctures = 0, pieces = 0, motions = 0, versions = 0;
    double g1 = -HUGE_VAL, g2 = 0, g3 = 0, g4 = 0;
};

/// How far a straight way leads to where the SCP may not be [range], by the exact extremes of the
/// field on it.
double most_beyond(const TouchedField& touched, const Vec3& from, const Vec3& to) {
    const Geometry& grid_of = touched.grid_of().geometry();
    const Vec3 a = index_from_physical(grid_of, from), b = index_from_physical(grid_of, to);
    const auto most = [&](double sign) {
        const auto value = [&](const auto& index) {
            const Vec3 at = index.template cast<double>();
            return sign * touched.value(physical_from_index(grid_of, at));
        };
        if (touched.data.interpolation() == Interpolation::linear) {
            return greatest_on_segment(a, b, 1, value);
        }
        return double(greatest_on_cubic_segment(
            a, b, [&](const Vec3l& index) { return (long double)(value(index)); }));
    };
    const double sign = touched.sign(), ahead = touched.ahead();
    double worst = -HUGE_VAL;
    if (std::isfinite(ahead)) worst = most(sign) - sign * ahead;
    if (touched.has_behind()) worst = std::max(worst, most(-sign) + sign * touched.behind());
    return worst / touched.range();
}

bool same_surfaces(const LayerState& a, const LayerState& b) {
    return a.open == b.open && a.outer == b.outer && a.inner == b.inner;
}

class Judge {
  public:
    Judge(const Combination& of, std::uint64_t seed)
        : of_(of),
          random_(seed),
          source_(of.data, seed),
          of_level_(level_alone(of.tool)),
          session_(session_on(source_, of, settings_for(of))),
          loop_(random_, source_middle + random_.uniform(0, 4) * random_.direction()),
          of_tool_(session_.renderer.field) {
        of_tool_.share_checked = 0.25;
        of_tool_.share_slow = 0.25;
    }
    /// Stop at the first failure.
    void tick(double part) {
        const auto before = source_.samples();
        source_.come_and_go(session_);
        tally_.versions += before != source_.samples();
        if (random_.chance(0.02)) aside_ = random_.uniform(0, 4) * random_.direction();
        const DeviceReading reading = loop_.at(part);
        TickInput state;
        state.time = ++tally_.ticks * period;
        state.position = reading.position + aside_;
        state.orientation = reading.orientation;
        const Tick tick = of_.tool == Touching::point ? feel_point(state) : feel_tool(state);
        const ProxyUpdate& at = tick.proxy;
        tally_.contacts += at.mode == Mode::constrained;
        tally_.waits += at.status == UpdateStatus::waiting;
        tally_.recovering += at.status == UpdateStatus::recovering;
        tally_.unfinished += at.status == UpdateStatus::out_of_budget;
        tally_.punctures += tick.layers.punctured;
    }
    const Tally& tally() const { return tally_; }
    const ToolGuarantees& of_tool() const { return of_tool_; }

  private:
    Renderer& renderer() { return session_.renderer; }
    TouchedField touched() { return touched_by(renderer(), of_level_); }

    /// Where samples are missing on the hand's way, the proxy goes only a part of it in one tick.
    bool all_in_memory(const Vec3& from, const Vec3& hand) {
        return is_resident(renderer().field, from, 2 * (hand - from).norm() + 8);
    }
    Tick feel_tool(const TickInput& state) {
        ToolProxy& proxy = *renderer().tool_proxy;
        const ToolState before = proxy;
        const Tick tick = render(renderer(), state, {}, nullptr, of_tool_.observer());
        EXPECT_LE(tick.proxy.work, 2 * renderer().settings.proxy.step_budget) << "T5";
        ToolUpdate r;
        r.status = tick.proxy.status;
        r.mode = tick.proxy.mode;
        r.work = tick.proxy.work;
        r.proxy = {tick.proxy.scp, tick.tool.proxy};
        if (!all_in_memory(before.pose.position, tick.proxy.hip)) r.status = UpdateStatus::waiting;
        of_tool_.judge(proxy, before, {tick.proxy.hip, tick.tool.hand}, r);
        return tick;
    }
    Tick feel_point(const TickInput& state) {
        const Proxy proxy = renderer().proxy;
        const LayerState layers = renderer().layers;
        path_.clear();
        const StepObserver observer{[](const Step& step, void* to) {
                                        if (step.kind == StepKind::goal) return;
                                        static_cast<std::vector<Vec3>*>(to)->push_back(step.point);
                                    },
                                    &path_};
        const Tick tick = render(renderer(), state, observer);
        judge_point(proxy, layers, tick);
        return tick;
    }

    void judge_point(const Proxy& before, const LayerState& layers, const Tick& tick) {
        const ProxyUpdate& at = tick.proxy;
        ASSERT_TRUE(at.scp.allFinite() && tick.force.allFinite()) << "G5";
        ASSERT_LE(at.work, renderer().settings.proxy.step_budget) << "G5";
        const bool stays = before.placed && !inside_;
        inside_ = at.status == UpdateStatus::recovering;
        ASSERT_FALSE(stays && inside_) << "inside again";
        if (inside_ || at.status == UpdateStatus::waiting) return;
        const bool same = tick.layers.punctured == 0 && same_surfaces(layers, renderer().layers);
        if (stays && same) judge_path(before, at);
        if (testing::Test::HasFatalFailure()) return;
        const double here = touched().beyond(at.scp);
        tally_.g1 = std::max(tally_.g1, here);
        ASSERT_LE(here, off_surface) << "G1, at the end";
        tally_.changed += !same;
        if (at.mode == Mode::constrained && same) {
            tally_.at_labels += tick.layers.touched >= touched().levels();
            tally_.g2 = std::max(tally_.g2, std::abs(here));
            ASSERT_LE(std::abs(here), off_surface) << "G2";
            if (at.status == UpdateStatus::done && tally_.ticks % 4 == 0 &&
                all_in_memory(before.scp_physical, at.hip)) {
                judge_optimum(at);
            }
        } else if (at.mode == Mode::free && at.status == UpdateStatus::done) {
            ASSERT_EQ(at.scp, at.hip) << "free, not at the HIP";
        }
    }

    void judge_path(const Proxy& before, const ProxyUpdate& at) {
        Vec3 from = before.scp_physical;
        double last = (from - at.hip).norm();
        // Otherwise the path leads to a place on the hand's way.
        const bool to_hand = all_in_memory(from, at.hip);
        path_.push_back(at.scp);
        for (const Vec3& to : path_) {
            ++tally_.pieces;
            const double worst = most_beyond(touched(), from, to);
            tally_.g1 = std::max(tally_.g1, worst);
            ASSERT_LE(worst, off_surface) << "G1";
            const double now = (to - at.hip).norm();
            if (to_hand || &to == &path_.back()) {
                tally_.g4 = std::max(tally_.g4, now - last);
                ASSERT_LE(now, last + 1e-9) << "G4";
                last = now;
            }
            from = to;
        }
    }

    void judge_optimum(const ProxyUpdate& at) {
        const bool linear = of_.field == Interpolation::linear;
        const Vec3 pull = at.hip - at.scp;
        const double step = 1e-3 * touched().grid_of().geometry().spacing.minCoeff();
        for (int i = 0; i < 6; ++i) {
            // Some near the tangent plane, where a free way would be.
            Vec3 way = random_.direction();
            if (i % 2 == 1) way -= pull * (pull.dot(way) / pull.squaredNorm()) * 0.99;
            if (way.dot(pull) < 0) way = -way;
            const Vec3 to = at.scp + way * (step / way.norm());
            const double closer = (pull.norm() - (at.hip - to).norm()) / step;
            ++tally_.motions;
            if (!(closer > std::max(tally_.g3, linear ? 1e-5 : 0))) continue;
            const double most = most_beyond(touched(), at.scp, to);
            if (most > (linear ? off_surface : 1.1e-11)) continue;
            tally_.g3 = std::max(tally_.g3, closer);
            ASSERT_LE(closer, linear ? 1e-5 : 2e-3) << "G3: a free motion leads closer";
        }
    }

    Combination of_;
    Random random_;
    Source source_;
    Layers of_level_;
    Session session_;
    Loop loop_;
    ToolGuarantees of_tool_;
    Tally tally_;
    Vec3 aside_ = Vec3::Zero();
    std::vector<Vec3> path_;
    bool inside_ = false;
};

class Combinations : public testing::TestWithParam<Combination> {};

TEST_P(Combinations, keep_the_guarantees) {
    const Combination& of = GetParam();
    const int ticks = scaled_or_asked(400);
    int contacts = 0;
    for (std::uint64_t seed = 300; seed < 303; ++seed) {
        Judge judge(of, seed);
        for (int i = 0; i < ticks && !HasFatalFailure(); ++i) judge.tick(i / 300.0);
        ASSERT_FALSE(HasFatalFailure()) << "seed " << seed << ", tick " << judge.tally().ticks;
        const Tally& t = judge.tally();
        std::ostringstream name;
        name << of;
        std::printf(
            "[ evidence ] %-34s ticks %d  contacts %d  at labels %d  waits %d  versions %d  "
            "punctures %d  unfinished %d  recovering %d  pieces %d  G1 %.1e  G2 %.1e  G3 %.1e  "
            "G4 %.1e\n",
            name.str().c_str(), t.ticks, t.contacts, t.at_labels, t.waits, t.versions, t.punctures,
            t.unfinished, t.recovering, t.pieces, t.g1, t.g2, t.g3, t.g4);
        if (of.tool != Touching::point) judge.of_tool().print(name.str());
        contacts += t.contacts;
    }
    EXPECT_GT(contacts, ticks / 4);
}

INSTANTIATE_TEST_SUITE_P(Every, Combinations, testing::ValuesIn(all_combinations()),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace every
