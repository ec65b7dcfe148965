// Reads recordings: the head, then commands and ticks in the order in which they took effect.
#include <algorithm>
#include <cmath>
#include <deque>
#include <fstream>
#include <limits>
#include <numeric>

#include "io/json_text.hpp"
#include "io/recording/recording_head.hpp"
#include "io/recording/trace_columns.hpp"

namespace palpate::io {
namespace {

/// That is read without the whole file [bytes].
constexpr std::size_t longest_head = std::size_t{64} << 20;

struct Head {
    int format = 0;
    std::vector<RecordingHead> hands;
};

/// The comment lines before the table: the mark with the format's number, then JSON.
Head read_head(const std::string& comments, const std::string& name) {
    const auto fail = [&](const std::string& problem) -> void {
        throw InputError(name + ": " + problem);
    };
    const auto first_end = comments.find('\n');
    const std::string_view first(comments.data(), std::min(first_end, comments.size()));
    if (!first.starts_with(recording_mark)) {
        fail("is no recording: its first line is not '#" + std::string(recording_mark) +
             std::to_string(format_of_one_hand) + "'; give one that a live session has recorded");
    }
    const auto format = number_from<int>(first.substr(recording_mark.size()));
    if (!format || *format < 1) fail("the format of the recording is not a number");
    if (*format > recording_format) {
        fail("is a recording of format " + std::to_string(*format) +
             ", made by a later version: use that");
    }
    try {
        return {*format, heads_from_json(parsed_json(comments.substr(first.size())), *format)};
    } catch (const Json::exception&) {
        fail("the head is not valid JSON: the file was changed or cut off");
    } catch (const std::invalid_argument& e) {
        fail(std::string("the head is not valid: ") + e.what());
    }
    return {};
}

/// All lines that are whole: those with an end, and the last one of a recording, which shows its
/// own end. Editors may leave out the end of the last line.
std::string_view whole_events(std::string_view text) {
    const std::string_view whole = whole_lines(text);
    const std::string_view rest = text.substr(whole.size());
    if (!rest.starts_with('#') || !rest.substr(1).starts_with(end_mark)) return whole;
    return parsed_or_discarded(rest.substr(1 + end_mark.size())).is_object() ? text : whole;
}

}  // namespace

struct RecordingReader::Rows {
    std::string text;
    std::string name;
    const int hand;       // that is read, from 1
    bool in_head = true;  // comments belong to the head
    std::deque<SessionEvent> waiting;
    bool complete = false;
    std::int64_t lost = 0;
    std::optional<double> begin;      // [s] after that of the first hand
    std::vector<std::int64_t> ticks;  // of each hand so far
    Bodies bodies;
    std::uint32_t checksum = 0;  // of the events so far
    CsvReader csv;
    TraceColumns trace;
    VectorColumns position;
    std::size_t status, force_flags, device_status, buttons, age, frozen, clutched;
    std::optional<std::size_t> moment, samples;        // of format 1, fixed samples may lack them
    std::optional<std::array<std::size_t, 3>> layers;  // from format 3 on
    std::optional<ToolColumns> felt_tool;              // from format 4 on
    std::optional<std::size_t> opening;                // from format 6 on
    std::optional<std::size_t> hand_column;            // of format 7
    std::optional<std::size_t> number, crc32;          // format 1 does
    std::array<std::size_t, 9> tool;

    Rows(std::string whole, std::string called, int format, std::size_t hands, int its_hand)
        : text(std::move(whole)),
          name(std::move(called)),
          hand(its_hand),
          ticks(hands),
          csv(whole_events(text), name, [this](std::string_view comment) { on_comment(comment); }),
          trace(csv),
          position(csv, "device"),
          status(csv.column("status")),
          force_flags(csv.column("force_flags")),
          device_status(csv.column("device_status")),
          buttons(csv.column("buttons")),
          age(csv.column("age")),
          frozen(csv.column("frozen")),
          clutched(csv.column("clutched")) {
        // A misspelt one must not count as one that is not there.
        if (format > 1 || csv.has_column("moment")) moment = csv.column("moment");
        if (format > 1 || csv.has_column("samples")) samples = csv.column("samples");
        if (format > 2) {
            layers = {csv.column("layer_touched"), csv.column("layers_inside"),
                      csv.column("layers_punctured")};
        }
        if (format > 3) felt_tool.emplace(csv);
        if (format > 5) opening = csv.column("opening");
        if (format > format_of_one_hand) hand_column = csv.column("hand");
        if (format > 1) {
            number = csv.column("tick");
            crc32 = csv.column("crc32");
        }
        in_head = false;
        std::size_t i = 0;
        for (const char r : {'x', 'y', 'z'}) {
            for (const char c : {'x', 'y', 'z'})
                tool[i++] = csv.column(std::string("tool_") + r + c);
        }
    }

