// A folder of a result that grows and takes its place at once. See the header.
#include "io/system/growing_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>

#include "io/json_text.hpp"
#include "io/process/helper_process.hpp"
#include "io/system/leftovers.hpp"
#include "io/system/open_file.hpp"
#include "io/system/own_names.hpp"
#include "io/system/removal.hpp"
#include "io/system/system.hpp"
#include "palpate/io/error.hpp"
#include "palpate/io/output.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;

constexpr int as_folder = O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC;
constexpr const char* maker = "Palpate made this folder; a result grows in it";
constexpr std::size_t longest_marker = std::size_t{1} << 20;
constexpr std::size_t nonce_digits = 32;

const char* const what_to_do = "; rename it or remove it, or give another name";

fs::path parent_of(const fs::path& path) {
    return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

fs::path with_end(const fs::path& path, const std::string& end) {
    return path.native() + end;
}

[[noreturn]] void refuse(const fs::path& path, const std::string& why) {
    throw OutputError(path.string() + ": " + why);
}

bool is_there(const fs::path& path) {
    struct stat about {};
    return ::lstat(path.c_str(), &about) == 0;
}

bool is_same(const struct stat& one, const struct stat& other) {
    return one.st_dev == other.st_dev && one.st_ino == other.st_ino;
}

bool is_there_as(const fs::path& path, const struct stat& before) {
    struct stat now {};
    return ::lstat(path.c_str(), &now) == 0 && is_same(now, before);
}

/// Whether a name in an open folder is still that of what is open as `held`.
bool is_still(int folder, const char* name, int held) {
    struct stat now {
    }, then{};
    return ::fstatat(folder, name, &now, AT_SYMLINK_NOFOLLOW) == 0 && ::fstat(held, &then) == 0 &&
           is_same(now, then);
}

/// Nobody else writes one by chance.
std::string new_nonce() {
    std::random_device random;
    std::string digits;
    while (digits.size() < nonce_digits) digits += "0123456789abcdef"[random() % 16];
    return digits;
}

std::string text_of_marker(int folder) {
    const Descriptor file(open_file_in(folder, growing_marker));
    struct stat about {};
    if (file.number() < 0 || ::fstat(file.number(), &about) != 0 || about.st_uid != ::geteuid() ||
        about.st_size > static_cast<off_t>(longest_marker)) {
        return "";
    }
    std::string text(static_cast<std::size_t>(about.st_size), '\0');
    const auto got = read_at(file.number(), text.data(), text.size(), 0);
    return got == about.st_size ? text : "";
}

/// The job in the marker of an open folder; nothing if there is no marker of ours.
std::optional<std::string> job_in(int folder) {
    const nlohmann::json marker = parsed_or_discarded(text_of_marker(folder));
    if (!marker.is_object() || marker.value("palpate", nlohmann::json()) != maker)
        return std::nullopt;
    const nlohmann::json nonce = marker.value("nonce", nlohmann::json()),
                         job = marker.value("job", nlohmann::json());
    if (!nonce.is_string() || nonce.get<std::string>().size() != nonce_digits || !job.is_string()) {
        return std::nullopt;
    }
    return job.get<std::string>();
}

/// A name that is free now, OUT.END or OUT.END-N.
fs::path free_name(const fs::path& out, const std::string& end) {
    fs::path path = with_end(out, end);
    for (int i = 2; is_there(path); ++i) path = with_end(out, end + "-" + std::to_string(i));
    return path;
}

/// Removes a folder that is open as `held`, under a temporary name: a kill meanwhile leaves nothing
/// that could be taken for another thing. Returns what stays because Palpate did not write it or
/// because it cannot be removed, as a path from the folder.
std::string remove_held(const fs::path& folder, int held) {
    fs::path away = temporary_in(parent_of(folder));
    if (!rename_new(folder, away)) return errno == ENOENT ? "" : ".";
    away = signed_temporary(away);
    std::string left = ".";  // another one, put there in this moment
    if (is_still(AT_FDCWD, away.c_str(), held)) left = remove_known(away, OwnFolder::growing);
    if (!left.empty()) rename_new(away, folder);
    return left;
}

/// Throws for what is in a folder that would be removed.
void refuse_unknown(const fs::path& folder, const std::string& unknown) {
    if (unknown.empty()) return;
    refuse(folder / unknown,
           "was not written by Palpate or cannot be removed, so that this folder of an "
           "interrupted run stays; move it elsewhere");
}

}  // namespace

