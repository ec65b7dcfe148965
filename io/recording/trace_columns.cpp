// Writes and finds the columns of a trace.
#include "io/recording/trace_columns.hpp"

#include <algorithm>
#include <limits>
#include <span>

namespace palpate::io {
namespace {

bool read_mode(const CsvReader& rows, std::size_t column) {
    const std::string_view mode = rows.cell(column);
    if (mode != "free" && mode != "constrained") {
        rows.fail(io::quoted(mode) + " is no mode: it is 'free' or 'constrained'");
    }
    return mode == "constrained";
}

int read_count(const CsvReader& rows, std::size_t column, const std::string& of) {
    const std::int64_t count = rows.integer(column);
    if (count < 0 || count > std::numeric_limits<int>::max()) {
        rows.fail(io::quoted(rows.cell(column)) + " is no count of " + of + ": write one like 12");
    }
    return static_cast<int>(count);
}

constexpr const char* too_many =
    "more than 16 layers are named in the columns 'layer' and 'inside'";
static_assert(Layers::most_layers == 16);

std::vector<std::string> joined_by_plus(std::string_view cell) {
    std::vector<std::string> names;
    while (!cell.empty()) {
        const auto end = std::min(cell.find('+'), cell.size());
        names.emplace_back(cell.substr(0, end));
        cell.remove_prefix(std::min(end + 1, cell.size()));
    }
    return names;
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

ToolColumns::ToolColumns(const CsvReader& rows)
    : hand(rows, ""),
      proxy(rows, "proxy_"),
      torque(rows, "torque"),
      contacts(rows.column("contacts")) {}

void ToolColumns::read(const CsvReader& rows, TraceRow& row) const {
    row.tool.hand = hand.read(rows);
    row.tool.proxy = proxy.read(rows);
    row.torque = torque.read(rows);
    row.tool.contacts = read_count(rows, contacts, "contacts");
}

LayerColumns::LayerColumns(CsvReader rows)
    : touched(rows.column("layer")), inside(rows.column("inside")) {
    std::vector<std::string> seen;
    while (rows.next()) {
        const std::string_view cell = rows.cell(inside);
        if (cell.find('+') != std::string_view::npos) {
            auto list = joined_by_plus(cell);
            if (list.size() > names.size()) names = std::move(list);
        }
        for (const std::string_view name : {cell, rows.cell(touched)}) {
            if (name.empty() || name.find('+') != std::string_view::npos) continue;
            if (std::ranges::find(seen, name) == seen.end()) seen.emplace_back(name);
        }
        if (std::max(names.size(), seen.size()) > Layers::most_layers) rows.fail(too_many);
    }
    nested = names.size();
    for (const std::string& name : seen) {
        if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
    if (names.size() > Layers::most_layers) rows.fail(too_many);
}

LayersFelt LayerColumns::read(const CsvReader& rows) const {
    LayersFelt felt;
    const std::string_view layer = rows.cell(touched);
    if (!layer.empty()) {
        felt.touched = static_cast<std::int8_t>(std::ranges::find(names, layer) - names.begin());
    }
    const std::vector<std::string> list = joined_by_plus(rows.cell(inside));
    if (list.empty()) return felt;
    const auto last = std::ranges::find(names, list.back()) - names.begin();
    felt.inside = static_cast<std::int8_t>(last + 1);
    const bool is_nested = static_cast<std::size_t>(last) < nested;
    if (is_nested ? !std::ranges::equal(list, std::span(names).first(list.size()))
                  : list.size() != 1) {
        rows.fail(io::quoted(rows.cell(inside)) +
                  " in column 'inside' does not name the layers from the outermost one on");
    }
    return felt;
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
            .tetrahedra = read_count(rows, tetrahedra_, "tetrahedra"),
            .update_ns = rows.integer(update_ns_)};
}

}  // namespace palpate::io
