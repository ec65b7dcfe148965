// The scene of a recording again: its volume, and its session as it was at the start.
#pragma once

#include <filesystem>
#include <string>

#include "apps/live/volume_options.hpp"
#include "palpate/io/recording.hpp"

namespace palpate::app {

/// How to load the volume of a recording: by its recorded name, looked for from here, then beside
/// the recording; or `instead`, unless that is empty. Throws io::InputError for a live source,
/// whose frames are nowhere.
VolumeOptions recorded_volume(const io::RecordingHead& head, const std::filesystem::path& recording,
                              const std::string& instead = {});

/// The session of a recording, ready for its first tick. Throws io::InputError if the volume is not
/// the one that was recorded (size, type or samples), or the head asks for what cannot be rendered.
Session recorded_session(const io::RecordingHead& head, const LoadedVolume& loaded,
                         const std::string& recording);

}  // namespace palpate::app
