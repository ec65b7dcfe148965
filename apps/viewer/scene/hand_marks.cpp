// Finds the tetrahedra at a point and cuts them with the isosurface, and turns a snapshot into
// marks.
#include "apps/viewer/scene/hand_marks.hpp"

#include <vtkAppendPolyData.h>
#include <vtkNew.h>
#include <vtkPolyDataNormals.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "apps/viewer/scene/surface_blocks.hpp"
#include "palpate/surface.hpp"
#include "pictures/vtk/shapes.hpp"

namespace palpate::viewer {
namespace {

/// How near to the isovalue the density at the SCP has to be for it to lie on the surface, relative
/// to the data's range: a good deal more than the proxy's promise (G2).
constexpr double on_surface = 1e-6;

/// A cubic field's tetrahedron is cut in so many parts along each edge.
constexpr int parts = 4;

/// The parts of a tetrahedron, n^3 of one shape class and size, by their corners in steps along its
/// edges 0-1, 1-2 and 2-3.
std::vector<std::array<Index3, 4>> parts_of(int n) {
    std::vector<std::array<Index3, 4>> all;
    for (int i = 0; i < n * n * n; ++i) {
        std::array<int, 3> order{0, 1, 2};
        do {
            std::array<Index3, 4> part{Index3(i % n, i / n % n, i / (n * n))};
            for (std::size_t step = 0; step < 3; ++step) {
                part[step + 1] = part[step];
                ++part[step + 1][order[step]];
            }
            if (std::ranges::all_of(part,
                                    [](const Index3& c) { return c[0] >= c[1] && c[1] >= c[2]; })) {
                all.push_back(part);
            }
        } while (std::ranges::next_permutation(order).found);
    }
    return all;
}

/// The isosurface in the tetrahedron, in folded coordinates.
class Patch {
  public:
    Patch(const Field& field, const Tetrahedron& tetrahedron, double isovalue)
        : field_(field), tetrahedron_(tetrahedron), isovalue_(isovalue) {}

    std::vector<std::vector<Vec3>> polygons() const {
        const int n = field_.interpolation() == Interpolation::cubic ? parts : 1;
        const auto corner = [](std::size_t i) {
            const auto [d, s, e] = folded_corners[i];
            return Vec3(d, s, e);
        };
        std::vector<std::vector<Vec3>> found;
        for (const auto& part : parts_of(n)) {
            std::array<Vec3, 4> corners;
            for (std::size_t c = 0; c < 4; ++c) {
                corners[c] = corner(0);
                for (std::size_t a = 0; a < 3; ++a) {
                    corners[c] += (corner(a + 1) - corner(a)) * part[c][int(a)] / n;
                }
            }
            if (std::vector<Vec3> polygon = cut(corners); !polygon.empty()) {
                found.push_back(std::move(polygon));
            }
        }
        return found;
    }

  private:
    double above(const Vec3& folded) const {
        return value_at(field_, LatticePoint{tetrahedron_, folded}) - isovalue_;
    }
    std::vector<Vec3> cut(const std::array<Vec3, 4>& corners) const {
        std::array<double, 4> value{};
        unsigned solid = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            value[i] = above(corners[i]);
            solid |= unsigned{value[i] > 0} << i;
        }
        const TetrahedronCut cut = cut_of(solid);
        std::vector<Vec3> polygon;
        for (std::size_t i = 0; i < static_cast<std::size_t>(cut.count); ++i) {
            const auto [a, b] = cut.edges[i];
            polygon.push_back(root(corners[a], value[a], corners[b], value[b]));
        }
        return polygon;
    }
    /// By false position: one step is exact on a linear field.
    Vec3 root(Vec3 a, double at_a, Vec3 b, double at_b) const {
        for (int i = 0;; ++i) {
            const Vec3 middle = a + at_a / (at_a - at_b) * (b - a);
            const double value = above(middle);
            if (i == 8 || std::abs(value) <= 1e-9 * field_.range()) return middle;
            if ((value > 0) == (at_a > 0)) {
                a = middle, at_a = value;
            } else {
                b = middle, at_b = value;
            }
        }
    }

    const Field& field_;
    const Tetrahedron& tetrahedron_;
    double isovalue_;
};

}  // namespace

