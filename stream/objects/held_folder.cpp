// A folder that is being written, held open. See the header.
#include "stream/objects/held_folder.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "io/system/open_file.hpp"
#include "io/system/system.hpp"
#include "palpate/io/error.hpp"

namespace palpate::stream {
namespace {

namespace fs = std::filesystem;

constexpr int as_held_folder = O_RDONLY | O_DIRECTORY | O_CLOEXEC;

/// 0, or the error number, as put_below().
int put_in(int folder, const std::string& name, std::span<const std::byte> bytes,
           const std::string& temporary) {
    const std::string before = name + temporary;
    constexpr int as_new = O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC;
    int file = ::openat(folder, before.c_str(), as_new, 0666);
    if (file < 0 && errno == EEXIST && ::unlinkat(folder, before.c_str(), 0) == 0) {
        file = ::openat(folder, before.c_str(), as_new, 0666);  // of a run that was ended
    }
    if (file < 0) return errno;
    const auto* const text = reinterpret_cast<const char*>(bytes.data());
    int problem = io::write_all(file, {text, bytes.size()}) ? 0 : errno;
    if (::close(file) != 0 && problem == 0) problem = errno;
    if (problem != 0) return problem;
    return ::renameat(folder, before.c_str(), folder, name.c_str()) == 0 ? 0 : errno;
}

int put_below(int folder, const fs::path& name, std::span<const std::byte> bytes,
              const std::string& temporary) {
    const fs::path first = *name.begin();
    if (first == name) return put_in(folder, name.string(), bytes, temporary);
    if (::mkdirat(folder, first.c_str(), 0777) != 0 && errno != EEXIST) return errno;
    const io::Descriptor inner(::openat(folder, first.c_str(), as_held_folder | O_NOFOLLOW));
    if (inner.number() < 0) return errno;
    return put_below(inner.number(), name.lexically_relative(first), bytes, temporary);
}

}  // namespace

HeldFolder::HeldFolder(fs::path path)
    : path_(std::move(path)), held_(::open(path_.c_str(), as_held_folder)) {}

HeldFolder::~HeldFolder() {
    if (held_ >= 0) ::close(held_);
}

int HeldFolder::held() {
    const std::lock_guard lock(mutex_);
    if (held_ < 0) held_ = ::open(path_.c_str(), as_held_folder);
    return held_;
}

void HeldFolder::make() {
    std::error_code error;
    if (held() < 0) fs::create_directories(path_, error);
}

void HeldFolder::put(const fs::path& name, std::span<const std::byte> bytes,
                     const std::string& temporary) {
    const int folder = held();
    struct stat then {
    }, now{};
    if (folder < 0 || ::fstat(folder, &then) != 0 || ::stat(path_.c_str(), &now) != 0 ||
        then.st_dev != now.st_dev || then.st_ino != now.st_ino) {
        fail_without(path_);
    }
    if (const int problem = put_below(folder, name, bytes, temporary)) {
        throw io::OutputError((path_ / name).string() + ": cannot be written (" +
                              io::reason(problem) + "); is the disk full?");
    }
}

io::Descriptor HeldFolder::open(const fs::path& name) {
    return io::Descriptor(io::open_file_in(held(), name.string()));
}

void fail_without(const fs::path& folder) {
    throw io::OutputError(folder.string() +
                          ": was removed or renamed while it was written; run it again");
}

}  // namespace palpate::stream
