// Writes recordings: a thread takes events from the servo's queue and appends lines to a file.
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <system_error>
#include <thread>
#include <utility>

#include "io/recording/recording_text.hpp"
#include "io/system/stepping_thread.hpp"
#include "io/system/system.hpp"

namespace palpate::io {
namespace {

using namespace std::chrono_literals;

constexpr auto between_writes = 100ms;
constexpr auto between_syncs = 500ms;
/// For the reader of a pipe that reads nothing. The queues have no room for more.
constexpr std::chrono::seconds patience{8};
/// The same at the end of a recording, if the caller sets no limit.
constexpr std::chrono::milliseconds last_patience{500};
constexpr std::size_t most_buffered = std::size_t{1} << 20;

/// Room for the ticks of eight seconds and the commands between them.
std::size_t room_for(double rate) {
    return static_cast<std::size_t>(8 * rate);
}

using Clock = std::chrono::steady_clock;
/// The reader of a pipe is not waited for any longer.
struct Unread {
    int error;  ///< for why()
};

OnProgress until_late() {
    return [end = Clock::now() + last_patience](double) {
        if (Clock::now() > end) throw Unread{EINTR};
    };
}

std::string why(int error) {
    if (error == EINTR) return "its reader was not waited for any longer: let it read on";
    if (error == ETIMEDOUT) return "its reader has not read for 8 s: let it read on";
    return reason(error) + (means_full(error) ? ": free some space" : ": record to another place");
}

}  // namespace

RecordingWriter::RecordingWriter(const std::filesystem::path& path,
                                 std::span<const RecordingHead> heads, Pace pace)
    : path_(path), text_(std::make_unique<RecordingText>(heads)) {
    for (const RecordingHead& head : heads) {
        hands_.push_back(std::make_unique<Hand>(room_for(head.rate)));
    }
    text_->lines.reserve(most_buffered);
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (std::filesystem::is_regular_file(status)) {
        throw OutputError(path.string() +
                          ": exists; a recording never replaces a file: choose another name");
    }
    const bool stream = std::filesystem::exists(status) && !std::filesystem::is_directory(status);
    descriptor_ = stream ? open_to_write(path) : create_to_write(path);
    if (descriptor_ < 0) {
        throw OutputError(path.string() + ": cannot be written: " + reason(errno) +
                          ": choose another place");
    }
    seekable_ = !stream;
    flush();
    if (const std::string wrong = problem(); !wrong.empty()) {
        close();
        if (seekable_) std::filesystem::remove(path_, error);
        throw OutputError(wrong);
    }
    if (pace == Pace::by_steps) return;
    thread_ = stepping_thread(between_writes, [this](SteadyTime) { step(); });
    // A thread of its own: a disk that is busy for seconds must not keep the queue from being
    // emptied. Pipes have no disk; a write tells what is wrong.
    syncer_ = stepping_thread(between_syncs, [this](SteadyTime) { keep_on_disk(); });
}

/// What it holds, and its name.
void RecordingWriter::keep_on_disk() const {
    if (!seekable_) return;
    (void)synchronise(descriptor_);
    synchronise_folder(path_.has_parent_path() ? path_.parent_path() : ".");
}

RecordingWriter::~RecordingWriter() {
    try {
        if (descriptor_ >= 0 && !seekable_) {
            const OnProgress wait = until_late();
            const auto lock = locked_file(wait);
            flush(wait);
        }
    } catch (const std::exception&) {  // no memory
    }
    gives_up_ = true;
    end_threads();
    if (descriptor_ >= 0) step();
    close();
}

/// The thread may have the lock while it waits for the reader of a pipe.
std::unique_lock<std::mutex> RecordingWriter::locked_file(const OnProgress& wait) {
    std::unique_lock lock(file_mutex_, std::defer_lock);
    if (seekable_) lock.lock();
    while (!lock.owns_lock() && !lock.try_lock()) {
        try {
            if (!gives_up_) wait(1);
        } catch (...) {
            gives_up_ = true;
            lock.lock();  // whose thread ends its wait now
            given_up_ = std::current_exception();
            return lock;
        }
        std::this_thread::sleep_for(1ms);
    }
    return lock;
}

/// Together, as both may have to wait.
void RecordingWriter::end_threads() {
    syncer_.request_stop();
    thread_ = {};
    syncer_ = {};
}

std::int64_t RecordingWriter::ticks(int hand) const {
    return text_->ticks(hand);
}

std::string RecordingWriter::problem() const {
    const std::scoped_lock lock(mutex_);
    return problem_;
}

void RecordingWriter::finish(std::int64_t lost, int hand, const OnProgress& progress) {
    const OnProgress wait = progress ? progress : until_late();
    bool is_last = false;
    std::exception_ptr given_up;
    {
        const auto lock = locked_file(wait);
        drain(hand, wait);
        flush(wait);
        lost_ += lost;
        is_last = ++ended_ == hands_.size();
        given_up = std::exchange(given_up_, nullptr);
    }
    if (is_last) {
        end_threads();  // they may wait for the lock
        text_->end(lost_, begins());
        flush(wait);
        keep_on_disk();
        close();
        if (given_up_) given_up = std::exchange(given_up_, nullptr);
    }
    try {
        if (given_up) std::rethrow_exception(given_up);
    } catch (const Unread&) {  // which problem() tells
    }
    if (const std::string wrong = problem(); !wrong.empty()) throw OutputError(wrong);
}

void RecordingWriter::step() {
    try {
        const std::scoped_lock lock(file_mutex_);
        for (int hand = 1; hand <= static_cast<int>(hands_.size()); ++hand) drain(hand);
        flush();
    } catch (const std::bad_alloc&) {  // an event is lost, so that nothing may follow
        const std::scoped_lock lock(mutex_);
        problem_ = path_.string() +
                   ": recording stopped: there is too little memory; what was "
                   "recorded before is kept";
    }
}

void RecordingWriter::begin_with(std::vector<Command> commands, int hand) {
    const std::scoped_lock lock(mutex_);
    of(hand).first = std::move(commands);
}

void RecordingWriter::set_begin(std::int64_t ns, int hand) {
    const std::scoped_lock lock(mutex_);
    of(hand).begin = ns;
}

/// After the first hand's [s]; empty where a hand has not told its own.
std::vector<double> RecordingWriter::begins() {
    const std::scoped_lock lock(mutex_);
    std::vector<double> begins;
    for (const auto& hand : hands_) {
        if (!hand->begin || !hands_.front()->begin) return {};
        begins.push_back(1e-9 * static_cast<double>(*hand->begin - *hands_.front()->begin));
    }
    return begins;
}

void RecordingWriter::drain(int hand, const OnProgress& wait) {
    Hand& from = of(hand);
    const auto begin = [&] {
        std::vector<Command> first;
        {
            const std::scoped_lock lock(mutex_);
            first.swap(from.first);
        }
        for (const Command& command : first) {
            text_->append(command, hand);
            if (text_->lines.size() > most_buffered) flush(wait);
        }
    };
    begin();
    while (const auto event = from.queue.pop()) {
        begin();  // those that were given meanwhile, before the first event
        std::visit([&](const auto& one) { text_->append(one, hand); }, *event);
        if (text_->lines.size() > most_buffered) flush(wait);
    }
}

/// To the reader of a pipe, in parts. What is left stays in `rest`; returns why.
int RecordingWriter::pass_on(std::string_view& rest, const OnProgress& wait) {
    constexpr std::size_t part = 4096;
    try {
        while (!rest.empty()) {
            const auto latest = Clock::now() + patience;
            const auto while_unread = [&] {
                if (wait) wait(1);
                if (gives_up_) throw Unread{EINTR};
                if (Clock::now() > latest) throw Unread{ETIMEDOUT};
            };
            if (!write_all(descriptor_, rest.substr(0, part), while_unread)) return errno;
            rest.remove_prefix(std::min(part, rest.size()));
        }
    } catch (const Unread& unread) {
        return unread.error;
    } catch (...) {
        gives_up_ = true;
        given_up_ = std::current_exception();
        return EINTR;
    }
    return 0;
}

void RecordingWriter::flush(const OnProgress& wait) {
    std::string& buffer = text_->lines;
    if (!problem().empty()) buffer.clear();
    std::string_view rest = buffer;
    const int unread = seekable_ ? 0 : pass_on(rest, wait);
    while (seekable_ && !rest.empty()) {
        const ssize_t count = ::write(descriptor_, rest.data(), rest.size());
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) break;
        rest.remove_prefix(static_cast<std::size_t>(count));
    }
    const int error = seekable_ ? errno : unread;
    const std::string_view done(buffer.data(), buffer.size() - rest.size());
    written_ += static_cast<std::int64_t>(done.rfind('\n') + 1);  // npos + 1 is 0
    if (!rest.empty()) {
        // Ends the file with a whole line. If that fails, readers leave the torn line out.
        if (seekable_) (void)truncate(descriptor_, written_);
        const std::scoped_lock lock(mutex_);
        problem_ = path_.string() + ": recording stopped: " + why(error) +
                   "; what was recorded before is kept";
    }
    buffer.clear();
}

void RecordingWriter::close() {
    if (descriptor_ >= 0) ::close(descriptor_);
    descriptor_ = -1;
}

}  // namespace palpate::io
