// Atomic output by descriptors, because streams report a full disk late or not at all.
#include "palpate/io/output.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "io/system/leftovers.hpp"
#include "io/system/system.hpp"

namespace palpate::io {
namespace {

constexpr std::size_t buffer_bytes = std::size_t{1} << 20;

/// The remedy for common errors.
std::string remedy(int error) {
    if (means_full(error)) return ": free some space or write elsewhere";
    switch (error) {
        case EACCES:
        case EPERM:
        case EROFS:
            return ": choose a place that you may write to";
        case EPIPE:
            return ": the program that reads it has ended";
        case ENAMETOOLONG:
            return ": choose a shorter name";
        default:
            return ": choose another place";
    }
}

std::string because(int error) {
    return reason(error) + remedy(error);
}

/// Whether a descriptor leads to where standard output does.
bool is_standard_output(int descriptor) {
    struct stat its {
    }, own{};
    return ::fstat(descriptor, &its) == 0 && ::fstat(STDOUT_FILENO, &own) == 0 &&
           its.st_dev == own.st_dev && its.st_ino == own.st_ino;
}

/// The file at the end of a chain of links, there or not; the path itself if it is no link, or if
/// what it leads to has no path, as /dev/stdout in a pipeline.
std::filesystem::path followed(std::filesystem::path path) {
    constexpr int longest_chain = 40;  // as of Linux
    std::error_code error;
    if (!std::filesystem::is_symlink(path, error)) return path;
    const auto end = std::filesystem::canonical(path, error);
    if (!error) return end;
    if (std::filesystem::exists(path, error)) return path;
    for (int i = 0; i < longest_chain && std::filesystem::is_symlink(path, error); ++i) {
        path = path.parent_path() / std::filesystem::read_symlink(path, error);
    }
    return path;
}

std::filesystem::path folder_of(const std::filesystem::path& file) {
    return file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
}

/// An empty path is the name of nothing.
void remove_if_there(const std::filesystem::path& file) noexcept {
    std::error_code ignored;
    if (!file.empty()) std::filesystem::remove(file, ignored);
}

}  // namespace

bool is_same_file(const std::filesystem::path& a, const std::filesystem::path& b) {
    namespace fs = std::filesystem;
    std::error_code error;
    if (fs::exists(a, error) && fs::exists(b, error)) {
        return fs::is_regular_file(a, error) && fs::equivalent(a, b, error);
    }
    // Made absolute first: a relative name that does not exist would stay relative.
    const auto whole = [&](const fs::path& path) {
        return fs::weakly_canonical(fs::absolute(followed(path), error), error);
    };
    return !whole(a).empty() && whole(a) == whole(b);
}

void check_output(const std::filesystem::path& path) {
    const std::filesystem::path target = followed(path);
    const auto fail = [&](const std::string& problem) {
        throw OutputError(target.string() + ": " + problem);
    };
    if (target == "-") return;
    if (target.empty()) throw OutputError("the output has no name: give one");
    std::error_code error;
    const auto status = std::filesystem::status(target, error);
    if (std::filesystem::is_directory(status) || !target.has_filename()) {
        fail("is a folder: name a file in it");
    }
    if (error == std::errc::filename_too_long) fail("cannot be written: " + because(error.value()));
    if (std::filesystem::exists(status)) {
        const int problem = why_unwritable(target);
        if (problem != 0) fail("exists and cannot be overwritten: " + because(problem));
        if (!std::filesystem::is_regular_file(status)) return;
    }
    const auto folder = folder_of(target);
    if (!std::filesystem::is_directory(folder, error)) {
        if (error && error != std::errc::no_such_file_or_directory) {
            fail("cannot be written: " + because(error.value()));
        }
        fail(std::filesystem::exists(folder, error)
                 ? "cannot be written: " + folder.string() + " is not a folder"
                 : "cannot be written: the folder " + folder.string() +
                       " does not exist: create it first");
    }
    if (const int problem = why_no_file_in(folder)) fail("cannot be written: " + because(problem));
}

PendingFile::PendingFile(const std::filesystem::path& target) : target_(followed(target)) {
    check_output(target);
    buffer_.reserve(buffer_bytes);
    if (target_ == "-") {
        target_ = "standard output";
        descriptor_ = open_standard_output();
        if (descriptor_ < 0) fail("cannot be written: " + because(errno));
        return;
    }
    std::error_code error;
    const auto status = std::filesystem::status(target_, error);
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
        descriptor_ = open_to_write(target_);
        if (descriptor_ < 0) fail("cannot be opened for writing: " + because(errno));
        return;
    }
    open_temporary();
}

