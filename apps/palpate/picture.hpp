// Pictures of a volume, for several commands.
#pragma once

#include <string>

#include "palpate/run/source.hpp"
#include "pictures/scene.hpp"

namespace palpate::app {

/// An empty scene of so many pixels, titled with the name of the volume: that of a file without its
/// folders.
pictures::PictureScene scene_of(const run::LoadedVolume& loaded, int width, int height);

/// Throws std::invalid_argument for a name that is not a PNG file's; of a stream, any.
void require_png(const std::string& option, const std::string& name);

/// The picture as a PNG file's bytes. Throws io::OutputError if it cannot be drawn, and
/// Interrupted.
std::string draw(const pictures::PictureScene& scene);

}  // namespace palpate::app
