// The field around a tool's points: certified chords on the smooth field, and how far a point may
// certainly go.
#pragma once

#include "proxy/cubic_site.hpp"
#include "tool_proxy/kept.hpp"

namespace palpate::tool {

/// The field as a tool meets it: levels, units, and the work that is left.
class Around {
  public:
    /// `work` that it may do, besides so many looks at points, whatever their samples cost.
    Around(const Field& field, double isovalue, Surroundings& surroundings, int work,
           int looks = 0);

    /// Levels of the excess in parts of the range: where supports are held, where a chord counts as
    /// blocked, what a pose is verified against, and what counts as inside.
    static constexpr double held = 1e-11, blocked = 3e-11, verified = 4e-11, inside = 6e-11;

    const Field& field() const { return field_; }
    double shortest() const { return shortest_; }  ///< spacing [mm]
    int work_left() const { return work_; }
    bool is_exhausted() const { return work_ <= 0; }
    void spend(int work) { work_ -= work; }
    Vec3 index(const Vec3& physical) const { return to_index_ * (physical - origin_); }

    /// Excess [data units], its gradient and its Hessian per mm, physical axes.
    struct Expansion {
        double excess;
        Vec3 gradient;
        Mat3 hessian;
    };
    Expansion expand(const Vec3& physical);
    /// [data units]
    double excess(const Vec3& physical);
    double range() const { return field_.range(); }
    bool is_inside(const Vec3& physical) { return excess(physical) > inside * range(); }

    /// Which part of the way from one point to another is certainly not above a level (in parts of
    /// the range; a start above it may not rise).
    double free_part(const Vec3& from, const Vec3& to, double level);
    /// The same of a way that blocks, as `part`, but for a way shorter than `clearance` [mm],
    /// within which all round the start certainly lies below what blocks.
    struct Probe {
        double part;
        double clearance;
    };
    Probe probe(const Vec3& from, const Vec3& to);

  private:
    struct Course;

    CubicSite site(const Vec3& index) const {
        return {field_, level_, field_.sign(), cubic::locate(index)};
    }
    double empty_part(const CubicSite& at, const Vec3& direction, double left);
    Surroundings::Brick& brick_at(const Index3& at);
    Surroundings::Bounds wide_bounds(const Index3& at);
    double walk(CubicSite& at, const Vec3& displacement, double level_in_ranges);
    void gather(int work);

    const Field& field_;
    double level_;  // less the field's offset
    Surroundings& known_;
    int work_;
    int looks_;  ///< whose samples are not counted
    double shortest_;
    Vec3 origin_;
    Mat3 to_index_;
    Index3 walked_;  ///< the brick that the chord is in, in which something may block
};

/// Forgets what no longer holds. True if the samples are others than at the last call.
bool renew(Surroundings& surroundings, const Field& field);

}  // namespace palpate::tool
