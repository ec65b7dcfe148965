// Draws a tool by its shape, or where that is not known by its points.
#include "apps/viewer/scene/tool_marks.hpp"

#include <vtkAppendPolyData.h>
#include <vtkCellArray.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataNormals.h>
#include <vtkProperty.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "pictures/vtk/material.hpp"
#include "pictures/vtk/shapes.hpp"

namespace palpate::viewer {
namespace {

using pictures::Colour;

constexpr Colour contact_colour{0.8, 0.475, 0.655};  // reddish purple (Okabe and Ito)
constexpr double hand_opacity = 0.35;
// [logical pixels]
constexpr double normal_px = 40, normal_width_px = 2.2, ring_px = 34, ring_width_px = 2.2;
constexpr double point_px = 5;

vtkSmartPointer<vtkPolyData> shape_of(const Tool& tool) {
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> cells;
    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points);
    if (tool.shape().triangles.empty()) {
        for (const Vec3& point : tool.points()) {
            const vtkIdType at = points->InsertNextPoint(point.data());
            cells->InsertNextCell(1, &at);
        }
        data->SetVerts(cells);
        return data;
    }
    for (const Vec3& vertex : tool.shape().vertices) points->InsertNextPoint(vertex.data());
    for (const auto& triangle : tool.shape().triangles) {
        cells->InsertNextCell(3);
        for (const std::uint32_t i : triangle) cells->InsertCellPoint(i);
    }
    data->SetPolys(cells);
    vtkNew<vtkPolyDataNormals> normals;
    normals->SetInputData(data);
    normals->ConsistencyOff();
    normals->Update();
    return normals->GetOutput();
}

void place(vtkActor& actor, const Pose& pose, const Vec3& origin) {
    const Mat3 rotation = pose.orientation.toRotationMatrix();
    const Vec3 at = pose.position - origin;
    vtkNew<vtkMatrix4x4> matrix;
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) matrix->SetElement(r, c, rotation(r, c));
        matrix->SetElement(r, 3, at[r]);
    }
    actor.SetUserMatrix(matrix);
}

void draw_points_as_balls(vtkActor& actor, double pixel_ratio) {
    actor.GetProperty()->SetPointSize(static_cast<float>(point_px * pixel_ratio));
    actor.GetProperty()->RenderPointsAsSpheresOn();
}

}  // namespace

std::optional<SeenTool> seen_tool(const std::optional<Snapshot>& snapshot,
                                  const std::shared_ptr<const Tool>& tool) {
    if (!tool || !snapshot || snapshot->session.device.status != DeviceStatus::ready) return {};
    const Tick& tick = snapshot->session.tick;
    if (!tick.proxy.hip.allFinite() || !tick.proxy.scp.allFinite()) return {};
    SeenTool seen;
    seen.tool = tool;
    seen.hand = {tick.proxy.hip, tick.tool.hand};
    seen.proxy = {tick.proxy.scp, tick.tool.proxy};
    seen.torque = snapshot->session.transform.rotation * tick.torque;
    const auto end = snapshot->contacts.begin() + snapshot->contact_count;
    std::copy_if(snapshot->contacts.begin(), end, std::back_inserter(seen.contacts),
                 [](const ToolContact& contact) { return contact.pressure > 0; });
    return seen;
}

ToolMarks::ToolMarks(vtkRenderer& solid, vtkRenderer& overlay, const HandColours& colours)
    : hand_(vtkSmartPointer<vtkActor>::New()) {
    const auto nothing = [] { return vtkSmartPointer<vtkPolyData>::New(); };
    proxy_ = twin_of(colours.scp, nothing());
    contacts_ = twin_of(contact_colour, nothing());
    torque_ = twin_of(pictures::force_colour, nothing());
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(proxy_.data);
    mapper->ScalarVisibilityOff();
    hand_->SetMapper(mapper);
    hand_->GetProperty()->SetColor(colours.hip.red, colours.hip.green, colours.hip.blue);
    pictures::look_matt(*hand_);
    hand_->GetProperty()->SetOpacity(hand_opacity);
    hand_->SetVisibility(false);
    for (const Twin* twin : {&proxy_, &contacts_, &torque_}) solid.AddActor(twin->solid);
    solid.AddActor(hand_);
    // Behind the tool they are seen through it.
    add_faint_actors(overlay, {&contacts_, &torque_});
    add_faint_actors(overlay, {&proxy_});
    proxy_.faint->GetProperty()->SetOpacity(0.6 * faint_opacity);
}