std::vector<LocalTetrahedron> local_tetrahedra(const Field& field, const LatticePoint& point,
                                               double isovalue) {
    const Geometry& g = field.geometry();
    const Interpolation way = field.interpolation();
    const Vec3 scp = physical_from_index(g, index_of(way, point));
    const double off = std::abs(value_at(field, point) - isovalue) / field.range();
    std::vector<LocalTetrahedron> found;
    const Incident incident = incident_tetrahedra(point);
    for (std::size_t i = 0; i < static_cast<std::size_t>(incident.count); ++i) {
        const Tetrahedron& tetrahedron = incident.tetrahedra[i];
        LocalTetrahedron local;
        const auto place = [&](const Vec3& folded) {
            return physical_from_index(g, index_of(way, LatticePoint{tetrahedron, folded}));
        };
        for (std::size_t c = 0; c < 4; ++c) {
            const auto [d, s, e] = folded_corners[c];
            local.corners[c] = place({d, s, e});
        }
        local.patch = Patch(field, tetrahedron, isovalue).polygons();
        for (auto& polygon : local.patch) std::ranges::transform(polygon, polygon.begin(), place);
        const Vec3 gradient =
            g.direction *
            gradient_at(field, LatticePoint{tetrahedron, point.folded}).cwiseQuotient(g.spacing);
        if (off <= on_surface && gradient.norm() > 0) {
            local.plane = ConstraintPlane{scp, -field.sign() * gradient.normalized()};
        }
        found.push_back(std::move(local));
    }
    return found;
}

std::shared_ptr<const RenderMesh> local_patch(const Field& field, const Vec3& physical,
                                              double isovalue) {
    constexpr int edge = 24;  // [cells]
    const Geometry& g = field.geometry();
    const Vec3 index = index_from_physical(g, physical);
    if (!(index.cwiseAbs().maxCoeff() <= farthest_index)) return nullptr;
    const Vec3 first = (index - Vec3::Constant(0.5 * edge)).array().round();
    const Vec3 middle = physical_centre(g);
    const auto block = block_mesh(field, isovalue, first.cast<int>(), edge, middle);
    if (!block) return nullptr;
    // Round, not a cube's shape.
    const double radius = (0.5 * edge - 1) * g.spacing.minCoeff();
    auto patch = std::make_shared<RenderMesh>(*block);
    patch->triangles.clear();
    const auto inside = [&](std::int32_t v) {
        const float* const at = patch->positions.data() + 3 * static_cast<std::size_t>(v);
        return (Vec3(at[0], at[1], at[2]) + middle - physical).norm() < radius;
    };
    for (std::size_t t = 0; t + 2 < block->triangles.size(); t += 3) {
        const std::int32_t* const corners = block->triangles.data() + t;
        if (std::all_of(corners, corners + 3, inside)) {
            patch->triangles.insert(patch->triangles.end(), corners, corners + 3);
        }
    }
    return patch->triangles.empty() ? nullptr : patch;
}

