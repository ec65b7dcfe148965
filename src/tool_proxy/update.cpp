// The update of a tool's proxy: rounds of a direction, from the half-spaces at the points that
// touch and the curvature there, and of certified motion along it (docs/tools.md).
#include <algorithm>
#include <cmath>

#include "proxy/update.hpp"
#include "tool_proxy/friction.hpp"
#include "tool_proxy/motion.hpp"
#include "tool_proxy/nearest.hpp"
#include "tool_proxy/recovery.hpp"

namespace palpate {

namespace tool {
namespace {

/// The remaining pull at rest, relative to the whole pull, and in voxels.
constexpr double resting_pull = 3e-4, least_pull = 5e-7;
/// Smallest eigenvalue with which curvature enters.
constexpr double least_curvature = 0.55;
/// A chord differs from the arc of a turning point by at most this [voxel].
constexpr double sagitta = 1e-3;
/// Evaluations without pressure after which a contact is forgotten.
constexpr int most_idle = 12;
constexpr int most_failures = 8;
constexpr int most_rounds = 60;
/// Longest motion with nothing near [voxel].
constexpr double longest_stride = 64;
/// Slope of the field [range / voxel] below which its normal gives no direction.
constexpr double least_slope = 1e-9;

Six six(const Vec3& a, const Vec3& b) {
    Six result;
    result << a, b;
    return result;
}

/// A contact as a round sees it.
struct Touch {
    Vec3 arm;      ///< from the reference point [mm]
    Vec3 normal;   ///< out of the solid
    Mat3 bend;     ///< Hessian of the excess over its slope [1/mm]
    double gap;    ///< to the level at which supports are held [mm]
    double bound;  ///< of the half-space: what a motion along the normal has to reach [mm]
};

/// A motion as translation and rotation.
struct Split {
    Vec3 v, w;
};

class Rounds {
  public:
    Rounds(ToolProxy& proxy, Around& around, const Pose& hand, const ToolSettings& settings,
           PoseObserver observer)
        : proxy_(proxy),
          around_(around),
          motion_{proxy, around, observer},
          hand_(hand),
          target_(hand),
          friction_(settings.friction),
          friction_pending_(has_friction(friction_)),
          gyration_(settings.gyration > 0 ? settings.gyration : proxy.tool().gyration()),
          reach_(proxy.tool().radius()),
          voxel_(around.shortest()),
          most_angle_(std::min(3.0, std::sqrt(8 * sagitta * voxel_ / reach_))) {}

    /// Also ends as out of budget if it makes no progress before it is at rest.
    UpdateStatus run(int& rounds) {
        go_on();
        int failures = 0;
        for (rounds = 0; rounds < most_rounds && !around_.is_exhausted(); ++rounds) {
            look();
            if (friction_pending_) apply_friction();
            pull_ = pull();
            const double before = dot(pull_, pull_);
            if (before == 0 || proxy_.contact_count == 0) {
                if ((before == 0 || go_freely()) && is_at_hand()) return end_free();
            } else {
                if (go_along(failures)) {
                    proxy_.mode = Mode::constrained;
                    return UpdateStatus::done;
                }
            }
            if (around_.is_exhausted()) break;
            const Six left = pull();
            const double after = dot(left, left);
            const double least = 2e-9 * voxel_ * std::max(std::sqrt(before), 1e-9 * voxel_);
            if (before - after > least) {
                failures = 0;
                proxy_.trust = std::min(1.0, 2 * proxy_.trust);
                continue;
            }
            proxy_.trust = std::max(1e-4, 0.25 * proxy_.trust);
            if (added_ > 0) {  // a new contact is news; it shares in the friction
                is_at_hand();
                continue;
            }
            if (++failures > most_failures) break;
        }
        if (around_.is_exhausted() && proxy_.kept().pass.part == 0) {
            proxy_.trust = std::max(1e-3, 0.5 * proxy_.trust);
            proxy_.stride = std::max(1e-2, 0.25 * proxy_.stride);
        }
        proxy_.mode = proxy_.contact_count > 0 ? Mode::constrained : Mode::free;
        return UpdateStatus::out_of_budget;
    }

