// Removes temporary files and folders whose process is dead. See leftovers.hpp. Windows.
#include <windows.h>

#include <atomic>
#include <fstream>
#include <string>
#include <system_error>

#include "io/system/leftovers.hpp"
#include "io/system/number.hpp"
#include "io/system/removal.hpp"
#include "io/system/system.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view name_begin = ".palpate-", name_end = ".part";

/// The process in ".palpate-PID-N.part"; 0 for any other name.
DWORD process_of(std::string_view name) {
    if (!name.starts_with(name_begin) || !name.ends_with(name_end)) return 0;
    name.remove_prefix(name_begin.size());
    name.remove_suffix(name_end.size());
    const auto dash = name.find('-');
    if (dash == std::string_view::npos || !number_from<unsigned>(name.substr(dash + 1))) return 0;
    return number_from<DWORD>(name.substr(0, dash)).value_or(0);
}

bool is_dead(DWORD process) {
    const HANDLE handle = ::OpenProcess(SYNCHRONIZE, FALSE, process);
    if (!handle) return ::GetLastError() == ERROR_INVALID_PARAMETER;  // there is none
    const bool ended = ::WaitForSingleObject(handle, 0) == WAIT_OBJECT_0;
    ::CloseHandle(handle);
    return ended;
}

}  // namespace

bool is_temporary(std::string_view name) {
    return process_of(name) > 0;
}

fs::path temporary_in(const fs::path& folder) {
    static std::atomic<unsigned> count = 0;
    const std::string begin =
        std::string(name_begin) + std::to_string(::GetCurrentProcessId()) + "-";
    while (true) {
        const fs::path path = folder / (begin + std::to_string(count++) + std::string(name_end));
        std::error_code error;
        if (!fs::exists(fs::symlink_status(path, error))) return path;
    }
}

fs::path signed_temporary(const fs::path& path) {
    return path;
}

fs::path make_temporary_folder(const fs::path& folder, std::error_code& error) {
    while (true) {
        fs::path path = temporary_in(folder);
        // If the folder exists, another process has just made it, and it is not ours.
        if (fs::create_directory(path, error) || error) return path;
    }
}

/// Not needed, because an open file cannot be removed.
int why_no_file_in(const fs::path& folder) {
    return why_unwritable(folder);
}

int lock_temporary(const std::filesystem::path&) {
    return -1;
}

void remove_leftovers(const fs::path& folder) {
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; entry != end && !error;
         entry.increment(error)) {
        const DWORD process = process_of(entry->path().filename().string());
        if (process == 0 || !is_dead(process)) continue;
        std::error_code ignored;
        if (!fs::is_directory(entry->symlink_status(ignored))) continue;
        std::ifstream marker(entry->path() / temporary_marker, std::ios::binary);
        std::string text(temporary_marker_text.size() + 1, '\0');
        marker.read(text.data(), static_cast<std::streamsize>(text.size()));
        text.resize(static_cast<std::size_t>(marker.gcount()));
        marker.close();
        if (text == temporary_marker_text) remove_tree(entry->path());
    }
}

}  // namespace palpate::io
