// Checks the path of a hand, and the surface, method and tool that it feels with.
#include "bindings/python/hands.hpp"

#include <numeric>

#include "palpate/run/setup.hpp"

namespace palpate::python {
namespace {

std::vector<Quaternion> quaternions_from(const Doubles& xyzw) {
    if (xyzw.ndim() != 2 || xyzw.shape(1) != 4) {
        throw std::invalid_argument("orientation_xyzw: an array of shape (n, 4) is needed");
    }
    std::vector<Quaternion> turns(static_cast<std::size_t>(xyzw.shape(0)));
    const double* from = xyzw.data();
    const GilReleasedForRows unlocked(turns.size());
    for (Quaternion& turn : turns) {
        turn = Quaternion(from);  // x, y, z, w
        from += 4;
    }
    return turns;
}

/// The numbers of the rows in place of times.
io::Trajectory without_times(std::vector<Vec3> positions, std::vector<Quaternion> turns) {
    const GilReleasedForRows unlocked(positions.size());
    std::vector<double> rows(positions.size());
    std::iota(rows.begin(), rows.end(), 0);
    return io::checked_trajectory(std::move(rows), std::move(positions), std::move(turns));
}

}  // namespace

io::Trajectory trajectory_from(const Doubles& time, const Doubles& position,
                               const std::optional<Doubles>& orientation) {
    if (time.ndim() != 1) {
        throw std::invalid_argument("time: an array of shape (n,) is needed, not " +
                                    std::string(py::str(time.attr("shape"))));
    }
    std::vector<Quaternion> turns;
    if (orientation) turns = quaternions_from(*orientation);
    std::vector<Vec3> positions = points_from(position, "position");
    const GilReleasedForRows unlocked(positions.size());
    return io::checked_trajectory({time.data(), time.data() + time.size()}, std::move(positions),
                                  std::move(turns));
}

io::Trajectory poses_from(const Doubles& position, const Doubles& orientation) {
    return without_times(points_from(position, "position"), quaternions_from(orientation));
}

std::vector<Vec3> hips_from(const Doubles& hips) {
    std::vector<Vec3> points = points_from(hips, "hips");
    return points.empty() ? points : without_times(std::move(points), {}).position;
}

double felt_level(const Field& field, const io::Level& level, const std::string& method,
                  const std::shared_ptr<const Tool>& tool) {
    const double isovalue = io::level_in(field.volume(), level);
    run::RenderSetup setup;
    setup.method = run::named_method(method);
    RendererSettings settings = run::render_settings(setup, field, isovalue);
    settings.tool = tool;
    (void)make_renderer(field, isovalue, settings);  // for its checks
    return isovalue;
}

}  // namespace palpate::python
