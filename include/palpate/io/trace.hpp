// Traces and paths as CSV. A trace has one row per tick of a replay or a run; a path has the
// corners of the polyline along which the SCP moved. Doubles read back bit for bit.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/io/csv.hpp"
#include "palpate/io/error.hpp"
#include "palpate/io/output.hpp"
#include "palpate/renderer.hpp"

namespace palpate::io {

/// One tick.
struct TraceRow {
    double t = 0;                ///< [s]
    Vec3 hip = Vec3::Zero();     ///< [mm, physical]
    Vec3 scp = Vec3::Zero();     ///< [mm, physical]
    Vec3 force = Vec3::Zero();   ///< [N]
    double density = 0;          ///< f(SCP) [data units]
    double isovalue = 0;         ///< [data units]
    bool constrained = false;    ///< mode: constrained or free
    int tetrahedra = 0;          ///< number of tetrahedra that the SCP moved through
    std::int64_t update_ns = 0;  ///< time of this proxy update alone
    LayersFelt layers = {};      ///< of a session without layers: none
    ToolFelt tool = {};          ///< of a point: nothing turns
    Vec3 torque = Vec3::Zero();  ///< [N mm]
    bool waiting = false;        ///< held, because samples are not in memory
    int level = 0;               ///< of detail of the samples at the SCP
};

TraceRow trace_row(const Tick& tick);

/// Columns that a trace has only in some sessions.
struct TraceExtras {
    /// `layer` (the touched one) and `inside` (those that contain the SCP, outermost first, joined
    /// by +; _ replaces characters that would break a table). Empty: neither.
    std::vector<std::string> layer_names = {};
    /// The number of layers, from the first on, that are levels, which are nested. The others are
    /// labels, and the SCP is in one of them at a time.
    std::size_t nested_layers = 0;
    /// `qw` to `qz` (hand), `proxy_qw` to `proxy_qz`, `torque_x` to `torque_z`, `contacts`.
    bool tool = false;
    /// `waiting` (1 where the proxy was held because samples were not in memory) and `level`.
    bool streamed = false;
};

/// Writes a trace row by row; the file appears with commit(). Throws OutputError.
class TraceWriter {
  public:
    /// Each comment, at the head of the file, is one or more lines of text without the #.
    explicit TraceWriter(const std::filesystem::path& path,
                         const std::vector<std::string>& comments = {}, TraceExtras extras = {});
    void add(const TraceRow& row);
    void commit() { file_.commit(); }
    /// For PendingFile::commit_together().
    PendingFile& file() { return file_; }

  private:
    PendingFile file_;
    TraceExtras extras_;
    std::string line_;
};

/// Writes a path: columns tick, x, y, z [mm, physical]. Throws OutputError.
class PathWriter {
  public:
    explicit PathWriter(const std::filesystem::path& path,
                        const std::vector<std::string>& comments = {});
    /// The corners of a tick in order, its end included.
    void add(std::int64_t tick, const Vec3& corner);
    void commit() { file_.commit(); }
    /// For PendingFile::commit_together().
    PendingFile& file() { return file_; }

  private:
    PendingFile file_;
    std::string line_;
};

/// Writes the poses of a tool's proxy: columns tick, x, y, z [mm, physical], qw, qx, qy, qz (tool
/// axes to physical axes). Throws OutputError.
class PosesWriter {
  public:
    explicit PosesWriter(const std::filesystem::path& path);
    /// The poses of a tick in order, its end included: between two successive ones each point of
    /// the tool travels a straight line.
    void add(std::int64_t tick, const Pose& pose);
    /// For PendingFile::commit_together().
    PendingFile& file() { return file_; }

  private:
    PendingFile file_;
    std::string line_;
};

/// Reads a trace back; columns are found by name, further ones are ignored, and none of the
/// format's may be missing. NaN and infinity are read as they were written. Throws InputError.
/// Columns of a tool and of layers are read if they exist, and `extras` describes them. Its layers
/// are those that occur in the file: the nested ones, then the others as they come.
std::vector<TraceRow> read_trace(const std::filesystem::path& path, TraceExtras* extras = nullptr);
/// The same from text that errors call `name`.
std::vector<TraceRow> parse_trace(std::string_view text, const std::string& name,
                                  TraceExtras* extras = nullptr);

/// Positions of hand and proxy, point by point.
struct ProxyPath {
    std::vector<Vec3> hip;  ///< [mm, physical] a tick each; empty if it came from a path file
    std::vector<Vec3> scp;  ///< [mm, physical] a tick each, or the corners of a path file
    std::vector<bool> constrained;  ///< of each `scp`; true throughout for a path file
};
/// From a trace, or from a path (columns x, y, z). Throws InputError, also for points that are not
/// finite. `progress`: as for read_text().
ProxyPath read_proxy_path(const std::filesystem::path& path, const OnProgress& progress = {});

}  // namespace palpate::io
