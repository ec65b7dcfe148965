// Resident bricks: new versions, and which boxes are in memory.
#include "palpate/resident.hpp"

namespace palpate {

ResidentBricks::ResidentBricks(const Index3& size)
    : grid_(size), bricks_((size + Index3::Constant(edge - 1)) / edge) {}

ResidentBricks ResidentBricks::with(std::span<const Change> changes) const {
    ResidentBricks after = *this;
    after.bricks_ = bricks_.with(changes);
    return after;
}

SampleBox ResidentBricks::box_of(const Index3& brick) const {
    const Index3 low = brick * edge;
    return {(low - Index3::Constant(margin)).cwiseMax(Index3::Zero()),
            (low + Index3::Constant(edge - 1 + margin)).cwiseMin(grid_ - Index3::Ones())};
}

bool ResidentBricks::has(const SampleBox& box) const {
    const Index3 low = brick_of(box.low.cwiseMax(Index3::Zero()));
    const Index3 high = brick_of(box.high.cwiseMin(grid_ - Index3::Ones()));
    for (int k = low[2]; k <= high[2]; ++k) {
        for (int j = low[1]; j <= high[1]; ++j) {
            for (int i = low[0]; i <= high[0]; ++i) {
                if (!at({i, j, k})) return false;
            }
        }
    }
    return true;
}

}  // namespace palpate
