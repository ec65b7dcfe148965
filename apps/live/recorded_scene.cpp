// Volume and session from a recording's head.
#include "apps/live/recorded_scene.hpp"

#include <stdexcept>

#include "palpate/baselines/methods.hpp"

namespace palpate::app {
namespace {

std::string volume_name(const std::string& recorded, const std::filesystem::path& recording) {
    if (recorded.starts_with("synthetic:") || std::filesystem::exists(recorded)) return recorded;
    std::string name = recorded;
    while (name.size() > 1 && name.back() == '/') name.pop_back();  // a folder
    const auto beside = recording.parent_path() / std::filesystem::path(name).filename();
    return std::filesystem::exists(beside) ? beside.string() : recorded;
}

}  // namespace

VolumeOptions recorded_volume(const io::RecordingHead& head, const std::filesystem::path& recording,
                              const std::string& instead) {
    VolumeOptions options = options_from(head.volume.options);
    if (options.volume.starts_with("live:") && instead.empty()) {
        throw io::InputError(recording.string() +
                             ": is of a live source: its frames came from outside and are not in "
                             "the recording, so it can be plotted but not rendered again");
    }
    options.volume = instead.empty() ? volume_name(options.volume, recording) : instead;
    return options;
}

Session recorded_session(const io::RecordingHead& head, const LoadedVolume& loaded,
                         const std::string& recording) {
    const io::VolumeIdentity now = io::identify(loaded.volume, {});
    if (now.size != head.volume.size || now.type != head.volume.type ||
        now.crc32 != head.volume.crc32) {
        throw io::InputError(loaded.name +
                             ": is not the volume of the recording (its size, type "
                             "or samples differ): name the right one with --volume");
    }
    try {
        RendererSettings settings = head.settings;
        settings.method = baselines::method_named(head.method);
        check(head.session);
        return {make_renderer(Field(loaded.volume, head.solid, head.background), head.isovalue,
                              settings),
                head.session};
    } catch (const std::invalid_argument& e) {
        throw io::InputError(recording +
                             ": the head asks for what cannot be rendered: " + e.what());
    }
}

}  // namespace palpate::app
