// Finds contacts with the surface along straight lines. Internal to scenes/.
#pragma once

#include "palpate/field.hpp"
#include "scenes/random.hpp"

namespace palpate::scenes {

/// Where a straight line from outside the grid first goes from free into solid.
struct Contact {
    Vec3 point = Vec3::Zero();   ///< [mm, physical]; the target if there is none
    Vec3 inward = Vec3::Zero();  ///< unit vector along which the hand came
    double clearance = 0;        ///< [mm] free in front of the point, inside the padded grid
    bool found = false;
    bool at_border = false;  ///< met where the body is cut off by the border of the data
};

/// Follows the line through `target` along `inward`, in steps of a quarter of a voxel.
Contact reach(const Field& field, double isovalue, const Vec3& target, const Vec3& inward);

/// A contact from a random side: towards the centre if that meets data, else towards random points,
/// finally towards a solid sample. Not found only if no sample is solid.
Contact any_contact(const Field& field, double isovalue, Random& random);

/// Unit normal into the solid from differences over a voxel; contact.inward where they show none
/// within 60 degrees of it.
Vec3 inward_normal(const Field& field, const Contact& contact);

/// Uniform on the unit sphere.
Vec3 unit_vector(Random& random);
/// A unit vector across another one, otherwise random.
Vec3 unit_vector_across(const Vec3& axis, Random& random);

/// Length [mm] of the line through the grid's centre along a unit vector, inside the grid.
double chord(const Geometry& geometry, const Vec3& along);

}  // namespace palpate::scenes
