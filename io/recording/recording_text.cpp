// Lines of recordings (docs/recordings.md).
#include "io/recording/recording_text.hpp"

#include <limits>

#include "io/recording/trace_columns.hpp"

namespace palpate::io {
namespace {

constexpr std::string_view session_columns =
    ",status,force_flags,device_status,device_x,device_y,device_z,buttons,age,"
    "tool_xx,tool_xy,tool_xz,tool_yx,tool_yy,tool_yz,tool_zx,tool_zy,tool_zz,frozen,clutched,"
    "moment,samples,layer_touched,layers_inside,layers_punctured,opening";
constexpr std::string_view hand_column = ",hand";
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
    append_cell(text, tick.device.opening.value_or(std::numeric_limits<double>::quiet_NaN()));
    append_tool(text, trace_row(tick.tick));
}

std::string head_text(std::span<const RecordingHead> heads) {
    const bool has_several = heads.size() > 1;
    std::string text = "#";
    text += recording_mark;
    append_number(text, std::int64_t{has_several ? recording_format : format_of_one_hand});
    text += "\n# ";
    // A name that is not UTF-8 must not prevent a recording.
    for (const char c : to_json(heads).dump(1, ' ', true, Json::error_handler_t::replace)) {
        text += c;
        if (c == '\n') text += "# ";
    }
    text += '\n';
    text += trace_header;
    text += session_columns;
    text += tool_header;
    if (has_several) text += hand_column;
    text += check_columns;
    return text + '\n';
}

}  // namespace

RecordingText::RecordingText(std::span<const RecordingHead> heads)
    : lines(head_text(heads)), hands_(heads.size()) {}

void RecordingText::append(const SessionTick& tick, int hand) {
    const std::size_t begin = lines.size();
    append_session(lines, tick);
    if (has_several()) append_cell(lines, std::int64_t{hand});
    auto& ticks = hands_[static_cast<std::size_t>(hand - 1)].ticks;
    append_cell(lines, ticks.fetch_add(1, std::memory_order_relaxed));
    checksum_ = checksum_with(std::string_view(lines).substr(begin), checksum_);
    append_cell(lines, std::int64_t{checksum_});
    lines += '\n';
}

void RecordingText::append(const Command& command, int hand) {
    const std::size_t begin = lines.size();
    Json json = to_json(command, hands_[static_cast<std::size_t>(hand - 1)].bodies);
    if (has_several()) json["hand"] = hand;
    lines += "#";
    lines += command_mark;
    lines += json.dump();
    checksum_ = checksum_with(std::string_view(lines).substr(begin), checksum_);
    lines += '\n';
}

void RecordingText::end(std::int64_t lost, std::span<const double> begins) {
    std::int64_t ticks = 0;
    for (const Hand& hand : hands_) ticks += hand.ticks.load(std::memory_order_relaxed);
    lines += "#";
    lines += end_mark;
    Json end{{"ticks", ticks}, {"lost", lost}, {"crc32", checksum_}};
    if (has_several() && !begins.empty()) end["begins"] = begins;
    lines += end.dump() + "\n";
}

}  // namespace palpate::io