GrowingFolder::GrowingFolder(fs::path out, const std::string* job)
    : out_(without_slash(out)), stays_(job != nullptr) {
    if (job) check_new_folder(out_);
    remove_leftovers(parent_of(out_));
    if (!job) {
        make(nullptr);
        return;
    }
    constexpr int attempts = 3;  // another process may make or finish one at the same time
    for (int i = 0; i < attempts && lock_ < 0; ++i) {
        if (take(*job)) continue;
        make(job);
        folder_ = with_end(out_, ".partial");
    }
    if (lock_ < 0) refuse(folder_, "another process begins the same work; wait for that");
    if (!is_there(out_)) return;
    // Another process has finished it since it was looked for.
    if (!is_continued_) remove_held(folder_, lock_);
    close_descriptors();
    check_new_folder(out_);
}

GrowingFolder GrowingFolder::alone(const fs::path& out) {
    return {out, nullptr};
}

GrowingFolder GrowingFolder::resumable(const fs::path& out, const std::string& job) {
    return {out, &job};
}

/// A new folder, whole before it gets its name. Without a lock afterwards: another process has
/// taken the name.
void GrowingFolder::make(const std::string* job) {
    std::error_code error;
    folder_ = make_temporary_folder(parent_of(out_), error);
    if (error) refuse(out_, "cannot be written (" + error.message() + "); choose another folder");
    try {
        const nlohmann::json marker = {
            {"palpate", maker}, {"nonce", new_nonce()}, {"job", job ? *job : ""}};
        if (job) write_file(folder_ / growing_marker, marker.dump(1));
        hold(::open(folder_.c_str(), as_folder));
    } catch (...) {
        remove_tree(folder_);
        throw;
    }
    if (!job) return;
    const fs::path partial = with_end(out_, ".partial");
    if (rename_new(folder_, partial)) return;
    const int problem = errno;
    close_descriptors();
    remove_tree(folder_);
    if (problem != EEXIST) refuse(partial, reason(problem) + "; choose another folder");
}

struct GrowingFolder::Earlier {
    int folder = -1;  ///< locked; -1: there is none
    std::string job = {};
};

