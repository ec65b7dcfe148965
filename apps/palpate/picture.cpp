// Titles pictures, and draws them until Ctrl-C.
#include "apps/palpate/picture.hpp"

#include <filesystem>
#include <stdexcept>

#include "apps/palpate/commands.hpp"
#include "apps/palpate/outputs.hpp"
#include "palpate/io/error.hpp"
#include "pictures/picture.hpp"

namespace palpate::app {

pictures::PictureScene scene_of(const run::LoadedVolume& loaded, int width, int height) {
    const std::filesystem::path path(io::without_secrets(loaded.name));
    pictures::PictureScene scene;
    scene.oriented = loaded.volume.geometry().oriented;
    scene.width = width;
    scene.height = height;
    scene.title = (path.has_filename() ? path : path.parent_path()).filename().string();
    return scene;
}

void require_png(const std::string& option, const std::string& name) {
    if (is_stream(name) || std::filesystem::path(name).extension() == ".png") return;
    throw std::invalid_argument(option + " " + name +
                                ": pictures are PNG files: give a name that ends in .png");
}

std::string draw(const pictures::PictureScene& scene) {
    pictures::DrawOptions options;
    options.waiting = [] { stop_if_interrupted(); };
    try {
        return pictures::png_of(scene, options);
    } catch (const io::OutputError&) {
        stop_if_interrupted();  // Ctrl-C reaches the helper as well, and its end may be seen first
        throw;
    }
}

}  // namespace palpate::app
