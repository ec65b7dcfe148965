// The contents of a picture: plain values in physical space (LPS, mm) with colours. picture.hpp
// draws it. Header only, since the helper program uses the same values.
#pragma once

#include <string>
#include <vector>

#include "palpate/surface.hpp"

namespace palpate::pictures {

/// sRGB, each 0 to 1.
struct Colour {
    double red = 0, green = 0, blue = 0;

    bool operator==(const Colour&) const = default;
};

// Told apart by everybody: the hand and the proxy as in all figures (Okabe and Ito).
inline constexpr Colour bone{0.93, 0.86, 0.74};
inline constexpr Colour hip_colour{0, 0.447, 0.698};
inline constexpr Colour scp_colour{0.835, 0.369, 0};
inline constexpr Colour force_colour{0, 0.52, 0.38};
inline constexpr Colour spring_colour{0.25, 0.25, 0.25};

struct Surface {
    SurfaceMesh mesh;
    /// A unit vector a vertex, out of the solid, to shade with. Empty: those of the triangles round
    /// it.
    std::vector<Eigen::Vector3f> normals;
    Colour colour = bone;
    double opacity = 1;  ///< of a part that faces the viewer; seen aslant it is more
    std::string label;   ///< for the legend; empty: not in it
};

struct Ball {
    Vec3 centre = Vec3::Zero();
    double radius = 1;  ///< [mm]
    Colour colour;
    std::string label;
};

struct Line {
    std::vector<Vec3> points;
    double radius = 0.5;  ///< [mm]
    Colour colour;
    std::string label;
};

/// A coil from one point to another.
struct Spring {
    Vec3 from = Vec3::Zero(), to = Vec3::Zero();
    double radius = 1;  ///< [mm] of the coil
    Colour colour = spring_colour;
    std::string label;
};

struct Arrow {
    Vec3 from = Vec3::Zero(), to = Vec3::Zero();
    double radius = 0.5;  ///< [mm] of the shaft
    Colour colour = force_colour;
    std::string label;
};

/// Parallel projection: a millimetre is as many pixels everywhere.
struct Camera {
    Vec3 focus = Vec3::Zero();             ///< [mm, physical] the middle of the picture
    Vec3 towards_viewer = Vec3(0, -1, 0);  ///< need not be unit
    Vec3 up = Vec3(0, 0, 1);               ///< not along `towards_viewer`
    double half_height = 1;                ///< [mm] from the middle to the upper edge

    bool operator==(const Camera&) const = default;
};

struct PictureScene {
    std::vector<Surface> surfaces;
    // Where they lie behind a surface they shine through it, faintly.
    std::vector<Ball> balls;
    std::vector<Line> lines;
    std::vector<Spring> springs;
    std::vector<Arrow> arrows;
    Camera camera;
    int width = 1000, height = 800;  ///< [pixels]
    std::string title;               ///< above the legend; may be empty
    bool legend = true;              ///< what the colours are, in the upper left corner
    bool orientation = true;         ///< a cube with L, R, A, P, S, I in the lower left corner
    bool oriented = true;            ///< as in Geometry; false: +X, -X, ... on the cube
    bool scale_bar = true;           ///< in the lower right corner
};

}  // namespace palpate::pictures
