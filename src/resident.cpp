// Resident bricks: new versions, and which boxes are in memory.
#include "palpate/resident.hpp"

#include <stdexcept>
#include <unordered_map>

namespace palpate {
namespace {

Index3 divided_up(const Index3& a, int by) {
    return (a + Index3::Constant(by - 1)) / by;
}

}  // namespace

ResidentBricks::ResidentBricks(const Index3& size)
    : grid_(size),
      count_(divided_up(size, edge)),
      pages_along_(divided_up(count_, page_edge)),
      pages_(static_cast<std::size_t>(pages_along_.cast<std::int64_t>().prod())) {}

ResidentBricks ResidentBricks::with(std::span<const Change> changes) const {
    ResidentBricks after = *this;
    std::unordered_map<std::size_t, std::shared_ptr<Page>> changed;
    for (const Change& change : changes) {
        if ((change.brick.array() < 0).any() || (change.brick.array() >= count_.array()).any()) {
            throw std::out_of_range("a brick outside the grid");
        }
        const std::size_t at = page_of(change.brick);
        std::shared_ptr<Page>& page = changed[at];
        if (!page) {
            page = pages_[at] ? std::make_shared<Page>(*pages_[at]) : std::make_shared<Page>();
            after.pages_[at] = page;
        }
        ResidentBrick& brick = (*page)[place_in_page(change.brick)];
        after.size_ += (change.to.samples ? 1 : 0);
        after.size_ -= (brick.samples ? 1 : 0);
        brick = change.to;
    }
    for (const auto& [at, page] : changed) {
        bool empty = true;
        for (const ResidentBrick& brick : *page) empty &= !brick.samples;
        if (empty) after.pages_[at].reset();
    }
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