  private:
    UpdateStatus end_free() {
        proxy_.mode = Mode::free;
        proxy_.sliding = false;
        proxy_.contact_count = 0;
        return UpdateStatus::done;
    }

    /// At the target: false if that is not the hand, because friction had moved it back to where
    /// nothing touches any more. Then the hand is the target again.
    bool is_at_hand() {
        if (!is_held_back_) return true;
        is_held_back_ = false;
        friction_pending_ = true;
        target_ = hand_;
        return false;
    }

    /// Moves the target back by what friction at the contacts holds.
    void apply_friction() {
        const int count = proxy_.contact_count;
        if (count == 0) return;
        pull_ = pull();
        const double length = std::sqrt(dot(pull_, pull_));
        const double at_rest = std::max(resting_pull * length, least_pull * voxel_);
        std::array<tool::Tangents, most_tool_contacts> tangents;
        for (int i = 0; i < count; ++i) {
            const Vec3 along = touches_[i].normal.unitOrthogonal();
            const Vec3 across = touches_[i].normal.cross(along);
            tangents[i] = {{row_of(touches_[i].arm, along), row_of(touches_[i].arm, across)}};
        }
        const auto held = [&](double coefficient) {
            Held found = held_by_friction(pull_, rows_.data(), tangents.data(), count, coefficient,
                                          1e-9 * std::max(length, voxel_), at_rest);
            around_.spend(found.work);
            return found;
        };
        Held left =
            held(proxy_.sliding ? friction_.dynamic_coefficient : friction_.static_coefficient);
        if (left.slips && !proxy_.sliding) left = held(friction_.dynamic_coefficient);
        slipped_ |= left.slips;
        proxy_.sliding = slipped_;
        friction_pending_ = false;
        is_held_back_ = true;
        const Split s = split(left.pull);
        target_ = {proxy_.pose.position + s.v,
                   turns() ? turned(proxy_.pose.orientation, s.w) : hand_.orientation};
    }

    bool turns() const { return proxy_.tool().turns(); }
    Six pull() const { return pull_from(proxy_.pose); }
    Six pull_from(const Pose& pose) const {
        const Vec3 rotation =
            turns() ? rotation_between(pose.orientation, target_.orientation) : Vec3::Zero();
        return six(target_.position - pose.position, gyration_ * rotation);
    }
    Split split(const Six& x) const { return {x.head<3>(), x.tail<3>() / gyration_}; }

    /// How a motion of the tool moves what is at its arm along a direction.
    Six row_of(const Vec3& arm, const Vec3& direction) const {
        return six(direction, turns() ? Vec3(arm.cross(direction) / gyration_) : Vec3::Zero());
    }

    /// The contacts that the pull may reach, as they are now.
    void look() {
        int kept = 0;
        for (int i = 0; i < proxy_.contact_count; ++i) {
            ToolContact contact = proxy_.contacts[i];
            int idle = proxy_.idle[i];
            contact.place = physical_from_tool(proxy_.pose, proxy_.tool().points()[contact.point]);
            const Around::Expansion at = around_.expand(contact.place);
            const double slope = std::sqrt(dot(at.gradient, at.gradient));
            if (!(slope > least_slope * around_.range() / voxel_)) continue;
            const double gap = (Around::held * around_.range() - at.excess) / slope;
            if (++idle > most_idle || gap > 1.5 * voxel_) continue;
            contact.normal = at.gradient / -slope;
            contact.pressure = 0;
            touches_[kept] = {contact.place - proxy_.pose.position, contact.normal,
                              at.hessian / slope, gap, gap > 0 ? -gap : -1.5 * gap};
            rows_[kept] = {row_of(touches_[kept].arm, contact.normal), touches_[kept].bound};
            proxy_.contacts[kept] = contact;
            proxy_.idle[kept] = idle;
            ++kept;
        }
        proxy_.contact_count = kept;
    }