/// Checks the remains of an earlier run. Throws if they must not be continued or removed.
GrowingFolder::Earlier GrowingFolder::earlier_run(const fs::path& folder) {
    Earlier found{::open(folder.c_str(), as_folder)};
    if (found.folder < 0) {
        if (errno == ENOENT) return found;
        if (errno != ENOTDIR && errno != ELOOP) refuse(folder, reason(errno) + what_to_do);
        refuse(folder, std::string("is a link or a file, which Palpate did not make") + what_to_do);
    }
    const auto refused = [&](const std::string& why) {
        ::close(found.folder);
        refuse(folder, why);
    };
    struct stat about {};
    if (::fstat(found.folder, &about) != 0 || about.st_uid != ::geteuid()) {
        refused(std::string("belongs to another user") + what_to_do);
    }
    const auto job = job_in(found.folder);
    if (!job) refused(std::string("is a folder that Palpate did not make") + what_to_do);
    if (::flock(found.folder, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
        refused("another process is writing it; wait for that");
    }
    found.job = *job;
    return found;
}

void GrowingFolder::check_resumable(const fs::path& out, const std::string& job) {
    check_new_folder(out);
    const fs::path folder = with_end(without_slash(out), ".partial");
    const Earlier found = earlier_run(folder);
    if (found.folder < 0) return;
    ::close(found.folder);
    if (found.job != job) refuse_unknown(folder, unknown_below(folder, OwnFolder::growing));
}

/// Opens what an earlier run has left. False if there is none of this job (any more).
bool GrowingFolder::take(const std::string& job) {
    folder_ = with_end(out_, ".partial");
    const Earlier found = earlier_run(folder_);
    if (found.folder < 0) return false;
    lock_ = found.folder;
    if (!is_still(AT_FDCWD, folder_.c_str(), found.folder)) {
        close_descriptors();
        return false;
    }
    if (found.job != job) {
        begin_anew();
        return false;
    }
    hold(found.folder);
    is_continued_ = true;
    return true;
}

void GrowingFolder::begin_anew() {
    std::string unknown;
    try {
        unknown = unknown_below(folder_, OwnFolder::growing);
    } catch (const OutputError&) {
        close_descriptors();
        throw;
    }
    if (unknown.empty()) unknown = remove_held(folder_, lock_);
    close_descriptors();
    refuse_unknown(folder_, unknown);
    note_ = folder_.string() +
            ": was of another source, of other settings or of another version: begun anew";
}

/// Takes over a descriptor of the folder; opens its result.
void GrowingFolder::hold(int folder) {
    lock_ = folder;
    if (folder >= 0) (void)::flock(folder, LOCK_EX | LOCK_NB);
    const bool made = folder >= 0 && (::mkdirat(folder, "result", 0777) == 0 || errno == EEXIST);
    if (made) held_result_ = ::openat(folder, "result", as_folder);
    if (held_result_ >= 0) return;
    const int problem = errno;
    close_descriptors();
    refuse(result(), "cannot be written (" + reason(problem) + ")" + what_to_do);
}

void GrowingFolder::close_descriptors() noexcept {
    for (int* descriptor : {&lock_, &held_result_}) {
        if (*descriptor >= 0) ::close(*descriptor);
        *descriptor = -1;
    }
}

GrowingFolder::~GrowingFolder() {
    remove_own();
    close_descriptors();
}

/// If files of others remain, the folder gets a name that people see.
void GrowingFolder::remove_own() noexcept {
    if (stays_ || lock_ < 0) return;
    try {
        const std::string left = remove_held(folder_, lock_);
        stays_ = true;
        if (left.empty() || !is_there(folder_)) return;
        const fs::path kept = free_name(out_, ".kept");
        const bool is_hidden = is_temporary(folder_.filename().string());
        const fs::path place = is_hidden && rename_new(folder_, kept) ? kept : folder_;
        note_ = (place / left).string() + ": stays, because Palpate did not write it";
    } catch (const std::exception&) {  // no memory for names: all stays
    }
}

void GrowingFolder::check() const {
    if (is_still(AT_FDCWD, folder_.c_str(), lock_) && is_still(lock_, "result", held_result_)) {
        return;
    }
    refuse(folder_, "was removed or renamed while it was written; run it again");
}

void check_in_place(const fs::path& path, const GrowingFolder::MayReplace& may_replace) {
    for (;;) {
        struct stat before {};
        if (::lstat(path.c_str(), &before) != 0) return;
        try {
            return may_replace(path);
        } catch (const OutputError&) {
            if (is_there_as(path, before)) throw;
        }
    }
}

void GrowingFolder::put_in_place(const MayReplace& may_replace) {
    try {
        check();
        if (!synchronise_all(held_result_)) refuse(out_, reason(errno) + "; check the disk");
        move_into_place(may_replace);
    } catch (const OutputError& e) {
        if (!stays_) rescue(e.what());
        throw;
    }
    stays_ = false;
    synchronise_folder(parent_of(out_));
    remove_own();
}

void GrowingFolder::move_into_place(const MayReplace& may_replace) {
    constexpr int attempts = 1000;  // other processes may put something there at the same time
    for (int i = 0; i < attempts; ++i) {
        if (rename_new(result(), out_)) return;
        if (errno != EEXIST && errno != ENOTEMPTY) refuse(out_, reason(errno) + what_to_do);
        if (!may_replace) refuse(out_, std::string("is there already") + what_to_do);
        if (exchange_with_out(may_replace)) return;
    }
    refuse(out_, "others replace it all the time; give another name");
}

/// False if what was there has gone meanwhile.
bool GrowingFolder::exchange_with_out(const MayReplace& may_replace) {
    struct stat looked_at {};
    if (::lstat(out_.c_str(), &looked_at) != 0) return false;
    try {
        may_replace(out_);
    } catch (const OutputError&) {
        if (!is_there_as(out_, looked_at)) return false;
        throw;
    }
    if (exchange(result(), out_)) {
        try {
            may_replace(result());  // it may have been replaced since it was looked at
        } catch (const OutputError& e) {
            if (!exchange(result(), out_)) keep_replaced(result(), e.what(), true);
            throw;
        }
        return true;
    }
    if (errno == ENOENT) return false;
    const bool cannot = errno == EINVAL || errno == ENOSYS || errno == EOPNOTSUPP;
    if (!cannot) refuse(out_, reason(errno) + what_to_do);
    return replace_in_steps(may_replace, looked_at);
}

/// A folder that must not be replaced is at `at` and cannot be moved back.
void GrowingFolder::keep_replaced(const fs::path& at, const std::string& problem,
                                  bool is_replaced) {
    const fs::path aside = at == result() ? free_name(out_, ".previous") : at;
    const bool is_moved = at == aside || rename_new(at, aside);
    if (!is_moved) stays_ = true;
    throw OutputError(problem + "; it is kept as " + (is_moved ? aside : at).string() +
                      (is_replaced ? ", and the new result is in its place" : ""));
}

/// For file systems that cannot exchange names. Nothing has the name OUT between two renames, so
/// only the identity of the folder is checked in between. False if another process was quicker.
bool GrowingFolder::replace_in_steps(const MayReplace& may_replace, const struct stat& looked_at) {
    const fs::path aside = free_name(out_, ".previous");
    if (!rename_new(out_, aside)) {
        if (errno == ENOENT || errno == EEXIST) return false;
        refuse(out_, reason(errno) + what_to_do);
    }
    struct stat moved {};
    const bool is_other = ::lstat(aside.c_str(), &moved) != 0 || !is_same(moved, looked_at);
    if (is_other && rename_new(aside, out_)) return false;
    const bool done = !is_other && rename_new(result(), out_);
    const int problem = is_other ? EEXIST : errno;
    if (!done && problem != EEXIST && problem != ENOTEMPTY) {
        if (rename_new(aside, out_)) refuse(out_, reason(problem) + what_to_do);
        refuse(out_, reason(problem) + "; its previous content is in " + aside.string());
    }
    try {
        may_replace(aside);  // something may have been put into it since it was looked at
    } catch (const std::exception& e) {
        const bool is_taken_back = done && rename_new(out_, result());
        if (is_taken_back && rename_new(aside, out_)) throw;
        keep_replaced(aside, e.what(), done && !is_taken_back);
    }
    // It is replaced, by this process or another one: it goes with this folder.
    rename_new(aside, free_name(folder_ / "previous", ""));
    return done;
}

void GrowingFolder::rescue(const std::string& problem) const {
    const fs::path rescued = free_name(out_, ".rescued");
    if (!is_still(lock_, "result", held_result_) || !rename_new(result(), rescued)) return;
    throw OutputError(problem + "; the result is kept as " + rescued.string());
}

void check_new_folder(const fs::path& out) {
    const fs::path name = without_slash(out);
    if (is_there(name)) refuse(name, "is there already; remove it or give another name");
    check_parent(name);
}

void check_parent(const fs::path& name) {
    const fs::path parent = parent_of(name);
    std::error_code error;
    if (!fs::is_directory(parent, error)) {
        refuse(name, "its folder does not exist; create it first, or choose another folder");
    }
    if (const int problem = why_no_file_in(parent)) {
        refuse(name, "cannot be written (" + reason(problem) + "); choose another folder");
    }
}

}  // namespace palpate::io
