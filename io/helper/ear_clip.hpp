// Divides a polygon into triangles by clipping ears (Meisters 1975, "Polygons have ears"), which
// is slow but sure. Header only. Uses Eigen alone.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

namespace palpate::io {

using Triangles = std::vector<std::array<std::size_t, 3>>;  ///< indices of corners

/// What is left of a polygon while its ears are clipped.
class EarClip {
  public:
    explicit EarClip(std::vector<Eigen::Vector2d> corners)
        : at_(std::move(corners)), before_(at_.size()), after_(at_.size()) {
        for (std::size_t i = 0; i < at_.size(); ++i) {
            after_[i] = (i + 1) % at_.size();
            before_[after_[i]] = i;
        }
    }

    Triangles clip() {
        Triangles found;
        std::size_t left = at_.size(), looked_at = 0;  // since something was clipped
        for (std::size_t i = 0; left > 2 && looked_at < left;) {
            const bool is_void = encloses_nothing(i);
            if (!is_void && !is_ear(i)) {
                i = after_[i];
                ++looked_at;
                continue;
            }
            if (!is_void) found.push_back({before_[i], i, after_[i]});
            after_[before_[i]] = after_[i];
            before_[after_[i]] = before_[i];
            i = before_[i];
            --left;
            looked_at = 0;
        }
        return found;
    }

  private:
    /// Twice the area of a triangle, positive if it turns to the left.
    double turn(std::size_t a, std::size_t b, std::size_t c) const {
        const Eigen::Vector2d u = at_[b] - at_[a], v = at_[c] - at_[a];
        return u.x() * v.y() - u.y() * v.x();
    }
    bool cross(std::size_t a, std::size_t b, std::size_t c, std::size_t d) const {
        const bool share_an_end =
            at_[a] == at_[c] || at_[a] == at_[d] || at_[b] == at_[c] || at_[b] == at_[d];
        return !share_an_end && turn(a, b, c) * turn(a, b, d) < 0 &&
               turn(c, d, a) * turn(c, d, b) < 0;
    }
    bool encloses_nothing(std::size_t i) const {
        return at_[i] == at_[after_[i]] || at_[before_[i]] == at_[after_[i]];
    }
    bool is_ear(std::size_t b) const {
        const std::size_t a = before_[b], c = after_[b];
        if (!(turn(a, b, c) > 0)) return false;
        for (std::size_t p = c; p != a; p = after_[p]) {
            const std::size_t q = after_[p];
            if (cross(a, b, p, q) || cross(b, c, p, q) || cross(c, a, p, q)) return false;
            const bool is_corner = at_[p] == at_[a] || at_[p] == at_[b] || at_[p] == at_[c];
            if (!is_corner && turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) {
                return false;
            }
        }
        return true;
    }

    std::vector<Eigen::Vector2d> at_;
    std::vector<std::size_t> before_, after_;
};

/// Of corners in a plane, counterclockwise. Corners may lie on edges and at one place, as where an
/// outline leads to a hole and back. Of a polygon that crosses itself, a part may be missing.
inline Triangles clipped_ears(std::vector<Eigen::Vector2d> corners) {
    return EarClip(std::move(corners)).clip();
}

}  // namespace palpate::io
