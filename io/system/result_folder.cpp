// Makes results in a hidden folder and renames them when complete.
#include "io/system/result_folder.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <stdexcept>
#include <utility>

#include "io/system/leftovers.hpp"
#include "io/system/removal.hpp"
#include "io/system/system.hpp"
#include "palpate/io/error.hpp"

namespace palpate::io {

namespace fs = std::filesystem;

ResultFolder::ResultFolder(const fs::path& folder, std::vector<std::string> names)
    : folder_(folder), names_(std::move(names)) {
    std::error_code error;
    is_new_ = fs::create_directories(folder_, error);
    if (folder_.empty() || error || !fs::is_directory(folder_)) {
        throw OutputError("'" + folder.string() + "': this folder could not be made" +
                          (error ? " (" + error.message() + ")" : "") +
                          ": choose another with --output");
    }
    remove_leftovers(folder_);
    part_ = make_temporary_folder(folder_, error);
    if (error) {
        if (is_new_) fs::remove(folder_, error);
        throw OutputError(folder.string() + ": nothing can be written in this folder (" +
                          error.message() + "): choose another with --output");
    }
    lock_ = lock_temporary(part_);
    std::ofstream(part_ / temporary_marker) << temporary_marker_text;
}

ResultFolder::~ResultFolder() {
    std::error_code ignored;
    remove_tree(part_);
    if (is_new_ && !complete_) fs::remove(folder_, ignored);
    if (lock_ >= 0) ::close(lock_);
}

void ResultFolder::make(const std::function<void(const fs::path& part)>& results) const {
    try {
        results(part_);
    } catch (const OutputError& e) {
        std::string text = e.what();
        const std::string hidden = part_.string(), shown = folder_.string();
        for (std::size_t at = 0; (at = text.find(hidden, at)) != text.npos; at += shown.size()) {
            text.replace(at, hidden.size(), shown);
        }
        throw OutputError(text);
    }
}

void ResultFolder::complete() {
    if (lock_ >= 0 && !synchronise_all(lock_)) {
        throw OutputError(folder_.string() + ": " + reason(errno) + ": check the disk");
    }
    for (const auto& entry : fs::directory_iterator(part_)) {
        const std::string name = entry.path().filename().string();
        if (name == temporary_marker) continue;
        if (!names_.empty() && std::ranges::find(names_, name) == names_.end()) {
            throw std::logic_error(name + " is not among the names of the results");
        }
        std::error_code error;
        const fs::path target = folder_ / name;
        fs::rename(entry.path(), target, error);
        if (error) {
            throw OutputError(target.string() + ": could not be put in place: " + error.message() +
                              ": remove it, or choose another --output");
        }
    }
    synchronise_folder(folder_);
    complete_ = true;
}

}  // namespace palpate::io
