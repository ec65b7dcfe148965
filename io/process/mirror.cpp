// Pages of a file that lies elsewhere; see the header.
#include "io/process/mirror.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <vector>

namespace palpate::io {
namespace {

constexpr std::uint64_t page = std::uint64_t{256} << 10;
/// Pages for one job, and those that are kept for the next one [bytes].
constexpr std::uint64_t most_held = std::uint64_t{512} << 20, most_kept = std::uint64_t{64} << 20;

[[noreturn]] void fail_to_hold() {
    throw std::system_error(errno, std::generic_category(), "no memory for a part of it");
}

}  // namespace

Mirror::Mirror(std::string name, std::uint64_t size, Read read)
    : name_(std::move(name)), size_(size), read_(std::move(read)), memory_(shared_memory()) {
    if (ftruncate(memory_.number(), static_cast<off_t>(size_)) != 0) fail_to_hold();
}

void Mirror::fetch(std::uint64_t offset, std::uint64_t length, const std::stop_token& stop) {
    if (length == 0 || offset >= size_ || length > size_ - offset) {
        throw std::invalid_argument("the helper process asks for what is not in the file");
    }
    for (std::uint64_t at = offset / page * page; at < offset + length; at += page) {
        const auto hole = static_cast<off_t>(at);
        if (lseek(memory_.number(), hole, SEEK_DATA) == hole) continue;
        std::vector<std::byte> bytes(std::min(page, size_ - at));
        if (held_ + bytes.size() > most_held) {
            throw std::invalid_argument("its metadata are too large to be read from there");
        }
        read_(at, bytes, stop);
        const auto wrote = pwrite(memory_.number(), bytes.data(), bytes.size(), hole);
        if (wrote != static_cast<ssize_t>(bytes.size())) fail_to_hold();
        held_ += bytes.size();
    }
}

void Mirror::tidy() {
    if (held_ <= most_kept) return;
    held_ = 0;
    for (const std::uint64_t size : {std::uint64_t{0}, size_}) {
        if (ftruncate(memory_.number(), static_cast<off_t>(size)) != 0) fail_to_hold();
    }
}

}  // namespace palpate::io