    /// Takes up the point that ended the last motion.
    void take_up_hit() {
        const int point = motion_.hit;
        if (point < 0) return;
        for (int i = 0; i < proxy_.contact_count; ++i) {
            if (proxy_.contacts[i].point == point) return;
        }
        const bool is_full = proxy_.contact_count == most_tool_contacts;
        const int at = is_full ? least_needed() : proxy_.contact_count++;
        proxy_.contacts[at] = {.point = point};
        proxy_.idle[at] = 0;
        ++added_;
    }

    int least_needed() const {
        int least = 0;
        for (int i = 1; i < most_tool_contacts; ++i) {
            if (proxy_.idle[i] > proxy_.idle[least]) least = i;
        }
        return least;
    }

    double go(const Six& step, const Pose* exact = nullptr) {
        const Split s = split(step);
        const double part = motion_.go(s.v, s.w, exact);
        take_up_hit();
        return part;
    }
    /// The motion whose test did not fit into the last update's budget, unless the hand has moved
    /// so that it would lead away.
    void go_on() {
        double& part = proxy_.kept().pass.part;
        if (part == 0 || around_.is_exhausted()) return;
        const Six before = pull(), after = pull_from(motion_.end());
        if (dot(after, after) > dot(before, before)) {
            part = 0;
            return;
        }
        motion_.go_on();
        take_up_hit();
    }

    /// With nothing near: straight to the hand, in turns small enough that chords are arcs. True at
    /// the hand.
    bool go_freely() {
        added_ = 0;
        const Split s = split(pull_);
        const double angle = s.w.norm();
        const double far = s.v.norm() + angle * reach_, stride = proxy_.stride * voxel_;
        double share = far > stride ? stride / far : 1;
        if (angle * share > most_angle_) share = most_angle_ / angle;
        Pose end = target_;
        if (!turns()) end.orientation = proxy_.pose.orientation;
        const bool whole = share == 1;
        const double part = go(pull_ * share, whole ? &end : nullptr);
        if (part == 1) proxy_.stride = std::min(longest_stride, 2 * proxy_.stride);
        return part == 1 && whole;
    }

    /// No longer than the trust, in translation and at the farthest point, and no more of a turn
    /// than chords allow.
    double share_of(const Six& step) const {
        const double trust = proxy_.trust * voxel_;
        const Split s = split(step);
        const double v = s.v.norm(), w = s.w.norm();
        double share = 1;
        if (v > trust) share = trust / v;
        if (w * share * reach_ > trust) share = trust / (w * reach_);
        if (w * share > most_angle_) share = most_angle_ / w;
        return share;
    }

    /// How much the surface rises under a contact, and how much its way bends into the solid
    /// because it turns, both beyond what is linear [mm].
    struct Rise {
        double surface, turn;
    };
    static Rise rise_of(const Touch& touch, const Split& s) {
        const Vec3 turn = s.w.cross(touch.arm);
        const Vec3 chord = s.v + turn;
        return {0.5 * chord.dot(touch.bend * chord), -0.5 * touch.normal.dot(s.w.cross(turn))};
    }

    Nearest nearest_to(const Six& to) const {
        Nearest found = nearest(to, rows_.data(), proxy_.contact_count, 1e-13 * voxel_);
        around_.spend(found.work);
        return found;
    }

    /// A round in contact. True at rest.
    bool go_along(int failures) {
        added_ = 0;
        const int count = proxy_.contact_count;
        const Nearest flat = nearest_to(pull_);
        double pressing = 0;
        for (int i = 0; i < count; ++i) {
            proxy_.contacts[i].pressure = flat.multiplier[i];
            if (!(flat.multiplier[i] > 0)) continue;
            proxy_.idle[i] = 0;
            pressing = std::max(pressing, std::abs(touches_[i].gap));
        }
        const double pull = std::sqrt(dot(pull_, pull_));
        const double left = std::sqrt(dot(flat.point, flat.point));
        if (!flat.found) return false;
        if (left <= std::max(resting_pull * pull, least_pull * voxel_) &&
            pressing < least_pull * voxel_) {
            return true;
        }
        const Nearest bent =
            nearest(pull_, curvature(flat), least_curvature, rows_.data(), count, 1e-13 * voxel_);
        around_.spend(bent.work);
        const Six aim = bent.found ? bent.point : flat.point;
        const Six step = aim * share_of(aim);
        lift(step, failures);
        const Six along = lifted(step);
        if (!descend(along)) return false;
        if (motion_.hit >= 0 || around_.is_exhausted()) return false;
        fall(step, along);
        return false;
    }

