// The proxy of a rigid tool alone, without forces: whole trajectories in, arrays out, without the
// GIL.
#include "bindings/python/arrays.hpp"
#include "bindings/python/bindings.hpp"
#include "bindings/python/hands.hpp"
#include "bindings/python/progress.hpp"
#include "palpate/baselines/penalty_tool.hpp"
#include "palpate/proxy.hpp"
#include "palpate/tool_proxy.hpp"

namespace palpate::python {
namespace {

struct NumberedPose {
    std::int64_t tick;
    Pose pose;
};
/// The result of an update, and every pose on its way.
struct ToolPath {
    std::vector<ToolUpdate> updates;
    std::vector<NumberedPose> poses;
};

ToolPath exact_path(const Field& field, double isovalue, std::shared_ptr<const Tool> tool,
                    const io::Trajectory& hands, ReportedItems& slices) {
    ToolPath path;
    ToolProxy proxy(std::move(tool));
    proxy.isovalue = isovalue;
    const PoseObserver observer{[](const Pose& pose, void* to) {
                                    auto& made = *static_cast<ToolPath*>(to);
                                    made.poses.push_back({std::ssize(made.updates), pose});
                                },
                                &path};
    for (std::size_t i = 0; i < hands.time.size(); ++i) {
        const Pose hand{hands.position[i], hands.orientation[i]};
        path.updates.push_back(update_tool(proxy, field, hand, {}, observer));
        slices.done();
    }
    return path;
}

ToolPath penalty_path(const Field& field, double isovalue, std::shared_ptr<const Tool> tool,
                      const io::Trajectory& hands, ReportedItems& slices) {
    ToolPath path;
    baselines::PenaltyTool state{std::move(tool), isovalue};
    for (std::size_t i = 0; i < hands.time.size(); ++i) {
        const Pose hand{hands.position[i], hands.orientation[i]};
        path.updates.emplace_back().proxy = baselines::update_penalty(state, field, hand).proxy;
        slices.done();
    }
    return path;
}

py::dict follow_tool(const Field& field, const io::Level& level, std::shared_ptr<Tool> tool,
                     const Doubles& position, const Doubles& orientation, const std::string& method,
                     const ProgressFunction& progress) {
    if (method != "exact" && method != "penalty") {
        throw std::invalid_argument("method: 'exact' or 'penalty'");
    }
    const double isovalue = felt_level(field, level, "exact", tool);
    const io::Trajectory hands = poses_from(position, orientation);
    if (Proxy proxy; !place(proxy, field, hands.position.front(), isovalue)) {
        throw std::invalid_argument("all of space is solid at this isovalue");
    }
    ReportedItems slices(progress_of(progress), hands.time.size(), batches_in_slice);
    const ToolPath path = without_gil([&] {
        return (method == "exact" ? exact_path : penalty_path)(field, isovalue, tool, hands,
                                                               slices);
    });
    const auto of = [&](const auto& value) { return column(path.updates, value); };
    using Update = ToolUpdate;
    return py::dict(
        py::arg("position") = of([](const Update& u) { return u.proxy.position; }),
        py::arg("orientation_xyzw") = of([](const Update& u) { return u.proxy.orientation; }),
        py::arg("contacts") = of([](const Update& u) { return u.contacts; }),
        py::arg("unfinished") = of([](const Update& u) { return u.status != UpdateStatus::done; }),
        py::arg("recovering") =
            of([](const Update& u) { return u.status == UpdateStatus::recovering; }),
        py::arg("rounds") = of([](const Update& u) { return u.rounds; }),
        py::arg("work") = of([](const Update& u) { return u.work; }),
        py::arg("pose_tick") = column(path.poses, [](const NumberedPose& p) { return p.tick; }),
        py::arg("pose_position") =
            column(path.poses, [](const NumberedPose& p) { return p.pose.position; }),
        py::arg("pose_orientation_xyzw") =
            column(path.poses, [](const NumberedPose& p) { return p.pose.orientation; }));
}

}  // namespace

void bind_tool_paths(py::module_& module) {
    module.def(
        "follow_tool", &follow_tool, py::arg("field"), py::arg("isovalue"),
        py::arg("tool").none(false), py::arg("position"), py::arg("orientation_xyzw"),
        py::arg("method") = "exact", py::kw_only(), py::arg("progress") = py::none(),
        "An update of a tool for each pose of the hand, position [mm, physical], shape (n, 3),\n"
        "and orientation_xyzw, (n, 4); the tool starts at the first pose. method: 'exact', or\n"
        "'penalty', a baseline. Arrays by name: position, orientation_xyzw, contacts, unfinished,\n"
        "recovering, rounds and work of each update; pose_tick, pose_position and\n"
        "pose_orientation_xyzw of every pose on the way, between which each point of the tool\n"
        "goes straight (exact). progress: called with the part that is done. ValueError for what\n"
        "replay() refuses.");
}

}  // namespace palpate::python
