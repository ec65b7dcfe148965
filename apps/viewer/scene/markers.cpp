// Draws the markers, once with the scene and once faintly over it.
#include "apps/viewer/scene/markers.hpp"

#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkOpenGLRenderWindow.h>
#include <vtkOpenGLState.h>
#include <vtkPoints.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkSphereSource.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "pictures/vtk/material.hpp"
#include "pictures/vtk/shapes.hpp"

namespace palpate::viewer {
namespace {

/// Switches the writing of colours, among the opaque props in its turn.
class ColourWriting : public vtkProp {
  public:
    static ColourWriting* New() {
        auto* const made = new ColourWriting;
        made->InitializeObjectBase();
        return made;
    }
    double* GetBounds() override { return nullptr; }
    int RenderOpaqueGeometry(vtkViewport* viewport) override {
        auto* const window = vtkOpenGLRenderWindow::SafeDownCast(
            vtkRenderer::SafeDownCast(viewport)->GetRenderWindow());
        const unsigned char write = on ? 1 : 0;
        window->GetState()->vtkglColorMask(write, write, write, write);
        return 0;
    }
    bool on = true;
};

}  // namespace

Twin twin_of(const pictures::Colour& colour, vtkSmartPointer<vtkPolyData> data) {
    const auto make = [] { return vtkSmartPointer<vtkActor>::New(); };
    Twin twin{make(), make(), make(), std::move(data)};
    for (vtkActor* actor : twin.actors()) {
        vtkNew<vtkPolyDataMapper> mapper;
        mapper->SetInputData(twin.data);
        mapper->ScalarVisibilityOff();
        actor->SetMapper(mapper);
        actor->GetProperty()->SetColor(colour.red, colour.green, colour.blue);
        pictures::look_matt(*actor);
        actor->GetProperty()->SetSpecular(0.35);
        actor->SetVisibility(false);
    }
    twin.faint->GetProperty()->SetOpacity(faint_opacity);
    twin.faint->ForceOpaqueOn();
    return twin;
}

void set_visible(const Twin& twin, bool visible) {
    for (vtkActor* actor : twin.actors()) actor->SetVisibility(visible);
}

/// Depths are drawn first.
void add_faint_actors(vtkRenderer& overlay, std::initializer_list<const Twin*> twins) {
    const auto writing = [&overlay](bool on) {
        vtkNew<ColourWriting> prop;
        prop->on = on;
        overlay.AddViewProp(prop);
    };
    writing(false);
    for (const Twin* twin : twins) overlay.AddActor(twin->depth);
    writing(true);
    for (const Twin* twin : twins) overlay.AddActor(twin->faint);
}

namespace {

/// Points and cells that become a VTK mesh.
class Shape {
  public:
    Shape() { points_->SetDataTypeToFloat(); }
    vtkIdType point(const Vec3& at) { return points_->InsertNextPoint(at.data()); }
    void polygon(const std::vector<vtkIdType>& corners) {
        polygons_->InsertNextCell(static_cast<vtkIdType>(corners.size()), corners.data());
    }
    void line(vtkIdType a, vtkIdType b) {
        const vtkIdType ends[] = {a, b};
        lines_->InsertNextCell(2, ends);
    }
    void move_to(vtkPolyData& data) {
        data.Initialize();
        data.SetPoints(points_);
        data.SetPolys(polygons_);
        data.SetLines(lines_);
    }

  private:
    vtkNew<vtkPoints> points_;
    vtkNew<vtkCellArray> polygons_, lines_;
};

}  // namespace

void put_edges(vtkPolyData& data, const std::vector<LocalTetrahedron>& all, const Vec3& origin) {
    std::vector<std::array<Vec3, 2>> edges;
    const auto before = [](const Vec3& a, const Vec3& b) {
        return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
    };
    for (const LocalTetrahedron& t : all) {
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t j = i + 1; j < 4; ++j) {
                std::array<Vec3, 2> edge{t.corners[i], t.corners[j]};
                if (before(edge[1], edge[0])) std::swap(edge[0], edge[1]);
                const bool known = std::ranges::any_of(edges, [&](const auto& e) {
                    return e[0].isApprox(edge[0], 1e-9) && e[1].isApprox(edge[1], 1e-9);
                });
                if (!known) edges.push_back(edge);
            }
        }
    }
    Shape shape;
    for (const auto& [a, b] : edges) shape.line(shape.point(a - origin), shape.point(b - origin));
    shape.move_to(data);
}

