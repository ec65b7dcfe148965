// Chooses the orientation in which a slice is shown.
#include "apps/viewer/slices/plane.hpp"

#include <QCoreApplication>
#include <QtGlobal>

#include <algorithm>
#include <cmath>

#include "apps/viewer/model/measurement.hpp"

namespace palpate::viewer {
namespace {

// Along +x, +y, +z of physical space (LPS), and against them.
constexpr std::array body_ends{std::array{"L", "P", "S"}, std::array{"R", "A", "I"}};
constexpr std::array grid_ends{std::array{"+X", "+Y", "+Z"}, std::array{"-X", "-Y", "-Z"}};
// Across an axis of which the file does not say what it is.
constexpr std::array plain_titles{"YZ", "XZ", "XY"};
constexpr std::array titles{QT_TRANSLATE_NOOP("palpate::viewer::SlicePane", "Sagittal"),
                            QT_TRANSLATE_NOOP("palpate::viewer::SlicePane", "Coronal"),
                            QT_TRANSLATE_NOOP("palpate::viewer::SlicePane", "Axial")};
/// Below this component [sine of 15 degrees] a direction is as good as along the others.
constexpr double aslant = 0.2588;

/// The body's axis of each grid axis, all three different: those that fit best together.
std::array<int, 3> anatomical_axes(const Mat3& direction) {
    std::array<int, 3> order{0, 1, 2}, best = order;
    double most = -1;
    do {
        double sum = 0;
        for (int a = 0; a < 3; ++a) sum += std::abs(direction(order[std::size_t(a)], a));
        if (sum > most + 1e-12) {
            most = sum;
            best = order;
        }
    } while (std::ranges::next_permutation(order).found);
    return best;
}

const char* end_of(const Geometry& geometry, int axis, bool positive) {
    return (geometry.oriented ? body_ends : grid_ends)[positive ? 0 : 1][std::size_t(axis)];
}

std::string letters_towards(const Geometry& geometry, const Vec3& direction) {
    std::array<int, 3> order{0, 1, 2};
    std::ranges::stable_sort(order, std::greater{}, [&](int a) { return std::abs(direction[a]); });
    std::string letters;
    for (const int a : order) {
        if (!letters.empty() && std::abs(direction[a]) < aslant) break;
        letters += end_of(geometry, a, direction[a] > 0);
    }
    return letters;
}

}  // namespace

SlicePlane slice_plane(const Geometry& grid, int axis) {
    const Mat3& direction = grid.direction;
    const std::array<int, 3> body = anatomical_axes(direction);
    SlicePlane plane;
    plane.grid = grid;
    plane.axis = axis;
    plane.anatomical = body[std::size_t(axis)];
    plane.title = (grid.oriented ? titles : plain_titles)[std::size_t(plane.anatomical)];
    // To the right: the patient's left; on sagittal slices, the back. Down: the back; on upright
    // slices, the feet, which are against +z.
    const int to_right = plane.anatomical == 0 ? 1 : 0;
    const int to_bottom = plane.anatomical == 2 ? 1 : 2;
    const auto along = [&](int wanted, bool forwards) {
        const int a = static_cast<int>(std::ranges::find(body, wanted) - body.begin());
        return ScreenAxis{a, (direction(wanted, a) > 0) != forwards};
    };
    plane.right = along(to_right, true);
    plane.down = along(to_bottom, to_bottom == 1);
    const auto shown = [&](const ScreenAxis& s) -> Vec3 {
        return (s.flip ? -1 : 1) * direction.col(s.axis);
    };
    plane.at_right = letters_towards(grid, shown(plane.right));
    plane.at_left = letters_towards(grid, -shown(plane.right));
    plane.at_bottom = letters_towards(grid, shown(plane.down));
    plane.at_top = letters_towards(grid, -shown(plane.down));
    return plane;
}

Vec3 SlicePlane::point(const Vec3& physical) const {
    const Vec3 index = index_from_physical(grid, physical);
    const auto along = [&](const ScreenAxis& s) {
        return s.flip ? grid.size[s.axis] - 1 - index[s.axis] : index[s.axis];
    };
    return {along(right), along(down), index[axis]};
}

Vec3 SlicePlane::physical(const Vec3& point) const {
    Vec3 index;
    const auto put = [&](const ScreenAxis& s, double value) {
        index[s.axis] = s.flip ? grid.size[s.axis] - 1 - value : value;
    };
    put(right, point[0]);
    put(down, point[1]);
    index[axis] = point[2];
    return physical_from_index(grid, index);
}

SlicePlane SlicePlane::in(const Geometry& other) const {
    SlicePlane plane = *this;
    plane.grid = other;
    return plane;
}

std::string position_text(const SlicePlane& plane, const Vec3& physical) {
    const Vec3 axis = plane.grid.direction.col(plane.axis);
    double at = (axis[plane.anatomical] > 0 ? 1 : -1) * axis.dot(physical);
    const Ruler ruler = ruler_of(plane.grid);
    const std::string number = ruler.number(std::abs(at), 2);
    if (number.find_first_not_of("0.") == std::string::npos) at = 0;  // as it is shown
    return std::string(end_of(plane.grid, plane.anatomical, at >= 0)) + " " + number + " " +
           QCoreApplication::translate("Units", ruler.unit).toStdString();
}

SliceMap slice_map(const SlicePlane& plane, const SliceView& view, const QSizeF& size,
                   double margin) {
    const auto fit = [&](double pixels, double mm) {
        return std::max(pixels - 2 * margin, 8.0) / mm;
    };
    SliceMap map;
    map.per_mm = view.zoom * std::min(fit(size.width(), plane.width() * plane.mm_u()),
                                      fit(size.height(), plane.height() * plane.mm_v()));
    map.per_u = map.per_mm * plane.mm_u();
    map.per_v = map.per_mm * plane.mm_v();
    map.first = QPointF(0.5 * (size.width() - (plane.width() - 1) * map.per_u),
                        0.5 * (size.height() - (plane.height() - 1) * map.per_v)) +
                map.per_mm * view.moved;
    return map;
}

SliceMap map_in(const SlicePlane& other, const SlicePlane& plane, const SliceMap& map) {
    if (other.grid == plane.grid) return map;
    const Vec3 first = plane.point(other.physical(Vec3::Zero()));
    return {map.pixel(first[0], first[1]), map.per_mm * other.mm_u(), map.per_mm * other.mm_v(),
            map.per_mm};
}

}  // namespace palpate::viewer
