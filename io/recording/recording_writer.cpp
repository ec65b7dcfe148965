// Writes recordings: a thread takes events from the servo's queue and appends lines to a file.
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <system_error>

#include "io/recording/recording_head.hpp"
#include "io/recording/trace_columns.hpp"
#include "io/system/stepping_thread.hpp"
#include "io/system/system.hpp"

namespace palpate::io {
namespace {

using namespace std::chrono_literals;

constexpr auto between_writes = 100ms;
constexpr auto between_syncs = 500ms;
constexpr std::size_t most_buffered = std::size_t{1} << 20;

constexpr std::string_view session_columns =
    ",status,force_flags,device_status,device_x,device_y,device_z,buttons,age,"
    "tool_xx,tool_xy,tool_xz,tool_yx,tool_yy,tool_yz,tool_zx,tool_zy,tool_zz,frozen,clutched,"
    "moment,samples,layer_touched,layers_inside,layers_punctured";
constexpr std::string_view check_columns = ",tick,crc32";

/// The cells of a tick that the session gave, without the end of the line.
void append_session(std::string& text, const SessionTick& tick) {
    append_row(text, trace_row(tick.tick));
    append_cell(text, static_cast<std::int64_t>(tick.tick.proxy.status));
    append_cell(text, static_cast<std::int64_t>(tick.tick.force_flags));
    append_cell(text, static_cast<std::int64_t>(tick.device.status));
    append_cells(text, tick.device.position);
    append_cell(text, static_cast<std::int64_t>(tick.device.buttons));
    append_cell(text, tick.device.age);
    for (int r = 0; r < 3; ++r) append_cells(text, tick.device.orientation.row(r));
    append_cell(text, static_cast<std::int64_t>(tick.frozen));
    append_cell(text, static_cast<std::int64_t>(tick.clutched));
    append_cell(text, tick.moment);
    append_cell(text, static_cast<std::int64_t>(tick.version));
    append_cell(text, std::int64_t{tick.tick.layers.touched});
    append_cell(text, std::int64_t{tick.tick.layers.inside});
    append_cell(text, std::int64_t{tick.tick.layers.punctured});
    append_tool(text, trace_row(tick.tick));
}

std::string head_text(const RecordingHead& head) {
    std::string text = "#";
    text += recording_mark;
    append_number(text, std::int64_t{recording_format});
    text += "\n# ";
    // A name that is not UTF-8 must not prevent a recording.
    for (const char c : to_json(head).dump(1, ' ', true, Json::error_handler_t::replace)) {
        text += c;
        if (c == '\n') text += "# ";
    }
    text += '\n';
    text += trace_header;
    text += session_columns;
    text += tool_header;
    text += check_columns;
    return text + '\n';
}

/// Room for the ticks of eight seconds and the commands between them.
std::size_t room_for(double rate) {
    return static_cast<std::size_t>(8 * rate);
}

}  // namespace

RecordingWriter::RecordingWriter(const std::filesystem::path& path, const RecordingHead& head,
                                 Pace pace)
    : path_(path), queue_(room_for(head.rate)) {
    buffer_.reserve(most_buffered);
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
    buffer_ = head_text(head);
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
    syncer_ =
        stepping_thread(between_syncs, [this](SteadyTime) { (void)synchronise(descriptor_); });
}

RecordingWriter::~RecordingWriter() {
    end_threads();
    if (descriptor_ >= 0) step();
    close();
}

/// Together, as both may have to wait.
void RecordingWriter::end_threads() {
    syncer_.request_stop();
    thread_ = {};
    syncer_ = {};
}

std::string RecordingWriter::problem() const {
    const std::scoped_lock lock(mutex_);
    return problem_;
}

void RecordingWriter::finish(std::int64_t lost) {
    end_threads();
    drain();
    buffer_ += "#";
    buffer_ += end_mark;
    buffer_ += Json{{"ticks", ticks()}, {"lost", lost}, {"crc32", checksum_}}.dump() + "\n";
    flush();
    (void)synchronise(descriptor_);
    close();
    if (const std::string wrong = problem(); !wrong.empty()) throw OutputError(wrong);
}

void RecordingWriter::step() {
    try {
        drain();
        flush();
    } catch (const std::bad_alloc&) {  // an event is lost, so that nothing may follow
        const std::scoped_lock lock(mutex_);
        problem_ = path_.string() +
                   ": recording stopped: there is too little memory; what was "
                   "recorded before is kept";
    }
}

void RecordingWriter::begin_with(std::vector<Command> commands) {
    const std::scoped_lock lock(mutex_);
    first_ = std::move(commands);
}

void RecordingWriter::drain() {
    const auto begin = [&] {
        std::vector<Command> first;
        {
            const std::scoped_lock lock(mutex_);
            first.swap(first_);
        }
        for (const Command& command : first) {
            append(command);
            if (buffer_.size() > most_buffered) flush();
        }
    };
    begin();
    while (const auto event = queue_.pop()) {
        begin();  // those that were given meanwhile, before the first event
        std::visit([this](const auto& one) { append(one); }, *event);
        if (buffer_.size() > most_buffered) flush();
    }
}

void RecordingWriter::append(const SessionTick& tick) {
    const std::size_t begin = buffer_.size();
    append_session(buffer_, tick);
    append_cell(buffer_, ticks_.fetch_add(1, std::memory_order_relaxed));
    checksum_ = checksum_with(std::string_view(buffer_).substr(begin), checksum_);
    append_cell(buffer_, std::int64_t{checksum_});
    buffer_ += '\n';
}

void RecordingWriter::append(const Command& command) {
    const std::size_t begin = buffer_.size();
    buffer_ += "#";
    buffer_ += command_mark;
    buffer_ += to_json(command, bodies_).dump();
    checksum_ = checksum_with(std::string_view(buffer_).substr(begin), checksum_);
    buffer_ += '\n';
}

void RecordingWriter::flush() {
    if (!problem().empty()) buffer_.clear();
    std::string_view rest = buffer_;
    while (!rest.empty()) {
        const ssize_t count = ::write(descriptor_, rest.data(), rest.size());
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) break;
        rest.remove_prefix(static_cast<std::size_t>(count));
    }
    const int error = errno;
    const std::string_view done(buffer_.data(), buffer_.size() - rest.size());
    written_ += static_cast<std::int64_t>(done.rfind('\n') + 1);  // npos + 1 is 0
    if (!rest.empty()) {
        // What is there ends with a whole line. Should that fail, readers leave a torn line out.
        if (seekable_) (void)truncate(descriptor_, written_);
        const std::scoped_lock lock(mutex_);
        problem_ = path_.string() + ": recording stopped: " + reason(error) +
                   (means_full(error) ? ": free some space" : ": record to another place") +
                   "; what was recorded before is kept";
    }
    buffer_.clear();
}

void RecordingWriter::close() {
    if (descriptor_ >= 0) ::close(descriptor_);
    descriptor_ = -1;
}

}  // namespace palpate::io
