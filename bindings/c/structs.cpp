// Values of the C interface to the core's and back.
#include "bindings/c/structs.hpp"

#include "palpate/io/layers_file.hpp"
#include "palpate/io/tool_file.hpp"

namespace palpate::c {
namespace {

bool is_zero(const double* numbers, int count) {
    return std::all_of(numbers, numbers + count, [](double n) { return n == 0; });
}

}  // namespace

Mat3 mat3(const double* rows) {
    if (is_zero(rows, 9)) return Mat3::Identity();
    return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rows);
}

void put(const Mat3& from, double* rows) {
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>{rows} = from;
}

Quaternion quaternion(const double* xyzw) {
    if (is_zero(xyzw, 4)) return Quaternion::Identity();
    return Quaternion(xyzw[3], xyzw[0], xyzw[1], xyzw[2]).normalized();
}

void put(const Quaternion& from, double* xyzw) {
    std::copy_n(from.coeffs().data(), 4, xyzw);
}

Geometry geometry_from(const palpate_geometry* geometry) {
    const palpate_geometry given = taken(geometry, "geometry");
    Geometry result;
    result.size = {given.size[0], given.size[1], given.size[2]};
    result.measured = !is_zero(given.spacing, 3);
    result.oriented = !is_zero(given.direction, 9);
    if (result.measured) result.spacing = vec3(given.spacing);
    result.origin = vec3(given.origin);
    result.direction = mat3(given.direction);
    return result;
}

palpate_geometry geometry_to(const Geometry& geometry) {
    auto result = sized<palpate_geometry>();
    std::copy_n(geometry.size.data(), 3, result.size);
    put(geometry.spacing, result.spacing);
    put(geometry.origin, result.origin);
    put(geometry.direction, result.direction);
    return result;
}

run::FieldSetup field_setup(const palpate_field_options* options) {
    const auto given = taken_or_default(options, "field");
    run::FieldSetup setup;
    setup.solid = one_of<Solid>(given.solid, "field.solid");
    // Here 0 is cubic.
    const auto other = one_of<Interpolation>(given.interpolation, "field.interpolation");
    setup.interpolation =
        other == Interpolation::linear ? Interpolation::cubic : Interpolation::linear;
    if (given.has_background) setup.background = given.background;
    return setup;
}

std::optional<double> usual_isovalue(const run::LoadedVolume& loaded) {
    if (!(loaded.volume.maximum() > loaded.volume.minimum())) return std::nullopt;
    return run::isovalue_of(loaded, run::FieldSetup{}, progress_of_thread());
}

std::vector<DensityRange> ranges_from(const double* ranges, std::size_t count) {
    given(ranges, "ranges");
    if (count > Penetrability::most_ranges) throw std::invalid_argument("ranges: at most 16");
    std::vector<DensityRange> made(count);
    for (DensityRange& range : made) {
        range.low = *ranges++;
        range.high = *ranges++;
    }
    return made;
}

run::RenderSetup render_setup(const palpate_render_options& options) {
    run::RenderSetup setup;
    if (options.stiffness != 0) setup.stiffness = options.stiffness;
    if (options.force_limit != 0) setup.limit = options.force_limit;
    if (options.scale != 0) setup.scale = options.scale;
    if (options.rate != 0) setup.rate = options.rate;
    setup.force.damping = options.damping;
    setup.force.viscosity = options.viscosity;
    if (options.static_friction != 0 || options.dynamic_friction != 0) {
        setup.friction = Friction{options.static_friction, options.dynamic_friction};
    }
    if (options.penetration != 0)
        setup.penetrability = run::ThresholdSetup{options.penetration, {}};
    if (options.ranges || options.range_count != 0) {
        run::RangesSetup ranges;
        if (options.penetration != 0) ranges.threshold = options.penetration;
        for (const auto& [low, high] : ranges_from(options.ranges, options.range_count)) {
            ranges.ranges.push_back({low, high});
        }
        setup.penetrability = ranges;
    }
    if (options.tool) setup.tool = io::tool_spec_from(options.tool, progress_of_thread());
    if (options.layers) setup.layers = io::layers_named(options.layers, progress_of_thread());
    return setup;
}

DeviceTransform transform_from(const palpate_transform* transform) {
    const auto given = taken_or_default(transform, "transform");
    DeviceTransform result;
    result.rotation = mat3(given.rotation);
    result.translation = vec3(given.translation);
    if (given.scale != 0) result.scale = given.scale;
    return result;
}

palpate_transform transform_to(const DeviceTransform& transform) {
    auto result = sized<palpate_transform>();
    put(transform.rotation, result.rotation);
    put(transform.translation, result.translation);
    result.scale = transform.scale;
    return result;
}

palpate_felt felt_from(const Tick& tick) {
    auto felt = sized<palpate_felt>();
    felt.mode = static_cast<std::int32_t>(tick.proxy.mode);
    felt.status = static_cast<std::int32_t>(tick.proxy.status);
    felt.contacts = tick.tool.contacts;
    felt.time = tick.time;
    put(tick.proxy.hip, felt.hip);
    put(tick.proxy.scp, felt.scp);
    put(tick.force, felt.force);
    put(tick.torque, felt.torque);
    put(tick.tool.hand, felt.hand);
    put(tick.tool.proxy, felt.proxy);
    felt.density = tick.proxy.density;
    felt.isovalue = tick.proxy.isovalue;
    felt.layer = tick.layers.touched;
    felt.inside = tick.layers.inside;
    return felt;
}

static_assert(static_cast<int>(Mode::constrained) == PALPATE_CONSTRAINED);
static_assert(static_cast<int>(UpdateStatus::waiting) == PALPATE_WAITING);
static_assert(static_cast<int>(DeviceStatus::finished) == PALPATE_DEVICE_FINISHED);
static_assert(static_cast<int>(SampleType::float32) == PALPATE_FLOAT32);
static_assert(static_cast<int>(Solid::below) == PALPATE_SOLID_BELOW);
static_assert(static_cast<int>(BrushKind::paint) == PALPATE_PAINT);
static_assert(static_cast<int>(Facing::inferior) == PALPATE_INFERIOR);

}  // namespace palpate::c
