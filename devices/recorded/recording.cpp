// Reads the columns that a device needs by name; recordings have more, and other versions others.
#include "devices/recorded/recording.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "io/system/number.hpp"
#include "palpate/io/csv.hpp"
#include "palpate/io/recording.hpp"
#include "palpate/io/trajectory.hpp"

namespace palpate::devices {
namespace {

std::optional<std::size_t> column_if_any(const io::CsvReader& rows, const std::string& name) {
    if (!rows.has_column(name)) return std::nullopt;
    return rows.column(name);
}

/// The columns of a recording that came from the device.
class DeviceColumns {
  public:
    explicit DeviceColumns(const io::CsvReader& rows)
        : time_(rows.column("t")),
          x_(rows.column("device_x")),
          y_(rows.column("device_y")),
          z_(rows.column("device_z")),
          status_(column_if_any(rows, "device_status")),
          buttons_(column_if_any(rows, "buttons")),
          age_(column_if_any(rows, "age")),
          opening_(column_if_any(rows, "opening")),
          hand_(column_if_any(rows, "hand")) {
        if (!rows.has_column("tool_xx")) return;
        for (const char r : {'x', 'y', 'z'}) {
            for (const char c : {'x', 'y', 'z'}) {
                tool_.push_back(rows.column(std::string("tool_") + r + c));
            }
        }
    }

    /// Whose row it is; without the column the only hand's.
    std::int64_t hand(const io::CsvReader& rows) const { return hand_ ? rows.integer(*hand_) : 1; }
    double time(const io::CsvReader& rows, const std::vector<double>& before) const {
        const double time = rows.finite_number(time_);
        if (before.empty() || time > before.back()) return time;
        std::string last;
        io::append_number(last, before.back());
        rows.fail("the time " + io::quoted(rows.cell(time_)) + " does not come after " + last +
                  ", that of the row before: sort the rows and remove doubles");
    }
    /// As the device reported it, NaN included: a replay has to show what the session made of it.
    Vec3 position(const io::CsvReader& rows) const {
        return {rows.number(x_), rows.number(y_), rows.number(z_)};
    }
    Told told(const io::CsvReader& rows) const {
        constexpr auto last = static_cast<std::uint32_t>(DeviceStatus::finished);
        constexpr auto ready = static_cast<std::uint32_t>(DeviceStatus::ready);
        Told told;
        told.status = static_cast<DeviceStatus>(code(rows, status_, ready, last));
        told.buttons = code(rows, buttons_, 0, std::numeric_limits<std::uint32_t>::max());
        if (age_) told.age = rows.number(*age_);
        const double opening = opening_ ? rows.number(*opening_) : not_there;
        if (!std::isnan(opening)) told.opening = opening;
        return told;
    }
    bool has_tool() const { return !tool_.empty(); }
    Mat3 tool(const io::CsvReader& rows) const {
        Mat3 tool;
        for (int i = 0; i < 9; ++i) {
            tool(i / 3, i % 3) = rows.number(tool_[static_cast<std::size_t>(i)]);
        }
        return tool;
    }

  private:
    static std::uint32_t code(const io::CsvReader& rows, std::optional<std::size_t> column,
                              std::uint32_t otherwise, std::uint32_t most) {
        if (!column) return otherwise;
        const std::int64_t value = rows.integer(*column);
        if (value >= 0 && value <= most) return static_cast<std::uint32_t>(value);
        rows.fail(io::quoted(rows.cell(*column)) + " is out of range: 0 to " +
                  std::to_string(most));
    }

    std::size_t time_, x_, y_, z_;
    std::optional<std::size_t> status_, buttons_, age_, opening_, hand_;
    static constexpr double not_there = std::numeric_limits<double>::quiet_NaN();
    std::vector<std::size_t> tool_;
};

Recording raw_recording(const std::string& text, const std::string& name, int hand) {
    io::CsvReader rows(io::whole_lines(text), name);
    const DeviceColumns columns(rows);
    Recording recording;
    while (rows.next()) {
        if (columns.hand(rows) != hand) continue;
        recording.time.push_back(columns.time(rows, recording.time));
        recording.position.push_back(columns.position(rows));
        recording.told.push_back(columns.told(rows));
        if (columns.has_tool()) recording.orientation.push_back(columns.tool(rows));
    }
    if (recording.time.empty()) {
        const std::string whose = hand == 1 ? "" : " of hand " + std::to_string(hand);
        throw io::InputError(name + ": has a header and no rows" + whose +
                             ": add at least one position");
    }
    const bool turned = std::ranges::any_of(
        recording.orientation, [](const Mat3& tool) { return tool != Mat3::Identity(); });
    if (!turned) recording.orientation = {};
    return recording;
}

/// Converts what a device reported into what a device with another transform would have reported,
/// so that the hand moves equally through the volume. Nothing changes for equal transforms.
void move_from(const DeviceTransform& recorded, const DeviceTransform& now, Recording& recording) {
    if (recorded.rotation == now.rotation && recorded.translation == now.translation &&
        recorded.scale == now.scale) {
        return;
    }
    for (Vec3& position : recording.position) {
        position = device_from_physical(now, physical_from_device(recorded, position));
    }
    const Mat3 turn = now.rotation.transpose() * recorded.rotation;
    for (Mat3& tool : recording.orientation) tool = turn * tool;
}

}  // namespace

Recording read_recording(const std::string& file, const DeviceTransform& transform, int hand,
                         const OnProgress& progress) {
    std::string text = io::read_text(file, progress);
    if (io::CsvReader(text, file).has_column("device_x")) {
        Recording recording = raw_recording(text, file, hand);
        if (text.starts_with("# palpate recording")) {
            const io::RecordingReader reader(std::move(text), file, hand);
            move_from(reader.head().settings.transform, transform, recording);
        }
        return recording;
    }
    if (hand != 1) throw io::InputError(file + ": is a trajectory, which has one hand");
    io::Trajectory trajectory = io::parse_trajectory(text, file);
    for (Vec3& point : trajectory.position) point = device_from_physical(transform, point);
    return {std::move(trajectory.time), std::move(trajectory.position), {}, {}};
}

}  // namespace palpate::devices