void put_patches(vtkPolyData& data, const std::vector<LocalTetrahedron>& all, const Vec3& origin) {
    Shape shape;
    for (const LocalTetrahedron& t : all) {
        for (const std::vector<Vec3>& polygon : t.patch) {
            std::vector<vtkIdType> corners;
            for (const Vec3& corner : polygon) corners.push_back(shape.point(corner - origin));
            shape.polygon(corners);
        }
    }
    shape.move_to(data);
}

void put_planes(vtkPolyData& discs, vtkPolyData& normals, const std::vector<LocalTetrahedron>& all,
                const Vec3& origin, double voxel) {
    Shape disc, needle;
    for (const LocalTetrahedron& t : all) {
        if (!t.plane) continue;
        const Vec3 at = t.plane->point - origin;
        const Vec3 u = t.plane->normal.unitOrthogonal(), v = t.plane->normal.cross(u);
        std::vector<vtkIdType> rim;
        for (int i = 0; i < 36; ++i) {
            const double angle = 2 * std::numbers::pi * i / 36;
            rim.push_back(
                disc.point(at + 0.75 * voxel * (std::cos(angle) * u + std::sin(angle) * v)));
        }
        disc.polygon(rim);
        needle.line(needle.point(at), needle.point(at + 0.75 * voxel * t.plane->normal));
    }
    disc.move_to(discs);
    needle.move_to(normals);
}

namespace {

constexpr Colour plane_colour{0.8, 0.475, 0.655};  // reddish purple (Okabe and Ito)

vtkSmartPointer<vtkPolyData> unit_ball() {
    vtkNew<vtkSphereSource> source;
    source->SetRadius(1);
    source->SetThetaResolution(32);
    source->SetPhiResolution(20);
    source->Update();
    return source->GetOutput();
}

/// Of radius 1, one across each axis.
vtkSmartPointer<vtkPolyData> three_circles() {
    constexpr int corners = 64;
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> lines;
    for (int axis = 0; axis < 3; ++axis) {
        lines->InsertNextCell(corners + 1);
        const vtkIdType first = points->GetNumberOfPoints();
        for (int i = 0; i < corners; ++i) {
            Vec3 at = Vec3::Zero();
            at[(axis + 1) % 3] = std::cos(2 * std::numbers::pi * i / corners);
            at[(axis + 2) % 3] = std::sin(2 * std::numbers::pi * i / corners);
            lines->InsertCellPoint(points->InsertNextPoint(at.data()));
        }
        lines->InsertCellPoint(first);
    }
    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points);
    data->SetLines(lines);
    return data;
}

void place(vtkActor& actor, const Vec3& at, double scale) {
    actor.SetPosition(Vec3(at).data());
    actor.SetScale(scale);
}

void flat(vtkActor& actor, double opacity) {
    actor.GetProperty()->LightingOff();
    actor.GetProperty()->SetOpacity(opacity);
}

}  // namespace

std::optional<Contact> contact_of(const std::optional<Snapshot>& snapshot, const Field& field,
                                  bool with_lattice) {
    if (!snapshot || snapshot->session.device.status != DeviceStatus::ready) return std::nullopt;
    const SessionTick& tick = snapshot->session;
    const ProxyUpdate& proxy = tick.tick.proxy;
    if (!proxy.hip.allFinite() || !proxy.scp.allFinite()) return std::nullopt;
    Contact contact;
    contact.hip = proxy.hip;
    contact.scp = proxy.scp;
    contact.force = tick.transform.rotation * tick.tick.force;
    if (with_lattice) contact.lattice = local_tetrahedra(field, snapshot->scp, proxy.isovalue);
    return contact;
}

Markers::Markers(vtkRenderer& solid, vtkRenderer& overlay, const HandColours& colours)
    : solid_(solid), patch_actor_(vtkSmartPointer<vtkActor>::New()) {
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->ScalarVisibilityOff();
    patch_actor_->SetMapper(mapper);
    patch_actor_->SetVisibility(false);
    pictures::look_matt(*patch_actor_);
    pictures::face_the_viewer(*patch_actor_);
    solid_.AddActor(patch_actor_);
    const auto nothing = [] { return vtkSmartPointer<vtkPolyData>::New(); };
    edges_ = twin_of(pictures::spring_colour, nothing());
    spring_ = twin_of(pictures::spring_colour, nothing());
    arrow_ = twin_of(pictures::force_colour, nothing());
    scp_ = twin_of(colours.scp, unit_ball());
    hip_ = twin_of(colours.hip, unit_ball());
    brush_ = twin_of(brush_colour, three_circles());
    normals_ = twin_of(plane_colour, nothing());
    discs_ = twin_of(plane_colour, nothing());
    patches_ = twin_of(colours.scp, nothing());
    for (const Twin* twin :
         {&edges_, &spring_, &arrow_, &scp_, &hip_, &brush_, &normals_, &discs_, &patches_}) {
        solid_.AddActor(twin->solid);
    }
    for (const Twin* twin : {&edges_, &brush_, &normals_}) {
        flat(*twin->solid, 1);
        flat(*twin->faint, faint_opacity);
    }
    flat(*discs_.solid, 0.35);
    flat(*patches_.solid, 0.6);
    add_faint_actors(overlay, {&edges_, &spring_, &arrow_, &scp_, &hip_, &brush_, &normals_});
}

