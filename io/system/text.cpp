// Reads a whole text from a file, a pipe or a device. Its length is limited, and waits can be
// ended, because a pipe may have no writer and a device has no end. POSIX.
#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdint>

#include "io/process/helper_process.hpp"
#include "palpate/io/csv.hpp"

namespace palpate::io {
namespace {

constexpr std::size_t block_bytes = std::size_t{1} << 20;
constexpr std::size_t longest_line = std::size_t{16} << 20;
constexpr std::uint64_t largest_file = std::uint64_t{4} << 30;
constexpr std::uint64_t largest_stream = std::uint64_t{256} << 20;
constexpr int poll_ms = 50;
constexpr std::chrono::seconds patience{10};

class TextSource {
  public:
    explicit TextSource(const std::filesystem::path& path)
        // Without blocking: the open of a pipe waits for its writer, and no signal would end that.
        : path_(path), file_(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY)) {
        struct stat status {};
        if (file_.number() < 0 || ::fstat(file_.number(), &status) != 0) {
            fail("cannot be opened: " + reason(errno) +
                 ": check the name and your permission to read it");
        }
        if (S_ISDIR(status.st_mode)) fail("is a folder: name a file in it");
        is_stream_ = !S_ISREG(status.st_mode);
        if (is_stream_) return;
        check_total(static_cast<std::uint64_t>(status.st_size));
        text_.reserve(static_cast<std::size_t>(status.st_size) + 1);
    }

    std::string read(const OnProgress& progress) {
        for (;;) {
            if (is_stream_) wait(progress);
            const std::size_t before = text_.size();
            text_.resize(before + block_bytes);
            const ssize_t count = ::read(file_.number(), text_.data() + before, block_bytes);
            const int problem = errno;
            text_.resize(before + static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
            if (count == 0) break;
            if (count > 0) {
                check_length(before);
            } else if (problem != EAGAIN && problem != EINTR) {
                fail("cannot be read: " + reason(problem) + ": check the disk it is on");
            }
        }
        if (text_.starts_with("\xEF\xBB\xBF")) text_.erase(0, 3);
        return std::move(text_);
    }

  private:
    [[noreturn]] void fail(const std::string& problem) const {
        throw InputError(path_.string() + ": " + problem);
    }

    /// Until there is something to read, or the end.
    void wait(const OnProgress& progress) const {
        const auto start = std::chrono::steady_clock::now();
        pollfd source{file_.number(), POLLIN, 0};
        for (int ready; (ready = ::poll(&source, 1, poll_ms)) <= 0;) {
            if (progress) {
                progress(0);
            } else if (ready < 0 && errno == EINTR) {
                fail("reading it was interrupted");
            } else if (std::chrono::steady_clock::now() - start > patience) {
                fail("no data for 10 s: start the program that writes to it first");
            }
        }
        if (progress) progress(0);  // a source that never runs dry must not keep a signal waiting
    }

    void check_total(std::uint64_t bytes) const {
        if (is_stream_ && bytes > largest_stream) {
            fail("more than 256 MiB of text: write it to a file and use the file");
        }
        if (bytes > largest_file) {
            fail("has " + std::to_string(bytes) +
                 " bytes, text is read up to 4 GiB: cut it into parts");
        }
    }

    void check_length(std::size_t before) {
        check_total(text_.size());
        if (text_.find('\0', before) != std::string::npos) {
            fail("is not a text file: check its name");
        }
        const auto first_end = text_.find('\n', before);
        const std::size_t first = first_end == std::string::npos ? text_.size() : first_end;
        if (first - line_begin_ > longest_line) {
            fail("line " + std::to_string(lines_ + 1) +
                 " is longer than 16 MiB: this is no table, or its line ends are missing");
        }
        if (first_end == std::string::npos) return;
        lines_ += static_cast<std::size_t>(
            std::count(text_.begin() + static_cast<std::ptrdiff_t>(first_end), text_.end(), '\n'));
        line_begin_ = text_.rfind('\n') + 1;
    }

    const std::filesystem::path& path_;
    Descriptor file_;
    bool is_stream_ = false;
    std::string text_;
    std::size_t line_begin_ = 0, lines_ = 0;  // of the line that is not complete yet
};

}  // namespace

std::string read_text(const std::filesystem::path& path, const OnProgress& progress) {
    return TextSource(path).read(progress);
}

}  // namespace palpate::io