namespace {

constexpr Colour purple{0.8, 0.475, 0.655};  // reddish purple (Okabe and Ito)
// [logical pixels]
constexpr double normal_px = 40, normal_width_px = 2.2, ring_px = 34, ring_width_px = 2.2;
constexpr double point_px = 5;

Mark mark_of(vtkSmartPointer<vtkPolyData> shape, const Colour& colour) {
    Mark mark;
    mark.shape = std::move(shape);
    mark.colour = colour;
    mark.faint = faint_opacity;
    return mark;
}

/// Hand and proxy, where they are drawn as balls, the spring between them, and the force.
void add_probe(std::vector<Mark>& marks, const SeenHand& hand, bool as_tool, const MarkView& view,
               const HandShapes& shapes) {
    const SessionTick& tick = hand.snapshot->session;
    const double radius = ball_radius_px * view.pixel;
    const Vec3 hip = tick.tick.proxy.hip - view.origin, scp = tick.tick.proxy.scp - view.origin;
    const auto add = [&](bool there, const auto& shape, const Colour& colour) {
        marks.push_back(mark_of(there ? shape() : nullptr, colour));
    };
    const auto ball = [&](bool there, const Vec3& at, const Colour& colour) {
        add(
            there, [&] { return shapes.ball; }, colour);
        marks.back().place = at_scale(at, radius);
    };
    ball(hip != scp && !as_tool, scp, hand.colours.scp);
    ball(!as_tool, hip, hand.colours.hip);
    const auto spring = [&] { return pictures::spring(hip, scp, 0.5 * radius); };
    add((scp - hip).norm() > 2 * radius, spring, pictures::spring_colour);
    const Vec3 force = tick.transform.rotation * tick.tick.force;
    const double newtons = force.norm();
    const auto arrow = [&] {
        const double length =
            view.pixel * std::clamp(newton_px * newtons, shortest_arrow_px, longest_arrow_px);
        return pictures::arrow(scp, scp + length / newtons * force, 0.35 * radius);
    };
    add(newtons > 0, arrow, pictures::force_colour);
}

/// Each edge once.
vtkSmartPointer<vtkPolyData> lattice_edges(const std::vector<LocalTetrahedron>& all,
                                           const Vec3& origin) {
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
    MarkShape shape;
    shape.lines(edges, origin);
    return shape.data();
}

/// The isosurface in the tetrahedra.
vtkSmartPointer<vtkPolyData> lattice_patches(const std::vector<LocalTetrahedron>& all,
                                             const Vec3& origin) {
    MarkShape shape;
    for (const LocalTetrahedron& t : all) {
        for (const std::vector<Vec3>& polygon : t.patch) {
            std::vector<vtkIdType> corners;
            for (const Vec3& corner : polygon) corners.push_back(shape.point(corner - origin));
            shape.polygon(corners);
        }
    }
    return shape.data();
}

/// A disc, one and a half voxels [mm] wide, for each constraint plane, and its normal as a line.
void add_planes(std::vector<Mark>& marks, const std::vector<LocalTetrahedron>& all,
                const MarkView& view, double voxel) {
    MarkShape discs, normals;
    const double radius = 0.75 * voxel;
    for (const LocalTetrahedron& t : all) {
        if (!t.plane) continue;
        const Vec3 at = t.plane->point - view.origin, normal = t.plane->normal;
        const Vec3 u = normal.unitOrthogonal();
        discs.polygon(discs.ring(at, radius * u, radius * normal.cross(u), 36));
        normals.lines({{at, at + radius * normal}}, Vec3::Zero());
    }
    marks.push_back(flat_mark(normals.data(), purple, 2 * view.ratio, faint_opacity));
    marks.push_back(flat_mark(discs.data(), purple, 1));
    marks.back().opacity = 0.35;
}

/// Marks for the lattice at the proxy, as in the paper's figures.
void add_lattice(std::vector<Mark>& marks, const SeenHand& hand, const Look& look,
                 const Field& field, const MarkView& view, const Colour& ink) {
    if (!look.tetrahedra && !look.planes) return;
    const double level = hand.snapshot->session.tick.proxy.isovalue;
    const auto all = local_tetrahedra(field, hand.snapshot->scp, level);
    if (look.tetrahedra) {
        marks.push_back(
            flat_mark(lattice_edges(all, view.origin), ink, 1.5 * view.ratio, faint_opacity));
        marks.push_back(flat_mark(lattice_patches(all, view.origin), hand.colours.scp, 1));
        marks.back().opacity = 0.6;
    }
    if (look.planes) add_planes(marks, all, view, field.geometry().spacing.mean());
}

vtkSmartPointer<vtkPolyData> appended(const std::vector<vtkSmartPointer<vtkPolyData>>& parts) {
    if (parts.empty()) return nullptr;
    vtkNew<vtkAppendPolyData> all;
    for (const auto& part : parts) all->AddInputData(part);
    all->Update();
    return all->GetOutput();
}

/// Normals at the points that hold the tool, out of the solid.
vtkSmartPointer<vtkPolyData> contacts_of(const Snapshot& now, const MarkView& view) {
    std::vector<vtkSmartPointer<vtkPolyData>> sticks;
    for (std::size_t i = 0; i < static_cast<std::size_t>(now.contact_count); ++i) {
        const ToolContact& contact = now.contacts[i];
        if (!(contact.pressure > 0)) continue;
        const Vec3 at = contact.place - view.origin;
        sticks.push_back(pictures::arrow(at, at + normal_px * view.pixel * contact.normal,
                                         normal_width_px * view.pixel));
    }
    return appended(sticks);
}

/// An arc round its axis, by the right hand, as long as the force that it is at the tool's
/// gyration.
vtkSmartPointer<vtkPolyData> torque_of(const SessionTick& tick, const Tool& tool,
                                       const MarkView& view) {
    constexpr double least = 0.02;  // [N]
    constexpr int steps = 40;
    const Vec3 torque = tick.transform.rotation * tick.tick.torque;  // [N mm] on the hand
    const double newtons = torque.norm() / tool.gyration();
    if (!(newtons > least)) return nullptr;
    const Vec3 axis = torque.normalized();
    const Vec3 across = axis.unitOrthogonal(), further = axis.cross(across);
    const double radius = ring_px * view.pixel, angle = std::clamp(2 * newtons, 0.7, 5.5);
    const Vec3 centre = tick.tick.proxy.hip - view.origin;
    std::vector<Vec3> path;
    for (int i = 0; i <= steps; ++i) {
        const double at = angle * i / steps;
        path.push_back(centre + radius * (std::cos(at) * across + std::sin(at) * further));
    }
    const Vec3 ahead = -std::sin(angle) * across + std::cos(angle) * further;
    const double width = ring_width_px * view.pixel;
    return appended({pictures::tube(path, width),
                     pictures::arrow(path.back(), path.back() + 0.5 * radius * ahead, width)});
}

/// The tool where its proxy is, and transparent in the hand, with contacts and torque, which are
/// seen through it.
void add_tool(std::vector<Mark>& marks, const SeenHand& hand, const MarkView& view) {
    const Tick& tick = hand.snapshot->session.tick;
    const Vec3 hip = tick.proxy.hip - view.origin, scp = tick.proxy.scp - view.origin;
    const auto tool = [&](const Vec3& at, const Quaternion& turned, const Colour& colour) {
        Mark mark = mark_of(hand.tool_shape, colour);
        mark.place = Eigen::Translation3d(at) * Eigen::Quaterniond(turned);
        mark.width = point_px * view.ratio;
        return mark;
    };
    Mark proxy = tool(scp, tick.tool.proxy, hand.colours.scp);
    proxy.faint = 0.6 * faint_opacity;
    proxy.veil = true;
    Mark held = tool(hip, tick.tool.hand, hand.colours.hip);
    held.opacity = 0.35;
    held.faint = 0;
    const double turned = rotation_between(tick.tool.hand, tick.tool.proxy).norm();
    if (!((hip - scp).norm() + turned * hand.tool->radius() > 0.5 * view.pixel)) {
        held.shape = nullptr;
    }
    marks.insert(marks.end(), {proxy, held});
    marks.push_back(mark_of(contacts_of(*hand.snapshot, view), purple));
    marks.push_back(
        mark_of(torque_of(hand.snapshot->session, *hand.tool, view), pictures::force_colour));
}

}  // namespace

