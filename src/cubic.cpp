// Cubic: points of the smooth field's lattice.
#include "palpate/cubic.hpp"

namespace palpate::cubic {

Piece piece_of(const Tetrahedron& t, const Neighbours& samples) {
    Piece piece;
    make_piece(piece, t, samples.data() + 13, 3, 9, 0);
    return piece;
}

LatticePoint locate(const Vec3& index) {
    return palpate::locate(index + Vec3::Constant(0.5));
}

Vec3 index_of(const LatticePoint& point) {
    return point.tetrahedron.cell.cast<double>() + unfold(point.tetrahedron, point.folded);
}

}  // namespace palpate::cubic
