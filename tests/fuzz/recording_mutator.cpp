// Mutates recordings event by event, then makes tick numbers, checksums and the last line right
// again, as the recorder would have written them.
#include "fuzz/mutation.hpp"
#include "io/recording/recording_head.hpp"

namespace {

using namespace palpate;
using namespace palpate::fuzz;
using Lines = std::vector<std::string>;

/// Commands to begin with; their values are mutated after.
constexpr const char* commands[] = {
    R"({"isovalue":{"value":1.5}})",
    R"({"freeze":{"on":true}})",
    R"({"clutch":{"on":true}})",
    R"({"forces":{"on":false}})",
    R"({"scale":{"scale":2.0}})",
    R"({"friction":{"static":0.4,"dynamic":0.3}})",
    R"({"force":{"stiffness":0.5,"viscosity":0.001,"limit":1.0}})",
    R"({"penetrability":{"on":true,"threshold":0.5,"range_count":1,"range_1":{"low":0.0,"high":2.0}}})",
    R"({"limits":{"maximum_force":1.0,"rate":1000.0,"physical_damping":0.0055}})",
    R"({"transform":{"rotation":[[1,0,0],[0,1,0],[0,0,1]],"translation":[0,0,0],"scale":1.0}})",
    R"({"samples":{"version":1,"of":0,"edit":{"fill":{"low":[0,0,0],"high":[1,1,1],"value":2.0}}}})",
    R"({"moment":{"time":0.5}})",
    R"({"speed":{"speed":1.0}})",
};

const std::string command_begin = "#" + std::string(io::command_mark);
const std::string end_begin = "#" + std::string(io::end_mark);

bool is_comment(const std::string& line) {
    return line.starts_with('#');
}

/// The line of the table's header: the first that is no comment.
std::size_t header_of(const Lines& lines) {
    return std::size_t(std::find_if_not(lines.begin(), lines.end(), &is_comment) - lines.begin());
}

/// The head's JSON, which stays one.
void mutate_head(Lines& lines, std::size_t header, Random& random) {
    std::string text;
    for (std::size_t i = 1; i < header; ++i) text += lines[i].substr(1);
    if (!mutate_json_text(text, random)) return;
    lines.erase(lines.begin() + 1, lines.begin() + std::ptrdiff_t(header));
    lines.insert(lines.begin() + 1, "# " + text);
}

void mutate_cell(std::string& row, Random& random) {
    const std::size_t chosen = random() % std::size_t(1 + std::ranges::count(row, ','));
    std::size_t begin = 0;
    for (std::size_t i = 0; i < chosen; ++i) begin = row.find(',', begin) + 1;
    const std::size_t length = std::min(row.find(',', begin), row.size()) - begin;
    row.replace(begin, length, other_number(row.substr(begin, length), random));
}

void mutate_event(Lines& lines, std::size_t header, Random& random) {
    const std::size_t at = header + 1 + random() % (lines.size() - header - 1);
    const auto line = lines.begin() + std::ptrdiff_t(at);
    if (one_in(random, 6)) {
        lines.insert(line, command_begin + one_of(commands, random));
    } else if (one_in(random, 12)) {
        lines.erase(line);
    } else if (one_in(random, 8)) {
        lines.insert(line, std::string(lines[header + 1 + random() % (lines.size() - header - 1)]));
    } else if (line->starts_with(command_begin)) {
        std::string text = line->substr(command_begin.size());
        if (mutate_json_text(text, random)) *line = command_begin + text;
    } else if (!is_comment(*line)) {
        mutate_cell(*line, random);
    }
}

/// The row with its number and the checksum up to it; the columns are the last two.
void repair_row(std::string& row, std::int64_t tick, std::uint32_t& checksum) {
    for (int i = 0; i < 2; ++i) row.resize(std::min(row.rfind(','), row.size()));
    row += ',' + std::to_string(tick);
    checksum = io::checksum_with(row, checksum);
    row += ',' + std::to_string(checksum);
}

void repair(Lines& lines, std::size_t header) {
    if (!lines[header].ends_with(",tick,crc32")) return;
    std::int64_t ticks = 0;
    std::uint32_t checksum = 0;
    for (std::size_t i = header + 1; i < lines.size(); ++i) {
        std::string& line = lines[i];
        if (line.starts_with(command_begin)) {
            checksum = io::checksum_with(line, checksum);
        } else if (line.starts_with(end_begin)) {
            line = end_begin + "{\"ticks\":" + std::to_string(ticks) +
                   ",\"lost\":0,\"crc32\":" + std::to_string(checksum) + "}";
        } else if (!is_comment(line)) {
            repair_row(line, ticks++, checksum);
        }
    }
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
    Random random(seed + 1);
    Lines lines = lines_of({reinterpret_cast<const char*>(data), size});
    std::size_t header = header_of(lines);
    if (header < 2 || header + 1 >= lines.size() || one_in(random, 10)) {
        return LLVMFuzzerMutate(data, size, most);
    }
    if (one_in(random, 4)) {
        mutate_head(lines, header, random);
        header = header_of(lines);
    } else {
        mutate_event(lines, header, random);
    }
    if (!one_in(random, 20)) repair(lines, header);
    return put_lines(lines, data, most);
}