bool is_seen(const SeenHand& hand) {
    if (!hand.snapshot || hand.snapshot->session.device.status != DeviceStatus::ready) return false;
    const ProxyUpdate& proxy = hand.snapshot->session.tick.proxy;
    return proxy.hip.allFinite() && proxy.scp.allFinite();
}

vtkSmartPointer<vtkPolyData> shape_of(const Tool& tool) {
    MarkShape shape;
    if (tool.shape().triangles.empty()) {
        for (const Vec3& point : tool.points()) shape.dot(shape.point(point));
        return shape.data();
    }
    for (const Vec3& vertex : tool.shape().vertices) shape.point(vertex);
    for (const auto& t : tool.shape().triangles) shape.polygon({t[0], t[1], t[2]});
    vtkNew<vtkPolyDataNormals> normals;
    normals->SetInputData(shape.data());
    normals->ConsistencyOff();
    normals->Update();
    return normals->GetOutput();
}

/// One circle across each axis.
HandShapes::HandShapes() : ball(unit_ball()) {
    MarkShape shape;
    for (int axis = 0; axis < 3; ++axis) {
        const auto ring =
            shape.ring(Vec3::Zero(), Vec3::Unit((axis + 1) % 3), Vec3::Unit((axis + 2) % 3), 64);
        for (std::size_t i = 0; i < ring.size(); ++i) {
            shape.line(ring[i], ring[(i + 1) % ring.size()]);
        }
    }
    circles = shape.data();
}

void add_hand(std::vector<Mark>& marks, const SeenHand& hand, const Look& look, const Field& field,
              const MarkView& view, const Colour& ink, const HandShapes& shapes) {
    if (look.contact) {
        if (hand.tool) add_tool(marks, hand, view);
        // One that would be smaller than the balls is better seen by those.
        const bool as_tool = hand.tool && hand.tool->radius() > ball_radius_px * view.pixel;
        add_probe(marks, hand, as_tool, view, shapes);
    }
    Mark brush = flat_mark(hand.brush > 0 ? shapes.circles : nullptr, brush_colour,
                           1.5 * view.ratio, faint_opacity);
    brush.place = at_scale(hand.snapshot->session.tick.proxy.scp - view.origin, hand.brush);
    marks.push_back(brush);
    add_lattice(marks, hand, look, field, view, ink);
    if (!hand.patch) return;
    Mark patch;
    patch.shape = hand.patch;
    patch.memory = hand.patch_memory;
    patch.colour = look.surface_colour;
    patch.surface = true;
    marks.push_back(patch);
}

}  // namespace palpate::viewer
