// Density: dispatches on the field's interpolation.
#include "palpate/cubic.hpp"

namespace palpate {
namespace {

bool is_far(const Vec3& index) {
    return !(index.cwiseAbs().maxCoeff() <= farthest_index);
}

}  // namespace

LatticePoint locate(Interpolation interpolation, const Vec3& index) {
    return interpolation == Interpolation::cubic ? cubic::locate(index) : locate(index);
}

Vec3 index_of(Interpolation interpolation, const LatticePoint& point) {
    return interpolation == Interpolation::cubic ? cubic::index_of(point) : index_of(point);
}

double value_at(const Field& field, const LatticePoint& point) {
    const auto& [t, folded] = point;
    const double value = field.interpolation() == Interpolation::cubic
                             ? cubic::piece_of(t, field.around(t.cell))(folded) / cubic::scale
                             : piece_of(t, field.cell(t.cell))(folded);
    return field.with_offset(value);
}

double value_at(const Field& field, const Vec3& physical) {
    const Vec3 index = index_from_physical(field.geometry(), physical);
    if (is_far(index)) return field.background();
    return value_at(field, locate(field.interpolation(), index));
}

Vec3 gradient_at(const Field& field, const LatticePoint& point) {
    const auto& [t, folded] = point;
    if (field.interpolation() == Interpolation::linear) {
        return unfold(t, piece_of(t, field.cell(t.cell)).gradient);
    }
    const cubic::Piece piece = cubic::piece_of(t, field.around(t.cell));
    return unfold(t, piece.at(folded).gradient) / cubic::scale;
}

Vec3 gradient_at(const Field& field, const Vec3& physical) {
    const Vec3 index = index_from_physical(field.geometry(), physical);
    if (is_far(index)) return Vec3::Zero();
    const Vec3 gradient = gradient_at(field, locate(field.interpolation(), index));
    return physical_from_grid_axes(field.geometry(),
                                   gradient.cwiseQuotient(field.geometry().spacing));
}

}  // namespace palpate
