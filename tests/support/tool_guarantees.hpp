// The checker of a tool's guarantees: every chord of every point between the poses that an update
// reports is judged from the outside, by the exact maximum of the field on it.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "palpate/tool_proxy.hpp"
#include "support/cubic_guarantees.hpp"

namespace palpate::support {

struct ToolTally {
    int ticks = 0, constrained = 0, out_of_budget = 0, recovering = 0, rests = 0;
    std::int64_t chords = 0;
    std::vector<int> rounds, work;
    double worst_t1 = -1, worst_t2 = 0, worst_t3 = 0, worst_t4 = 0;

    static int percentile(std::vector<int> of, double p) {
        std::ranges::sort(of);
        return of.empty() ? 0 : of[std::size_t(p * double(of.size() - 1))];
    }
};

class ToolGuarantees {
  public:
    ToolGuarantees(const Field& field, const ToolSettings& settings = {})
        : field_(field), settings_(settings), random_(7) {}

    ToolUpdate update(ToolProxy& proxy, const Pose& hand) {
        const ToolState before = proxy;
        const PoseObserver every = observer();
        const ToolUpdate r = update_tool(proxy, field_, hand, settings_, every);
        judge(proxy, before, hand, r);
        return r;
    }
    /// Of one update, which judge() then judges.
    PoseObserver observer() {
        poses_.clear();
        return {take, this};
    }
    void judge(const ToolProxy& proxy, const ToolState& before, const Pose& hand,
               const ToolUpdate& r) {
        check(proxy, before.pose, hand, r, before.placed && !inside_);
    }
    const ToolTally& tally() const { return tally_; }
    void print(const std::string& name) const {
        const ToolTally& t = tally_;
        std::printf(
            "[ evidence ] %-22s ticks %d  constrained %.2f  rests %d  chords %lld  rounds mean "
            "%.1f p50 %d p99 %d most %d  work p50 %d p99 %d most %d  out of budget %d  "
            "recovering %d  T1 %.1e  T2 %.1e  T3 %.1e  T4 %.1e\n",
            name.c_str(), t.ticks, double(t.constrained) / t.ticks, t.rests,
            static_cast<long long>(t.chords), mean(t.rounds), t.percentile(t.rounds, 0.5),
            t.percentile(t.rounds, 0.99), t.percentile(t.rounds, 1), t.percentile(t.work, 0.5),
            t.percentile(t.work, 0.99), t.percentile(t.work, 1), t.out_of_budget, t.recovering,
            t.worst_t1, t.worst_t2, t.worst_t3, t.worst_t4);
    }
    /// Of one point's way; all of them is too slow for tools of many points.
    double share_checked = 1;
    double share_slow = 0.01;  ///< of chords, by the reference as well

  private:
    static void take(const Pose& pose, void* self) {
        static_cast<ToolGuarantees*>(self)->poses_.push_back(pose);
    }
    static double mean(const std::vector<int>& of) {
        double sum = 0;
        for (const int i : of) sum += i;
        return of.empty() ? 0 : sum / double(of.size());
    }
    /// In parts of the range, by the field itself or, slowly, by the reference.
    long double excess(const Vec3l& index, double isovalue, bool slow = false) const {
        const long double density =
            slow ? cubic_value(index, [&](const Index3& at) { return paper_sample(field_, at); })
                       .value
                 : (long double)(value_at(field_, cubic::locate(index.cast<double>())));
        return field_.sign() * (density - (long double)(isovalue)) / field_.range();
    }
    static double distance(const Tool& tool, const Pose& from, const Pose& to) {
        const double turn =
            tool.turns()
                ? tool.gyration() * rotation_between(from.orientation, to.orientation).norm()
                : 0;
        return std::hypot((to.position - from.position).norm(), turn);
    }

    void check(const ToolProxy& proxy, const Pose& before, const Pose& hand, const ToolUpdate& r,
               bool was_free) {
        ++tally_.ticks;
        tally_.constrained += r.mode == Mode::constrained;
        tally_.out_of_budget += r.status == UpdateStatus::out_of_budget;
        tally_.recovering += r.status == UpdateStatus::recovering;
        tally_.rounds.push_back(r.rounds);
        tally_.work.push_back(r.work);
        ASSERT_TRUE(r.proxy.position.allFinite() && r.proxy.orientation.coeffs().allFinite());
        ASSERT_NEAR(r.proxy.orientation.norm(), 1, 1e-12);
        inside_ = r.status == UpdateStatus::recovering;
        ASSERT_FALSE(was_free && inside_) << "inside again";
        if (inside_ || !was_free) return;
        Pose from = before;
        for (const Pose& to : poses_) {
            check_chords(proxy, from, to);
            from = to;
        }
        ASSERT_EQ(from.position, r.proxy.position) << "the poses end at the proxy";
        const bool rubs = settings_.friction.static_coefficient > 0;
        const double was = distance(proxy.tool(), before, hand);
        const double growth = (distance(proxy.tool(), r.proxy, hand) - was) /
                              (was + field_.geometry().spacing.minCoeff());
        if (!rubs) tally_.worst_t4 = std::max(tally_.worst_t4, growth);
        ASSERT_LE(rubs ? 0 : growth, 1e-12) << "T4";
        if (r.mode == Mode::constrained && r.status == UpdateStatus::done) check_rest(proxy, hand);
    }

