// Writes and reads traces and paths, with doubles that read back to the bit.
#include "palpate/io/trace.hpp"

#include <algorithm>
#include <array>

#include "io/recording/trace_columns.hpp"

namespace palpate::io {
namespace {

void write_comments(PendingFile& file, const std::vector<std::string>& comments) {
    for (std::string_view comment : comments) {
        for (;;) {
            const auto end = comment.find('\n');
            file.write("# ");
            file.write(comment.substr(0, end));
            file.write("\n");
            if (end == std::string_view::npos) break;
            comment.remove_prefix(end + 1);
        }
    }
}

/// A name as a bare word of a table: what would end a cell or join two names becomes _.
std::string word_of(const std::string& name) {
    std::string word = name;
    std::ranges::replace_if(
        word,
        [](char c) { return c == ',' || c == '+' || c == '"' || c == '#' || (c >= 0 && c < ' '); },
        '_');
    return word;
}

void append_layers(std::string& line, const LayersFelt& felt, const TraceExtras& extras) {
    const std::vector<std::string>& names = extras.layer_names;
    line += ',';
    if (felt.touched >= 0) line += word_of(names[static_cast<std::size_t>(felt.touched)]);
    std::string inside;
    const auto count = static_cast<std::size_t>(felt.inside);
    for (std::size_t i = count > extras.nested_layers ? count - 1 : 0; i < count; ++i) {
        inside += (inside.empty() ? "" : "+") + word_of(names[i]);
    }
    line += ',' + inside;
}

}  // namespace

TraceRow trace_row(const Tick& tick) {
    return {tick.time,
            tick.proxy.hip,
            tick.proxy.scp,
            tick.force,
            tick.proxy.density,
            tick.proxy.isovalue,
            tick.proxy.mode == Mode::constrained,
            tick.proxy.tetrahedra,
            tick.update_ns,
            tick.layers,
            tick.tool,
            tick.torque,
            tick.proxy.status == UpdateStatus::waiting,
            tick.proxy.level};
}

TraceWriter::TraceWriter(const std::filesystem::path& path,
                         const std::vector<std::string>& comments, TraceExtras extras)
    : file_(path), extras_(std::move(extras)) {
    write_comments(file_, comments);
    file_.write(trace_header);
    if (!extras_.layer_names.empty()) file_.write(",layer,inside");
    if (extras_.tool) file_.write(tool_header);
    if (extras_.streamed) file_.write(",waiting,level");
    file_.write("\n");
}

void TraceWriter::add(const TraceRow& row) {
    line_.clear();
    append_row(line_, row);
    if (!extras_.layer_names.empty()) append_layers(line_, row.layers, extras_);
    if (extras_.tool) append_tool(line_, row);
    if (extras_.streamed) {
        append_cell(line_, std::int64_t{row.waiting});
        append_cell(line_, std::int64_t{row.level});
    }
    line_ += '\n';
    file_.write(line_);
}

PathWriter::PathWriter(const std::filesystem::path& path, const std::vector<std::string>& comments)
    : file_(path) {
    write_comments(file_, comments);
    file_.write("tick,x,y,z\n");
}

void PathWriter::add(std::int64_t tick, const Vec3& corner) {
    line_.clear();
    append_cell(line_, tick);
    append_cells(line_, corner);
    line_ += '\n';
    file_.write(line_);
}

PosesWriter::PosesWriter(const std::filesystem::path& path) : file_(path) {
    file_.write("tick,x,y,z,qw,qx,qy,qz\n");
}

void PosesWriter::add(std::int64_t tick, const Pose& pose) {
    line_.clear();
    append_cell(line_, tick);
    append_cells(line_, pose.position);
    append_cells(line_, pose.orientation);
    line_ += '\n';
    file_.write(line_);
}

std::vector<TraceRow> parse_trace(std::string_view text, const std::string& name,
                                  TraceExtras* extras) {
    CsvReader rows(text, name);
    const TraceColumns columns(rows);
    std::optional<ToolColumns> tool;
    std::optional<LayerColumns> layers;
    if (rows.has_column("proxy_qw")) tool.emplace(rows);
    if (rows.has_column("layer") && rows.has_column("inside")) layers.emplace(rows);
    std::vector<TraceRow> trace;
    while (rows.next()) {
        trace.push_back(columns.read(rows));
        if (tool) tool->read(rows, trace.back());
        if (layers) trace.back().layers = layers->read(rows);
    }
    if (extras) {
        *extras = {.tool = tool.has_value()};
        if (layers) {
            extras->layer_names = layers->names;
            extras->nested_layers = layers->nested;
        }
    }
    return trace;
}

std::vector<TraceRow> read_trace(const std::filesystem::path& path, TraceExtras* extras) {
    return parse_trace(read_text(path), path.string(), extras);
}

ProxyPath read_proxy_path(const std::filesystem::path& path, const OnProgress& progress) {
    const std::string text = read_text(path, progress);
    CsvReader rows(text, path.string());
    const auto columns = [&](const std::string& before) {
        return std::array{rows.column(before + "x"), rows.column(before + "y"),
                          rows.column(before + "z")};
    };
    const bool trace = rows.has_column("scp_x");
    const auto scp = columns(trace ? "scp_" : "");
    const auto hip = trace ? columns("hip_") : scp;
    const std::size_t mode = trace ? rows.column("mode") : 0;
    const auto point = [&](const std::array<std::size_t, 3>& at) {
        return Vec3(rows.finite_number(at[0]), rows.finite_number(at[1]),
                    rows.finite_number(at[2]));
    };
    ProxyPath read;
    while (rows.next()) {
        read.scp.push_back(point(scp));
        read.constrained.push_back(!trace || rows.cell(mode) == "constrained");
        if (trace) read.hip.push_back(point(hip));
    }
    return read;
}

}  // namespace palpate::io