    void on_comment(std::string_view comment) {
        if (in_head) return;
        if (comment.starts_with(command_mark)) {
            require_before_end();
            checksum = checksum_with(comment, checksum_with("#", checksum));
            try {
                Json command = parsed_json(comment.substr(command_mark.size()));
                if (hand_column && taken_hand(command) != hand) return;
                waiting.emplace_back(command_from_json(command, bodies));
            } catch (const std::exception&) {  // JSON's own, or what is wrong with a member
                csv.fail("the command " + quoted(comment) + " is not valid");
            }
        } else if (comment.starts_with(end_mark)) {
            require_before_end();
            on_end(parsed_or_discarded(comment.substr(end_mark.size())));
        }
    }

    /// Whose command it is.
    int taken_hand(Json& command) const {
        const Json whose = member(command, "hand");
        command.erase("hand");
        const std::int64_t named = whose.is_number_integer() ? whose.get<std::int64_t>() : 0;
        if (named < 1 || named > static_cast<std::int64_t>(ticks.size())) {
            throw std::invalid_argument("'hand' is out of range");
        }
        return static_cast<int>(named);
    }

    void require_before_end() const {
        if (complete) csv.fail("there is more after the end of the recording: remove it");
    }

    /// The last line: how many ticks there were, and the checksum of all events.
    void on_end(const Json& end) {
        const auto count = [&](const char* member) {
            const auto value = end.is_object() ? end.find(member) : end.end();
            if (value == end.end() || !value->is_number_integer()) {
                csv.fail(std::string("the last line has no whole number '") + member + "'");
            }
            return value->get<std::int64_t>();
        };
        const auto there = std::accumulate(ticks.begin(), ticks.end(), std::int64_t{0});
        if (const std::int64_t recorded = count("ticks"); recorded != there) {
            csv.fail(std::to_string(recorded) + " ticks were recorded, there are " +
                     std::to_string(there) + changed);
        }
        if (crc32 && count("crc32") != std::int64_t{checksum}) {
            csv.fail(std::string("the checksum of all events does not fit") + changed);
        }
        lost = count("lost");
        if (end.contains("begins")) begin = begin_in(end["begins"]);
        complete = true;
    }

    double begin_in(const Json& begins) const {
        const bool is_list = begins.is_array() && begins.size() == ticks.size();
        const auto is_number = [](const Json& one) {
            return one.is_number() && std::isfinite(one.get<double>());
        };
        if (!is_list || !std::ranges::all_of(begins, is_number)) {
            csv.fail("'begins' in the last line is no list of a number for each hand");
        }
        return begins[static_cast<std::size_t>(hand - 1)].get<double>();
    }

    static constexpr const char* changed =
        ": ticks or commands were removed, added, moved or changed since it was recorded: use the "
        "original file";

    /// That this row follows the one before, and nothing between them is missing. Returns whose it
    /// is.
    int check_order() {
        require_before_end();
        const int whose = hand_column ? hand_of_row() : 1;
        std::int64_t& expected = ticks[static_cast<std::size_t>(whose - 1)];
        if (number && csv.integer(*number) != expected) {
            csv.fail("tick " + std::to_string(expected) + " is expected, there is tick " +
                     std::string(csv.cell(*number)) + changed);
        }
        ++expected;
        if (crc32) check_sum();
        return whose;
    }

    int hand_of_row() const {
        const auto last = static_cast<std::int64_t>(ticks.size());
        const std::int64_t whose = csv.integer(*hand_column);
        if (whose < 1 || whose > last) {
            csv.fail(quoted(csv.cell(*hand_column)) + " is out of range: hands are 1 to " +
                     std::to_string(last));
        }
        return static_cast<int>(whose);
    }

    void check_sum() {
        checksum = checksum_with(csv.row().substr(0, csv.row().rfind(',')), checksum);
        if (csv.integer(*crc32) != std::int64_t{checksum}) {
            csv.fail(std::string("the checksum of the events up to here does not fit") + changed);
        }
    }

    std::int64_t code(std::size_t column, std::int64_t largest) const {
        const std::int64_t value = csv.integer(column);
        if (value < 0 || value > largest) {
            csv.fail(quoted(csv.cell(column)) + " is out of range: at most " +
                     std::to_string(largest));
        }
        return value;
    }

    /// -1 if no layer is touched.
    std::int8_t layer_number(std::size_t column, int least) const {
        const std::int64_t value = csv.integer(column);
        if (value < least || value > Layers::most_layers) {
            csv.fail(quoted(csv.cell(column)) + " is no number of layers: at most 16");
        }
        return static_cast<std::int8_t>(value);
    }
    LayersFelt layers_felt() const {
        return {layer_number((*layers)[0], -1), layer_number((*layers)[1], 0),
                layer_number((*layers)[2], 0)};
    }

    /// Empty for NaN, which means that there is none.
    std::optional<double> number_if_any(std::size_t column) const {
        const double value = csv.number(column);
        return std::isnan(value) ? std::nullopt : std::optional(value);
    }