    void check_rest(const ToolProxy& proxy, const Pose& hand) {
        ++tally_.rests;
        for (int i = 0; i < proxy.contact_count; ++i) {
            if (!(proxy.contacts[i].pressure > 0)) continue;
            const Vec3 at = physical_from_tool(
                proxy.pose, proxy.tool().points()[std::size_t(proxy.contacts[i].point)]);
            const double off = std::abs(double(excess(
                index_from_physical(field_.geometry(), at).cast<long double>(), proxy.isovalue)));
            tally_.worst_t2 = std::max(tally_.worst_t2, off);
            ASSERT_LE(off, 1e-6) << "T2";
        }
        if (settings_.friction.static_coefficient == 0) check_motions(proxy, hand);
    }

    void check_chords(const ToolProxy& proxy, const Pose& from, const Pose& to) {
        const Geometry& geometry = field_.geometry();
        for (const Vec3& point : proxy.tool().points()) {
            if (share_checked < 1 && !random_.chance(share_checked)) continue;
            const Vec3 a = index_from_physical(geometry, physical_from_tool(from, point));
            const Vec3 b = index_from_physical(geometry, physical_from_tool(to, point));
            const bool slow = random_.chance(share_slow);
            const double most = double(greatest_on_cubic_segment(
                a, b, [&](const Vec3l& index) { return excess(index, proxy.isovalue, slow); }));
            ++tally_.chords;
            tally_.worst_t1 = std::max(tally_.worst_t1, most);
            ASSERT_LE(most, 1e-9) << "T1";
        }
    }

    /// A rigid motion near the pull that leads no contact into the solid, as far as planes say.
    void turn_along_contacts(const ToolProxy& proxy, const Pose& hand, Vec3& v, Vec3& w) {
        const Tool& tool = proxy.tool();
        const double gyration = tool.gyration();
        v = hand.position - proxy.pose.position + 0.3 * v * v.norm();
        if (tool.turns()) {
            w = gyration * rotation_between(proxy.pose.orientation, hand.orientation) + 0.3 * w;
        }
        for (int pass = 0; pass < 60; ++pass) {
            for (int i = 0; i < proxy.contact_count; ++i) {
                const ToolContact& contact = proxy.contacts[std::size_t(i)];
                if (!(contact.pressure > 0)) continue;
                const Vec3 arm = contact.place - proxy.pose.position;
                const Vec3 lever =
                    tool.turns() ? Vec3(arm.cross(contact.normal) / gyration) : Vec3(0, 0, 0);
                const double into = contact.normal.dot(v) + lever.dot(w);
                if (into >= 0) continue;
                const double share = 1.0001 * into / (1 + lever.squaredNorm());
                v -= share * contact.normal;
                w -= share * lever;
            }
        }
    }

    /// Small rigid motions, some at random, some along what the contacts allow: none leads closer
    /// through free space.
    void check_motions(const ToolProxy& proxy, const Pose& hand) {
        const Geometry& geometry = field_.geometry();
        const Tool& tool = proxy.tool();
        const double step = 1e-3 * geometry.spacing.minCoeff();
        const double before = distance(tool, proxy.pose, hand);
        for (int i = 0; i < 16; ++i) {
            Vec3 v = random_.direction() * random_.uniform(0, 1);
            Vec3 w =
                tool.turns() ? Vec3(random_.direction() * random_.uniform(0, 1)) : Vec3(0, 0, 0);
            if (i % 2 == 1) turn_along_contacts(proxy, hand, v, w);
            const double length = std::hypot(v.norm(), w.norm());
            if (!(length > 1e-6)) continue;
            v *= step / length;
            w *= step / (length * tool.gyration());
            const Pose to{proxy.pose.position + v, turned(proxy.pose.orientation, w)};
            const double closer = (before - distance(tool, to, hand)) / step;
            if (closer <= tally_.worst_t3) continue;
            bool free = true;
            for (const Vec3& point : tool.points()) {
                const Vec3 b = index_from_physical(geometry, physical_from_tool(to, point));
                free = excess(b.cast<long double>(), proxy.isovalue) <= 1.1e-11L;
                if (!free) break;
            }
            if (!free) continue;
            tally_.worst_t3 = std::max(tally_.worst_t3, closer);
            ASSERT_LE(closer, 2e-3) << "T3";
        }
    }

    const Field& field_;
    ToolSettings settings_;
    Random random_;
    std::vector<Pose> poses_;
    bool inside_ = false;
    ToolTally tally_;
};

}  // namespace palpate::support
