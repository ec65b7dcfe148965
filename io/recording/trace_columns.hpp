// The columns of a trace, written and read. Private to io/; traces and recordings are made of them.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/system/number.hpp"
#include "palpate/io/csv.hpp"
#include "palpate/io/trace.hpp"

namespace palpate::io {

inline constexpr std::string_view trace_header =
    "t,hip_x,hip_y,hip_z,scp_x,scp_y,scp_z,force_x,force_y,force_z,"
    "density,isovalue,mode,tetrahedra,update_ns";

/// What a trace of a tool has more: how the hand and the proxy are turned, torque, contacts.
inline constexpr std::string_view tool_header =
    ",qw,qx,qy,qz,proxy_qw,proxy_qx,proxy_qy,proxy_qz,torque_x,torque_y,torque_z,contacts";

template <class T>
void append_cell(std::string& line, T value) {
    if (!line.empty() && line.back() != '\n') line += ',';
    append_number(line, value);
}

inline void append_cells(std::string& line, const Vec3& v) {
    for (int a = 0; a < 3; ++a) append_cell(line, v[a]);
}

inline void append_cells(std::string& line, const Quaternion& q) {
    for (const double part : {q.w(), q.x(), q.y(), q.z()}) append_cell(line, part);
}

/// Appends the cells of a row, without the end of the line: those of trace_header.
void append_row(std::string& text, const TraceRow& row);
/// Appends the cells of tool_header.
void append_tool(std::string& text, const TraceRow& row);

/// Columns NAME_x, NAME_y, NAME_z.
struct VectorColumns {
    std::size_t x, y, z;

    VectorColumns(const CsvReader& rows, const std::string& name);
    Vec3 read(const CsvReader& rows) const;
};

/// Columns PREFIXqw, PREFIXqx, PREFIXqy, PREFIXqz.
struct QuaternionColumns {
    std::size_t w, x, y, z;

    QuaternionColumns(const CsvReader& rows, const std::string& prefix);
    /// As it stands, unit or not.
    Quaternion read(const CsvReader& rows) const;
};

/// The places of the columns of tool_header in a table.
struct ToolColumns {
    QuaternionColumns hand, proxy;
    VectorColumns torque;
    std::size_t contacts;

    explicit ToolColumns(const CsvReader& rows);
    void read(const CsvReader& rows, TraceRow& row) const;
};

/// The places of `layer` and `inside` in a table, and the layers that they name.
struct LayerColumns {
    std::size_t touched, inside;
    std::vector<std::string> names;
    std::size_t nested = 0;

    /// Reads all rows, from the header on, for the names.
    explicit LayerColumns(CsvReader rows);
    LayersFelt read(const CsvReader& rows) const;
};

/// The places of a trace's columns in a table. Throws InputError if one is missing.
struct TraceColumns {
    explicit TraceColumns(const CsvReader& rows);
    TraceRow read(const CsvReader& rows) const;

  private:
    std::size_t t_;
    VectorColumns hip_, scp_, force_;
    std::size_t density_, isovalue_, mode_, tetrahedra_, update_ns_;
};

}  // namespace palpate::io
