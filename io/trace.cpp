// Traces and paths: the columns of the contract, and nothing that a reader could round.
#include "io/trace.hpp"

#include <limits>

#include "io/csv.hpp"
#include "io/number.hpp"

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

template <class T>
void append_cell(std::string& line, T value) {
    if (!line.empty()) line += ',';
    append_number(line, value);
}

void append_cells(std::string& line, const Vec3& v) {
    for (int a = 0; a < 3; ++a) append_cell(line, v[a]);
}

struct VectorColumns {
    std::size_t x, y, z;

    VectorColumns(const CsvReader& rows, const std::string& name)
        : x(rows.column(name + "_x")), y(rows.column(name + "_y")), z(rows.column(name + "_z")) {}

    Vec3 read(const CsvReader& rows) const {
        return {rows.number(x), rows.number(y), rows.number(z)};
    }
};

bool read_mode(const CsvReader& rows, std::size_t column) {
    const std::string_view mode = rows.cell(column);
    if (mode != "free" && mode != "constrained") {
        rows.fail(quoted(mode) + " is no mode: it is 'free' or 'constrained'");
    }
    return mode == "constrained";
}

int read_count(const CsvReader& rows, std::size_t column) {
    const std::int64_t count = rows.integer(column);
    if (count < 0 || count > std::numeric_limits<int>::max()) {
        rows.fail(quoted(rows.cell(column)) + " is no count of tetrahedra: write one like 12");
    }
    return static_cast<int>(count);
}

}  // namespace

TraceWriter::TraceWriter(const std::filesystem::path& path,
                         const std::vector<std::string>& comments)
    : file_(path) {
    write_comments(file_, comments);
    file_.write(
        "t,hip_x,hip_y,hip_z,scp_x,scp_y,scp_z,force_x,force_y,force_z,"
        "density,isovalue,mode,tetrahedra,update_ns\n");
}

void TraceWriter::add(const TraceRow& row) {
    line_.clear();
    append_cell(line_, row.t);
    append_cells(line_, row.hip);
    append_cells(line_, row.scp);
    append_cells(line_, row.force);
    append_cell(line_, row.density);
    append_cell(line_, row.isovalue);
    line_ += row.constrained ? ",constrained" : ",free";
    append_cell(line_, std::int64_t{row.tetrahedra});
    append_cell(line_, row.update_ns);
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

std::vector<TraceRow> parse_trace(std::string_view text, const std::string& name) {
    CsvReader rows(text, name);
    const std::size_t t = rows.column("t");
    const VectorColumns hip(rows, "hip");
    const VectorColumns scp(rows, "scp");
    const VectorColumns force(rows, "force");
    const std::size_t density = rows.column("density");
    const std::size_t isovalue = rows.column("isovalue");
    const std::size_t mode = rows.column("mode");
    const std::size_t tetrahedra = rows.column("tetrahedra");
    const std::size_t update_ns = rows.column("update_ns");

    std::vector<TraceRow> trace;
    while (rows.next()) {
        trace.push_back({.t = rows.number(t),
                         .hip = hip.read(rows),
                         .scp = scp.read(rows),
                         .force = force.read(rows),
                         .density = rows.number(density),
                         .isovalue = rows.number(isovalue),
                         .constrained = read_mode(rows, mode),
                         .tetrahedra = read_count(rows, tetrahedra),
                         .update_ns = rows.integer(update_ns)});
    }
    return trace;
}

std::vector<TraceRow> read_trace(const std::filesystem::path& path) {
    return parse_trace(read_text(path), path.string());
}

}  // namespace palpate::io