    /// The half-spaces raised to where a step certainly is above the surface.
    void lift(const Six& step, int failures) {
        const Split s = split(step);
        const double more = std::min(4.0, 1 + 0.75 * failures);
        for (int i = 0; i < proxy_.contact_count; ++i) {
            const Rise rise = rise_of(touches_[i], s);
            const double up =
                1.1 * std::max(0.0, rise.surface) + (rise.turn > 0 ? 1.05 : 0.95) * rise.turn;
            rows_[i].bound = touches_[i].bound + more * std::max(0.0, up);
        }
    }

    /// The step nearest to one whose exact chords clear the surface as the field's second order
    /// says.
    Six lifted(const Six& step) {
        Six result = step;
        for (int tries = 0; tries < 4; ++tries) {
            const Nearest found = nearest_to(step);
            if (!found.found) return Six::Zero();
            result = found.point;
            const Split s = split(result);
            const Quaternion turn = turned(Quaternion::Identity(), s.w);
            double missing = 0;
            for (int i = 0; i < proxy_.contact_count; ++i) {
                const Touch& touch = touches_[i];
                const Vec3 chord = s.v + (turn * touch.arm - touch.arm);
                const double rise = 1.05 * std::max(0.0, rise_of(touch, s).surface);
                const double lacking = touch.bound + rise - touch.normal.dot(chord);
                if (!(lacking > 1e-14 * voxel_)) continue;
                rows_[i].bound += lacking;
                missing = std::max(missing, lacking);
            }
            if (missing == 0) break;
        }
        return result;
    }

    /// Along a step, no farther than where the distance to the hand is least. False if it leads
    /// away.
    bool descend(Six step) {
        const Six left = pull();
        const double towards = dot(step, left), squared = dot(step, step);
        if (!(towards > 0) || !(squared > 0)) return false;
        if (towards < squared) step *= towards / squared;
        // Rotations do not add up: look at the distance itself.
        for (int tries = 0; tries < 4; ++tries) {
            const Split s = split(step);
            const Six after = pull_from(moved(proxy_.pose, s.v, s.w, 1));
            if (dot(after, after) <= dot(left, left)) {
                go(step);
                return true;
            }
            step *= 0.25;
        }
        return false;
    }

    /// From above the surface to where the step's foot is by the field's second order, and past it,
    /// in case the surface lies lower.
    void fall(const Six& step, const Six& along) {
        const Split s = split(step);
        for (int i = 0; i < proxy_.contact_count; ++i) {
            const Rise rise = rise_of(touches_[i], s);
            rows_[i].bound = touches_[i].bound + rise.surface + rise.turn;
        }
        const Nearest foot = nearest_to(step);
        if (foot.found) descend(3 * (foot.point - along));
    }

    Mat6 curvature(const Nearest& flat) const {
        Mat6 b = Mat6::Identity();
        for (int i = 0; i < proxy_.contact_count; ++i) {
            const double pressure = flat.multiplier[i];
            if (!(pressure > 0)) continue;
            const Touch& touch = touches_[i];
            const Mat3& h = touch.bend;
            b.topLeftCorner<3, 3>() += pressure * h;
            if (!turns()) continue;
            Mat3 cross;  // cross * w = w x arm
            cross << 0, touch.arm[2], -touch.arm[1], -touch.arm[2], 0, touch.arm[0], touch.arm[1],
                -touch.arm[0], 0;
            const Mat3 mixed = pressure / gyration_ * (h * cross);
            b.topRightCorner<3, 3>() += mixed;
            b.bottomLeftCorner<3, 3>() += mixed.transpose();
            const Vec3 &n = touch.normal, &c = touch.arm;
            const Mat3 turn =
                n.dot(c) * Mat3::Identity() - 0.5 * (n * c.transpose() + c * n.transpose());
            b.bottomRightCorner<3, 3>() +=
                pressure / (gyration_ * gyration_) * (cross.transpose() * h * cross + turn);
        }
        return b;
    }

