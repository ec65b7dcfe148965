// Messages with the hand, the proxy and the force.
#include <Eigen/Geometry>
#include <cstdio>

#include "bridge/bridge.hpp"

namespace palpate::bridge {
namespace {

std::string words_of(const Snapshot& now) {
    const Tick& tick = now.session.tick;
    const DeviceStatus status = now.session.device.status;
    const char* const state = status != DeviceStatus::ready          ? name_of(status)
                              : now.session.frozen                   ? "frozen"
                              : now.session.clutched                 ? "clutch"
                              : tick.proxy.mode == Mode::constrained ? "contact"
                                                                     : "free";
    char text[128];
    std::snprintf(text, sizeof text, "%s, %.2f N, isovalue %.6g, %lld ticks missed", state,
                  tick.force.norm(), tick.proxy.isovalue, static_cast<long long>(now.missed));
    return text;
}

}  // namespace

std::string frame_of(const Snapshot& now, bool with_tool, double time) {
    const Tick& tick = now.session.tick;
    const Mat3& device = now.session.transform.rotation;
    const Mat3 hand = with_tool ? tick.tool.hand.toRotationMatrix()
                                : Mat3(device * now.session.device.orientation);
    const Mat3 tool = with_tool ? tick.tool.proxy.toRotationMatrix() : hand;
    const auto transform = [&](const char* name, const Mat3& rotation, const Vec3& translation) {
        return message("TRANSFORM", name, transform_body(rotation, translation), time);
    };
    const bool ready = now.session.device.status == DeviceStatus::ready;
    return transform("PalpateHand", hand, tick.proxy.hip) +
           transform("PalpateProxy", Mat3::Identity(), tick.proxy.scp) +
           transform("PalpateTool", tool, tick.proxy.scp) +
           transform("PalpateForce", Mat3::Identity(), device * tick.force) +
           message("STATUS", "Palpate", status_body(ready ? 1 : 13, words_of(now)), time);
}

}  // namespace palpate::bridge
