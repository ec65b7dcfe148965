// Writes and finds the columns of a trace.
#include "io/recording/trace_columns.hpp"

#include <limits>

namespace palpate::io {
namespace {

bool read_mode(const CsvReader& rows, std::size_t column) {
    const std::string_view mode = rows.cell(column);
    if (mode != "free" && mode != "constrained") {
        rows.fail(io::quoted(mode) + " is no mode: it is 'free' or 'constrained'");
    }
    return mode == "constrained";
}

int read_count(const CsvReader& rows, std::size_t column) {
    const std::int64_t count = rows.integer(column);
    if (count < 0 || count > std::numeric_limits<int>::max()) {
        rows.fail(io::quoted(rows.cell(column)) + " is no count of tetrahedra: write one like 12");
    }
    return static_cast<int>(count);
}

}  // namespace

VectorColumns::VectorColumns(const CsvReader& rows, const std::string& name)
    : x(rows.column(name + "_x")), y(rows.column(name + "_y")), z(rows.column(name + "_z")) {}

Vec3 VectorColumns::read(const CsvReader& rows) const {
    return {rows.number(x), rows.number(y), rows.number(z)};
}

QuaternionColumns::QuaternionColumns(const CsvReader& rows, const std::string& prefix)
    : w(rows.column(prefix + "qw")),
      x(rows.column(prefix + "qx")),
      y(rows.column(prefix + "qy")),
      z(rows.column(prefix + "qz")) {}

Quaternion QuaternionColumns::read(const CsvReader& rows) const {
    return {rows.number(w), rows.number(x), rows.number(y), rows.number(z)};
}

void append_tool(std::string& text, const TraceRow& row) {
    append_cells(text, row.tool.hand);
    append_cells(text, row.tool.proxy);
    append_cells(text, row.torque);
    append_cell(text, std::int64_t{row.tool.contacts});
}

void append_row(std::string& text, const TraceRow& row) {
    append_cell(text, row.t);
    append_cells(text, row.hip);
    append_cells(text, row.scp);
    append_cells(text, row.force);
    append_cell(text, row.density);
    append_cell(text, row.isovalue);
    text += row.constrained ? ",constrained" : ",free";
    append_cell(text, std::int64_t{row.tetrahedra});
    append_cell(text, row.update_ns);
}

TraceColumns::TraceColumns(const CsvReader& rows)
    : t_(rows.column("t")),
      hip_(rows, "hip"),
      scp_(rows, "scp"),
      force_(rows, "force"),
      density_(rows.column("density")),
      isovalue_(rows.column("isovalue")),
      mode_(rows.column("mode")),
      tetrahedra_(rows.column("tetrahedra")),
      update_ns_(rows.column("update_ns")) {}

TraceRow TraceColumns::read(const CsvReader& rows) const {
    return {.t = rows.number(t_),
            .hip = hip_.read(rows),
            .scp = scp_.read(rows),
            .force = force_.read(rows),
            .density = rows.number(density_),
            .isovalue = rows.number(isovalue_),
            .constrained = read_mode(rows, mode_),
            .tetrahedra = read_count(rows, tetrahedra_),
            .update_ns = rows.integer(update_ns_)};
}

}  // namespace palpate::io