void PendingFile::open_temporary() {
    const auto folder = folder_of(target_);
    std::error_code error;
    remove_leftovers(folder);
    // The mode that a plain open would give, or that of the file it replaces.
    const auto old = std::filesystem::status(target_, error);
    do {
        temporary_ = temporary_in(folder);
        descriptor_ = create_to_write(temporary_);
    } while (descriptor_ < 0 && errno == EEXIST);
    if (descriptor_ < 0) {
        const int problem = errno;
        temporary_.clear();
        fail("cannot be written: " + because(problem));
    }
    lock_ = lock_temporary(temporary_);
    temporary_ = signed_temporary(temporary_);
    if (!std::filesystem::exists(old)) return;
    if (!give_mode(temporary_, old.permissions())) {
        fail("cannot be given the mode of the file it replaces: " + because(errno));
    }
}

PendingFile::~PendingFile() {
    discard();
}

void PendingFile::discard() noexcept {
    if (descriptor_ >= 0) ::close(descriptor_);
    descriptor_ = -1;
    remove_if_there(temporary_);
    temporary_.clear();
    if (lock_ >= 0) ::close(lock_);
    lock_ = -1;
}

void PendingFile::fail(const std::string& problem) {
    discard();
    throw OutputError(target_.string() + ": " + problem);
}

void PendingFile::fail_to_write(int error) {
    const bool has_reader_gone = error == EPIPE && is_standard_output(descriptor_);
    discard();
    const std::string text = target_.string() + ": could not be written: " + because(error);
    if (has_reader_gone) throw ReaderGone(text);
    if (error == EINTR) throw WaitEnded(text + ": let its reader read on");
    throw OutputError(text);
}

void PendingFile::write(std::string_view bytes) {
    if (descriptor_ < 0) throw OutputError(target_.string() + ": is closed already");
    while (!bytes.empty()) {
        const auto part = bytes.substr(0, buffer_bytes - buffer_.size());
        buffer_ += part;
        bytes.remove_prefix(part.size());
        if (buffer_.size() == buffer_bytes) flush();
    }
}

void PendingFile::flush() {
    if (!write_all(descriptor_, buffer_)) fail_to_write(errno);
    buffer_.clear();
}

/// To the disk, and closed: all that can fail for lack of space.
void PendingFile::complete() {
    if (descriptor_ < 0) throw OutputError(target_.string() + ": is closed already");
    flush();
    if (!temporary_.empty() && !synchronise(descriptor_)) fail_to_write(errno);
    const int closing = descriptor_;
    descriptor_ = -1;
    if (::close(closing) != 0 && errno != EINTR) fail_to_write(errno);
}

/// If not for good, the previous target is kept under the temporary name. If names cannot be
/// exchanged, a copy of it is kept, so that the target exists all the time.
void PendingFile::put_in_place(bool for_good) {
    if (temporary_.empty()) return;
    in_place_ = true;
    if (!for_good && exchange(temporary_, target_)) return;
    std::filesystem::path before;
    std::error_code error;
    if (!for_good && std::filesystem::exists(target_, error)) {
        before = temporary_in(folder_of(target_));
        std::filesystem::copy_file(target_, before, error);
    }
    if (error || !replace(temporary_, target_)) {
        const int problem = error ? error.value() : errno;
        remove_if_there(before);
        in_place_ = false;
        fail("could not be put in place: " + because(problem));
    }
    temporary_ = before;
}

void PendingFile::take_back() noexcept {
    if (!in_place_) return discard();
    if (temporary_.empty()) {
        remove_if_there(target_);
    } else {
        replace(temporary_, target_);
        temporary_.clear();
    }
}

void PendingFile::keep() noexcept {
    discard();  // what was there before
    if (!in_place_) return;
    // So that the name survives a power cut, too; the data is complete in any case.
    synchronise_folder(folder_of(target_));
}

void PendingFile::commit_together(const std::vector<PendingFile*>& files) {
    try {
        for (PendingFile* file : files) file->complete();
        for (PendingFile* file : files) file->put_in_place(file == files.back());
    } catch (const OutputError&) {
        for (PendingFile* file : files) file->take_back();
        throw;
    }
    for (PendingFile* file : files) file->keep();
}

void PendingFile::commit() {
    commit_together({this});
}

void write_file(const std::filesystem::path& path, std::string_view bytes) {
    PendingFile file(path);
    file.write(bytes);
    file.commit();
}

}  // namespace palpate::io
