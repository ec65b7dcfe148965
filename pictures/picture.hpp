// Pictures of surfaces, hand and proxy on a machine without a display. VTK draws them in a helper
// process (palpate-picture-helper), so that slow loading or a crash there is only an error here.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "palpate/io/error.hpp"
#include "pictures/scene.hpp"

namespace palpate::pictures {

struct DrawOptions {
    /// Called from the calling thread about ten times a second; may throw to stop.
    std::function<void()> waiting = [] {};
    /// The program palpate-picture-helper. Empty: the environment's PALPATE_PICTURE_HELPER, else
    /// beside the running program, in its build tree or in the installed libexec folder.
    std::filesystem::path helper;
    double time_limit_s = 600;
};

/// Most triangles of a picture: what a machine with 8 GB draws in minutes.
inline constexpr std::size_t most_triangles = 40'000'000;

/// The picture as a PNG file's bytes. Throws io::OutputError, one line, if it cannot be drawn, and
/// std::invalid_argument for a scene that cannot be meant: no pixels, a camera or a point that is
/// not finite, too many triangles, normals that are not one a vertex.
std::string png_of(const PictureScene& scene, const DrawOptions& options = {});

/// The same into a file, whole or not at all.
void draw_picture(const PictureScene& scene, const std::filesystem::path& png,
                  const DrawOptions& options = {});

/// OpenGL's name for who would draw: the pictures, or with `machine` the graphics card's driver,
/// which pictures do not use. Throws io::OutputError, saying what to install, if nobody can.
std::string renderer_name(bool machine, const DrawOptions& options = {});

}  // namespace palpate::pictures