    ToolProxy& proxy_;
    Around& around_;
    Motion motion_;
    const Pose& hand_;
    Pose target_;
    const Friction& friction_;
    bool friction_pending_;
    bool is_held_back_ = false;  ///< the target is not the hand
    bool slipped_ = false;       ///< in this update
    const double gyration_, reach_, voxel_, most_angle_;
    Six pull_ = Six::Zero();
    std::array<Touch, most_tool_contacts> touches_;
    std::array<HalfSpace6, most_tool_contacts> rows_;
    int added_ = 0;
};

bool accepts(const ToolProxy& proxy, const Field& field, const Pose& hand,
             const ToolSettings& settings) {
    const double gyration = settings.gyration;
    return field.interpolation() == Interpolation::cubic &&
           (gyration == 0 || (gyration >= 1e-10 && gyration <= 1e10)) &&
           proxy.tool().radius() <= farthest_hip * field.geometry().spacing.minCoeff() &&
           std::abs(hand.orientation.squaredNorm() - 1) < 1e-6 &&
           palpate::accepts(proxy.isovalue, field,
                            index_from_physical(field.geometry(), hand.position),
                            settings.friction);
}

}  // namespace
}  // namespace tool

ToolUpdate update_tool(ToolProxy& proxy, const Field& field, const Pose& hand,
                       const ToolSettings& settings, PoseObserver observer) {
    ToolUpdate result{.mode = proxy.mode, .hand = hand, .proxy = proxy.pose};
    Quaternion& turn = result.hand.orientation;
    if (!tool::accepts(proxy, field, hand, settings)) {
        result.status = UpdateStatus::refused;
        return result;
    }
    // A quaternion that is unit to all digits keeps its bits.
    if (std::abs(turn.squaredNorm() - 1) > 1e-14) turn.normalize();
    tool::Kept& kept = proxy.kept();
    const bool others = tool::renew(kept.surroundings, field) || !proxy.placed ||
                        kept.isovalue != proxy.isovalue || kept.renewed;
    // Each point is looked at once; where it is pushed out, before and after.
    const int looks =
        (others || kept.inside ? 2 : 1) * static_cast<int>(proxy.tool().points().size());
    const int budget = std::min(settings.work_budget, 1 << 30);
    tool::Around around(field, proxy.isovalue, kept.surroundings, budget, looks);
    if (others) kept.recovery = {};
    if (others || kept.inside) kept.pass = {};
    if (!proxy.placed) {
        proxy.pose = result.hand;
        proxy.contact_count = 0;
    }
    // Odometers keep their digits.
    const double most_travel = 1000 * around.shortest();
    if (others || kept.inside || kept.moved + kept.turned * proxy.tool().radius() > most_travel) {
        std::ranges::fill(kept.expiry, -1.0);
        kept.moved = kept.turned = 0;
        kept.isovalue = proxy.isovalue;
        kept.renewed = false;
    }
    if (others || kept.inside) {
        const Vec3 start = proxy.pose.position;
        kept.inside = !tool::recover(proxy, around, observer);
        result.searched =
            std::max((proxy.pose.position - start).norm(), tool::searched_so_far(proxy, around));
    }
    proxy.placed = true;
    if (!kept.inside) {
        tool::Rounds rounds(proxy, around, result.hand, settings, observer);
        result.status = rounds.run(result.rounds);
    } else {
        proxy.mode = Mode::constrained;
        result.status = UpdateStatus::recovering;
    }
    result.mode = proxy.mode;
    result.proxy = proxy.pose;
    result.work = budget + looks - around.work_left();
    for (int i = 0; i < proxy.contact_count; ++i) {
        result.contacts += proxy.contacts[i].pressure > 0;
    }
    return result;
}

}  // namespace palpate