void Markers::show_probe(const Contact& contact, const Vec3& origin, double pixel) {
    const double radius = ball_radius_px * pixel;
    const Vec3 hip = contact.hip - origin, scp = contact.scp - origin;
    const bool apart = contact.hip != contact.scp;
    for (vtkActor* actor : hip_.actors()) place(*actor, hip, radius);
    for (vtkActor* actor : scp_.actors()) place(*actor, scp, radius);
    set_visible(hip_, !contact.as_tool);
    set_visible(scp_, apart && !contact.as_tool);
    const bool sprung = apart && (scp - hip).norm() > 2 * radius;
    set_visible(spring_, sprung);
    if (sprung) spring_.data->ShallowCopy(pictures::spring(hip, scp, 0.5 * radius));
    const double newtons = contact.force.norm();
    set_visible(arrow_, newtons > 0);
    if (newtons > 0) {
        const double length =
            pixel * std::clamp(newton_px * newtons, shortest_arrow_px, longest_arrow_px);
        const Vec3 tip = scp + length / newtons * contact.force;
        arrow_.data->ShallowCopy(pictures::arrow(scp, tip, 0.35 * radius));
    }
}

void Markers::show_patch(const std::shared_ptr<const RenderMesh>& patch, const Colour& colour) {
    patch_actor_->SetVisibility(patch != nullptr);
    patch_actor_->GetProperty()->SetColor(colour.red, colour.green, colour.blue);
    if (!patch || patch == patch_) return;
    static_cast<vtkPolyDataMapper*>(patch_actor_->GetMapper())
        ->SetInputData(pictures::mesh_of(patch->positions, patch->normals, patch->triangles));
    patch_ = patch;
}

void Markers::show_lattice(const Contact& contact, const Look& look, const Vec3& origin,
                           double voxel) {
    set_visible(edges_, look.tetrahedra && !contact.lattice.empty());
    patches_.solid->SetVisibility(look.tetrahedra && !contact.lattice.empty());
    discs_.solid->SetVisibility(look.planes && !contact.lattice.empty());
    set_visible(normals_, look.planes && !contact.lattice.empty());
    if (look.tetrahedra) {
        put_edges(*edges_.data, contact.lattice, origin);
        put_patches(*patches_.data, contact.lattice, origin);
    }
    if (look.planes) put_planes(*discs_.data, *normals_.data, contact.lattice, origin, voxel);
}

void Markers::show(const std::optional<Contact>& contact, const Look& look, const Vec3& origin,
                   double pixel, double voxel, const Colour& ink, double pixel_ratio) {
    for (const Twin* twin : {&hip_, &scp_, &spring_, &arrow_, &brush_, &edges_, &normals_}) {
        set_visible(*twin, false);
    }
    patches_.solid->SetVisibility(false);
    discs_.solid->SetVisibility(false);
    show_patch(contact ? contact->patch : nullptr, look.surface_colour);
    if (!contact) return;
    for (vtkActor* actor : edges_.actors()) {
        actor->GetProperty()->SetColor(ink.red, ink.green, ink.blue);
        actor->GetProperty()->SetLineWidth(static_cast<float>(1.5 * pixel_ratio));
    }
    for (vtkActor* actor : normals_.actors()) {
        actor->GetProperty()->SetLineWidth(static_cast<float>(2 * pixel_ratio));
    }
    if (look.contact) show_probe(*contact, origin, pixel);
    set_visible(brush_, contact->brush > 0);
    for (vtkActor* actor : brush_.actors()) {
        place(*actor, contact->scp - origin, contact->brush);
        actor->GetProperty()->SetLineWidth(static_cast<float>(1.5 * pixel_ratio));
    }
    show_lattice(*contact, look, origin, voxel);
}

}  // namespace palpate::viewer
