// Collects the points of a stroke.
#include "apps/viewer/model/stroke.hpp"

#include <cmath>

namespace palpate::viewer {
namespace {

// Nearer to the last point than this nothing is added: a hand at rest adds nothing.
constexpr double unseen_mm = 0.01, unseen_newtons = 0.005;

}  // namespace

bool Stroke::add(const Snapshot& now) {
    const Tick& tick = now.session.tick;
    const bool jumped = begun_ && (tick.time < time_ || tick.time > time_ + pause);
    if (jumped) clear();
    time_ = tick.time;
    const bool felt = tick.layers.touched >= 0 || tick.layers.inside > 0;
    if (felt) inside_at_ = tick.time;
    if (!felt && (!begun_ || tick.time < inside_at_ + pause)) return jumped;
    if (!felt) {
        begun_ = false;  // what was felt stays until the next contact
        return jumped;
    }
    if (!tick.proxy.hip.allFinite() || !tick.proxy.scp.allFinite()) return jumped;
    if (!begun_) {
        if (tick.layers.touched < 0) return jumped;
        points_.clear();
        origin_ = tick.proxy.scp;
        const Vec3 pull = tick.proxy.hip - tick.proxy.scp;
        into_ = now.normal.norm() > 0.5 ? Vec3(-now.normal) : Vec3(pull.normalized());
        if (into_.dot(pull) < 0) into_ = -into_;  // met from inside
        begun_ = true;
    }
    const Point point{(tick.proxy.hip - origin_).dot(into_), tick.force.norm(),
                      tick.layers.touched};
    if (!points_.empty()) {
        const Point& last = points_.back();
        if (last.layer == point.layer && std::abs(last.depth - point.depth) < unseen_mm &&
            std::abs(last.force - point.force) < unseen_newtons) {
            return jumped;
        }
    }
    if (points_.size() >= most_points) points_.erase(points_.begin(), points_.begin() + 1000);
    points_.push_back(point);
    return true;
}

}  // namespace palpate::viewer