    SessionTick tick() const {
        const TraceRow row = trace.read(csv);
        SessionTick result;
        Tick& tick = result.tick;
        tick.time = row.t;
        tick.proxy.status = static_cast<UpdateStatus>(
            code(status, static_cast<std::int64_t>(UpdateStatus::waiting)));
        tick.proxy.mode = row.constrained ? Mode::constrained : Mode::free;
        tick.proxy.hip = row.hip;
        tick.proxy.scp = row.scp;
        tick.proxy.density = row.density;
        tick.proxy.isovalue = row.isovalue;
        tick.proxy.tetrahedra = row.tetrahedra;
        tick.force = row.force;
        tick.force_flags = static_cast<std::uint16_t>(code(force_flags, 511));
        tick.update_ns = row.update_ns;
        result.device.status = static_cast<DeviceStatus>(
            code(device_status, static_cast<std::int64_t>(DeviceStatus::finished)));
        result.device.position = position.read(csv);
        result.device.buttons =
            static_cast<std::uint32_t>(code(buttons, std::numeric_limits<std::uint32_t>::max()));
        result.device.age = csv.number(age);
        if (opening) result.device.opening = number_if_any(*opening);
        for (int i = 0; i < 9; ++i) {
            result.device.orientation(i / 3, i % 3) = csv.number(tool[static_cast<std::size_t>(i)]);
        }
        result.frozen = code(frozen, 1) == 1;
        result.clutched = code(clutched, 1) == 1;
        if (moment) result.moment = csv.number(*moment);
        if (samples) {
            result.version = static_cast<std::uint64_t>(
                code(*samples, std::numeric_limits<std::int64_t>::max()));
        }
        if (layers) tick.layers = layers_felt();
        if (felt_tool) {
            tick.tool = {felt_tool->hand.read(csv), felt_tool->proxy.read(csv),
                         static_cast<int>(code(felt_tool->contacts, most_tool_contacts))};
            tick.torque = felt_tool->torque.read(csv);
        }
        return result;
    }
};

RecordingHead read_recording_head(const std::filesystem::path& path) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) return RecordingReader(path).head();
    std::ifstream file(path);
    std::string head, line;
    while (file.peek() == '#' && std::getline(file, line) && head.size() < longest_head) {
        head += std::string_view(line).substr(1);
        head += '\n';
    }
    // The complete reader reports a file that cannot be read, is no recording, or is too long.
    if (file.bad() || head.empty() || head.size() >= longest_head) {
        return RecordingReader(path).head();
    }
    try {
        return read_head(head, path.string()).hands.front();
    } catch (const InputError&) {
        return RecordingReader(path).head();
    }
}

RecordingReader::RecordingReader(const std::filesystem::path& path, int hand)
    : RecordingReader(read_text(path), path.string(), hand) {}

RecordingReader::RecordingReader(std::string text, const std::string& name, int hand) {
    // The head is checked first, so that another kind of table is refused as such and not for the
    // columns it lacks.
    std::string head;
    try {
        const CsvReader table(whole_lines(text), name, [&](std::string_view comment) {
            head += comment;
            head += '\n';
        });
    } catch (const InputError&) {
        if (!head.starts_with(recording_mark)) read_head(head, name);
        throw;
    }
    const auto [format, heads] = read_head(head, name);
    hands_ = static_cast<int>(heads.size());
    if (hand < 1 || hand > hands_) {
        throw InputError(name + ": has no hand " + std::to_string(hand) + ": there " +
                         (hands_ == 1 ? "is one" : "are " + std::to_string(hands_)));
    }
    head_ = heads[static_cast<std::size_t>(hand - 1)];
    rows_ = std::make_unique<Rows>(std::move(text), name, format, heads.size(), hand);
}

RecordingReader::~RecordingReader() = default;

std::optional<SessionEvent> RecordingReader::next() {
    while (rows_->waiting.empty() && rows_->csv.next()) {
        if (rows_->check_order() == rows_->hand) rows_->waiting.emplace_back(rows_->tick());
    }
    if (rows_->waiting.empty()) return std::nullopt;
    std::optional<SessionEvent> event(std::move(rows_->waiting.front()));
    rows_->waiting.pop_front();
    return event;
}

std::size_t RecordingReader::line() const {
    return rows_->csv.line();
}

double RecordingReader::progress() const {
    const auto size = static_cast<double>(rows_->text.size());
    return size > 0 ? 1 - static_cast<double>(rows_->csv.bytes_left()) / size : 1;
}

bool RecordingReader::complete() const {
    return rows_->complete;
}

std::optional<double> RecordingReader::begin() const {
    return rows_->begin;
}

bool RecordingReader::has_checksums() const {
    return rows_->crc32.has_value();
}

std::int64_t RecordingReader::lost() const {
    return rows_->lost;
}

}  // namespace palpate::io
