// Corners and edges of meshes by where they lie, as keys of tables.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <unordered_map>
#include <utility>

namespace palpate::viewer {

using Point = std::array<float, 3>;
using Edge = std::pair<Point, Point>;

struct PlaceHash {
    std::size_t operator()(const Point& p) const {
        const std::hash<float> hash;
        return (hash(p[0]) * 31 + hash(p[1])) * 31 + hash(p[2]);
    }
    std::size_t operator()(const Edge& edge) const {
        return (*this)(edge.first) * 31 + (*this)(edge.second);
    }
};

template <class Key, class Value>
using ByPlace = std::unordered_map<Key, Value, PlaceHash>;

}  // namespace palpate::viewer
