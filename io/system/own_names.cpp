// Recognises and removes the files that Palpate writes into folders of results. See the header.
#include "io/system/own_names.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <optional>

#include "io/process/helper_process.hpp"
#include "io/system/leftovers.hpp"
#include "io/system/number.hpp"
#include "io/system/removal.hpp"
#include "io/system/system.hpp"
#include "palpate/io/error.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;

constexpr int own_folder_mode = O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC;
constexpr int most_levels = 64;

/// Folders by what they hold. Chunks lie in LEVEL/c/Z/Y/X, in Zarr 2 in LEVEL/Z/Y/X. Work is that
/// of palpate.distributed.
enum class Place { growing, image, level, zs, ys, xs, work, stages, records };

/// A number as we write it: without zeros before it.
bool is_number(const std::string& name, int below = 1 << 30) {
    const auto number = number_from<int>(name);
    return number && *number >= 0 && *number < below && std::to_string(*number) == name;
}

bool has_only(const std::string& name, const char* allowed) {
    return !name.empty() && name.find_first_not_of(allowed) == std::string::npos;
}

/// Without the end that a name has while the file is written: ".part" or ".part-WRITER".
std::string finished(const std::string& name) {
    const auto end = name.rfind(".part");
    if (end == std::string::npos || end == 0) return name;
    const auto after = end + std::string(".part").size();
    return after == name.size() || name[after] == '-' ? name.substr(0, end) : name;
}

std::optional<Place> folder_in(Place place, const std::string& name) {
    switch (place) {
        case Place::growing:
            if (name == "result") return Place::image;
            if (name == "work") return Place::work;
            if (name == "previous") return Place::image;
            if (name.starts_with("previous-") && is_number(name.substr(9))) return Place::image;
            break;
        case Place::image:
            if (is_number(name, most_levels)) return Place::level;
            break;
        case Place::level:
            if (name == "c") return Place::zs;
            if (is_number(name)) return Place::ys;
            break;
        case Place::zs:
            if (is_number(name)) return Place::ys;
            break;
        case Place::ys:
            if (is_number(name)) return Place::xs;
            break;
        case Place::work:
            if (name == "records") return Place::stages;
            if (name.starts_with("state-") && name.ends_with(".zarr")) return Place::image;
            break;
        case Place::stages:
            if (has_only(name, "abcdefghijklmnopqrstuvwxyz-0123456789")) return Place::records;
            break;
        case Place::xs:
        case Place::records:
            break;
    }
    return std::nullopt;
}

bool is_file_in(Place place, const std::string& whole, const struct stat& about) {
    const std::string name = finished(whole);
    const auto is_temporary = [&] {
        return is_own_temporary(whole, about.st_ino, about.st_size == 0);
    };
    switch (place) {
        case Place::growing:
            return name == growing_marker || is_temporary();
        case Place::image:
            return name == "zarr.json" || name == ".zgroup" || name == ".zattrs" ||
                   name == edits_note || is_temporary();
        case Place::level:
            return name == "zarr.json" || name == ".zarray";
        case Place::xs:
            return is_number(name);
        case Place::records:  // X-Y-Z, and X-Y-Z.WRITER while it is written
            return has_only(whole.substr(0, whole.find('.')), "0123456789-");
        default:
            return false;
    }
}

std::string walk(int folder, Place place, bool removes);

/// The same for one name in an open folder. True if it is ours and, if `removes`, is removed.
bool is_ours(int folder, const std::string& name, Place place, bool removes, std::string& below) {
    struct stat about {};
    if (::fstatat(folder, name.c_str(), &about, AT_SYMLINK_NOFOLLOW) != 0) return errno == ENOENT;
    if (!S_ISDIR(about.st_mode)) {
        if (!S_ISREG(about.st_mode) || !is_file_in(place, name, about)) return false;
        return !removes || ::unlinkat(folder, name.c_str(), 0) == 0 || errno == ENOENT;
    }
    const auto inside = folder_in(place, name);
    if (!inside) return false;
    {
        const Descriptor inner(open_inner(folder, name));
        if (inner.number() < 0) return errno == ENOENT;
        below = walk(inner.number(), *inside, removes);
    }
    if (!below.empty()) return false;
    return !removes || ::unlinkat(folder, name.c_str(), AT_REMOVEDIR) == 0 || errno == ENOENT;
}

/// The first path that is not ours; removes what is ours if asked for.
std::string walk(int folder, Place place, bool removes) {
    std::string first;
    for (const std::string& name : names_in(folder)) {
        std::string below;
        if (is_ours(folder, name, place, removes, below)) continue;
        if (first.empty()) first = below.empty() ? name : name + "/" + below;
        if (!removes) break;
    }
    return first;
}

Place place_of(OwnFolder kind) {
    return kind == OwnFolder::growing ? Place::growing : Place::image;
}

}  // namespace

std::string unknown_below(const fs::path& folder, OwnFolder kind) {
    const Descriptor open(::open(folder.c_str(), own_folder_mode));
    if (open.number() < 0 && errno == ENOENT) return "";
    if (open.number() < 0) {
        throw OutputError(folder.string() + ": cannot be read (" + reason(errno) +
                          "), so that it stays; give another name");
    }
    return walk(open.number(), place_of(kind), false);
}

std::string remove_known(const fs::path& folder, OwnFolder kind) noexcept {
    try {
        std::string left;
        {
            const Descriptor open(::open(folder.c_str(), own_folder_mode));
            if (open.number() < 0) {
                return errno == ENOENT ? "" : ".";
            }
            left = walk(open.number(), place_of(kind), true);
        }
        if (left.empty() && ::rmdir(folder.c_str()) != 0 && errno != ENOENT) left = ".";
        return left;
    } catch (const std::exception&) {
        return ".";
    }
}

}  // namespace palpate::io