void ToolMarks::use_shape(const std::shared_ptr<const Tool>& tool) {
    if (tool == tool_) return;
    tool_ = tool;
    proxy_.data->ShallowCopy(shape_of(*tool));
}

/// Normals at the points that hold the tool, out of the solid.
void ToolMarks::show_contacts(const SeenTool& seen, const Vec3& origin, double pixel) {
    vtkNew<vtkAppendPolyData> all;
    for (const ToolContact& contact : seen.contacts) {
        const Vec3 at = contact.place - origin;
        const auto stick =
            pictures::arrow(at, at + normal_px * pixel * contact.normal, normal_width_px * pixel);
        all->AddInputData(stick);
    }
    set_visible(contacts_, !seen.contacts.empty());
    if (seen.contacts.empty()) return;
    all->Update();
    contacts_.data->ShallowCopy(all->GetOutput());
}

/// An arc round its axis, by the right hand, as long as the force that it is at the tool's
/// gyration.
void ToolMarks::show_torque(const SeenTool& seen, const Vec3& origin, double pixel) {
    const double newtons = seen.torque.norm() / seen.tool->gyration();
    constexpr double least = 0.02;  // [N]
    set_visible(torque_, newtons > least);
    if (!(newtons > least)) return;
    const Vec3 axis = seen.torque.normalized();
    const Vec3 across = axis.unitOrthogonal(), further = axis.cross(across);
    const double radius = ring_px * pixel, angle = std::clamp(2 * newtons, 0.7, 5.5);
    const Vec3 centre = seen.hand.position - origin;
    constexpr int steps = 40;
    std::vector<Vec3> path;
    for (int i = 0; i <= steps; ++i) {
        const double at = angle * i / steps;
        path.push_back(centre + radius * (std::cos(at) * across + std::sin(at) * further));
    }
    const Vec3 ahead = -std::sin(angle) * across + std::cos(angle) * further;
    vtkNew<vtkAppendPolyData> all;
    all->AddInputData(pictures::tube(path, ring_width_px * pixel));
    all->AddInputData(
        pictures::arrow(path.back(), path.back() + 0.5 * radius * ahead, ring_width_px * pixel));
    all->Update();
    torque_.data->ShallowCopy(all->GetOutput());
}

void ToolMarks::show(const std::optional<SeenTool>& seen, const Vec3& origin, double pixel,
                     double pixel_ratio) {
    hand_->SetVisibility(false);
    for (const Twin* twin : {&proxy_, &contacts_, &torque_}) set_visible(*twin, false);
    if (!seen) return;
    use_shape(seen->tool);
    const double turned = rotation_between(seen->hand.orientation, seen->proxy.orientation).norm();
    const double apart = (seen->hand.position - seen->proxy.position).norm();
    hand_->SetVisibility(apart + turned * seen->tool->radius() > 0.5 * pixel);
    place(*hand_, seen->hand, origin);
    draw_points_as_balls(*hand_, pixel_ratio);
    for (vtkActor* actor : proxy_.actors()) {
        place(*actor, seen->proxy, origin);
        draw_points_as_balls(*actor, pixel_ratio);
    }
    set_visible(proxy_, true);
    show_contacts(*seen, origin, pixel);
    show_torque(*seen, origin, pixel);
}

}  // namespace palpate::viewer
