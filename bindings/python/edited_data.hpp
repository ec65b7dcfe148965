// The data of Runs in Python, whose edits an error does not lose.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include "bindings/python/casters.hpp"
#include "bindings/python/own_process.hpp"
#include "palpate/run/data.hpp"

namespace palpate::python {

class EditedData {
  public:
    EditedData(run::LoadedVolume loaded, const run::PlaybackSetup& playback)
        : data(std::move(loaded), playback) {}
    /// The last Run is gone. As tell_of_unsaved().
    ~EditedData() { tell_of_unsaved(); }

    /// As Data::save(). Without the GIL.
    std::string save(const std::filesystem::path& path);
    /// Warns of edits that were not saved, and keeps them if there was an error. Once. With or
    /// without the GIL.
    void tell_of_unsaved() noexcept;

    run::Data data;
    std::atomic<bool> failed{false};  ///< there was an error since the edits were saved last

  private:
    OwnProcess process_;
    bool told_ = false;
};

/// With the GIL.
std::shared_ptr<EditedData> made_edited_data(const run::LoadedVolume& loaded,
                                             const run::PlaybackSetup& playback);

/// Has all of them tell when the program ends, after its sessions. An exception that ends it counts
/// as an error.
void tell_at_exit(const py::module_& module);

}  // namespace palpate::python
