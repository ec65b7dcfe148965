// The sparse table of bricks: a tree of which versions share the nodes that did not change.
#include <algorithm>
#include <map>
#include <stdexcept>

#include "palpate/samples.hpp"

namespace palpate {
namespace {

constexpr int places = 512;

/// The first brick below a place of a node.
Index3 first_below(const Index3& first, int place, int level) {
    return first + Index3(place & 7, place >> 3 & 7, place >> 6) * (1 << 3 * level);
}

}  // namespace

SparseBricks::SparseBricks(const Index3& count) : count_(count) {
    while ((count.array() > 8 << 3 * depth_).any()) ++depth_;
}

void SparseBricks::change(std::span<const Change> changes) {
    for (const Change& change : changes) {
        if ((change.at.array() < 0).any() || (change.at.array() >= count_.array()).any()) {
            throw std::out_of_range("a brick outside the grid");
        }
    }
    if (!changes.empty()) root_ = changed(root_, depth_, changes);
}

SparseBricks::Node SparseBricks::changed(const Node& node, int level,
                                         std::span<const Change> changes) {
    const auto is_empty = [](const auto& of) {
        return std::ranges::none_of(of.at, [](const auto& entry) { return bool(entry); });
    };
    if (level == 0) {
        const auto* before = static_cast<const Leaf*>(node.get());
        const auto leaf = before ? std::make_shared<Leaf>(*before) : std::make_shared<Leaf>();
        for (const Change& change : changes) {
            Brick& brick = leaf->at[place_in(change.at, 0)];
            size_ += change.to ? 1 : 0;
            size_ -= brick ? 1 : 0;
            brick = change.to;
        }
        return is_empty(*leaf) ? nullptr : leaf;
    }
    const auto* before = static_cast<const Fork*>(node.get());
    const auto fork = before ? std::make_shared<Fork>(*before) : std::make_shared<Fork>();
    std::map<std::size_t, std::vector<Change>> below;
    for (const Change& change : changes) below[place_in(change.at, level)].push_back(change);
    for (const auto& [place, part] : below) {
        fork->at[place] = changed(fork->at[place], level - 1, part);
    }
    return is_empty(*fork) ? nullptr : fork;
}

/// Calls visit(mine, theirs, level, first brick) for each pair of nodes that are not the same.
template <class Visit>
void SparseBricks::for_each_node_apart(const void* mine, const void* theirs, int level,
                                       const Index3& first, Visit&& visit) {
    if (mine == theirs) return;
    visit(mine, theirs, level, first);
    if (level == 0) return;
    const auto below = [](const void* node, int place) {
        return node ? static_cast<const Fork*>(node)->at[std::size_t(place)].get() : nullptr;
    };
    for (int place = 0; place < places; ++place) {
        for_each_node_apart(below(mine, place), below(theirs, place), level - 1,
                            first_below(first, place, level), visit);
    }
}

void SparseBricks::for_each_apart(
    const SparseBricks& other,
    const std::function<void(const Index3&, const Brick&, const Brick&)>& visit) const {
    const Brick none;
    const auto brick_in = [&](const void* leaf, int place) -> const Brick& {
        return leaf ? static_cast<const Leaf*>(leaf)->at[std::size_t(place)] : none;
    };
    for_each_node_apart(root_.get(), other.root_.get(), depth_, Index3::Zero(),
                        [&](const void* mine, const void* theirs, int level, const Index3& first) {
                            for (int place = 0; level == 0 && place < places; ++place) {
                                const Brick& here = brick_in(mine, place);
                                const Brick& there = brick_in(theirs, place);
                                if (here == there) continue;
                                visit(first_below(first, place, 0), here, there);
                            }
                        });
}

void SparseBricks::for_each(const std::function<void(const Index3&, const Brick&)>& visit) const {
    for_each_apart(SparseBricks(count_),
                   [&](const Index3& at, const Brick& brick, const Brick&) { visit(at, brick); });
}

std::size_t SparseBricks::table_bytes_apart(const SparseBricks& other) const {
    std::size_t bytes = 0;
    for_each_node_apart(root_.get(), other.root_.get(), depth_, Index3::Zero(),
                        [&](const void* mine, const void*, int level, const Index3&) {
                            if (mine) bytes += level == 0 ? sizeof(Leaf) : sizeof(Fork);
                        });
    return bytes;
}

}  // namespace palpate
