// Tells of edits that were not saved, and keeps those that an error may have kept from being saved.
#include "bindings/python/edited_data.hpp"

#include <optional>
#include <vector>

#include "bindings/python/progress.hpp"
#include "bindings/python/without_gil.hpp"

namespace palpate::python {
namespace {

/// Needs the GIL.
std::vector<std::weak_ptr<EditedData>>& all_data() {
    static std::vector<std::weak_ptr<EditedData>> all;
    return all;
}

struct Interrupted {};  // no std::exception, after which rescue() would go on elsewhere

void until_interrupted(double) {
    const GilTaken gil;
    if (PyErr_CheckSignals() == 0) return;
    PyErr_Clear();
    throw Interrupted{};
}

/// What became of the edits, as the end of a sentence.
std::string rescued(run::Data& data) {
    try {
        return "they are kept in " + data.rescue(&until_interrupted).string();
    } catch (const Interrupted&) {
        return "keeping them elsewhere was interrupted";
    } catch (const std::exception& error) {
        return "they could not be kept elsewhere: " + std::string(error.what());
    }
}

}  // namespace

std::string EditedData::save(const std::filesystem::path& path) {
    failed = true;
    std::string said = data.save(path, ctrl_c());
    failed = false;
    return said;
}

void EditedData::tell_of_unsaved() noexcept {
    const bool is_lost = !data.is_sequence() && data.editor().state().changed;
    if (!is_lost || !process_.is_here() || std::exchange(told_, true)) return;
    std::optional<GilReleased> unlocked;
    if (PyGILState_Check()) unlocked.emplace();
    std::string text = "the edits of " + data.loaded().name + " were not saved";
    text += failed ? "; " + rescued(data) : ": Run.save() keeps them";
    const GilTaken gil;
    const py::error_scope before;  // the Run may go while an exception is on its way
    PyObject* const category = failed ? PyExc_UserWarning : PyExc_ResourceWarning;
    if (PyErr_WarnEx(category, text.c_str(), 1) != 0) PyErr_WriteUnraisable(Py_None);
}

std::shared_ptr<EditedData> made_edited_data(const run::LoadedVolume& loaded,
                                             const run::PlaybackSetup& playback) {
    auto made = made_without_gil<EditedData>(loaded, playback);
    std::erase_if(all_data(), [](const auto& one) { return one.expired(); });
    all_data().push_back(made);
    return made;
}

void tell_at_exit(const py::module_& module) {
    const py::cpp_function at_exit([] {
        const bool failed = py::hasattr(py::module_::import("sys"), "last_type");
        const auto all = all_data();  // others may be made meanwhile
        for (const auto& one : all) {
            const std::shared_ptr<EditedData> edited = one.lock();
            if (!edited) continue;
            if (failed) edited->failed = true;
            edited->tell_of_unsaved();
        }
    });
    py::module_::import("weakref").attr("finalize")(module, at_exit);
}

}  // namespace palpate::python
