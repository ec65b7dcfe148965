// The device `recorded`: opens the file and gives the hand's pose at a time.
#include "devices/recorded/recorded.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "devices/recorded/recording.hpp"
#include "devices/timed_path.hpp"

namespace palpate::devices {
namespace {

class Recorded final : public Device {
  public:
    Recorded(const DeviceInfo& info, Recording recording, double speed, bool loop)
        : info_(info),
          told_(std::move(recording.told)),
          orientation_(std::move(recording.orientation)),
          path_(std::move(recording.time), std::move(recording.position)),
          speed_(speed),
          loop_(loop) {
        std::uint32_t any = 0;
        for (const Told& told : told_) any |= told.buttons;
        info_.buttons = static_cast<int>(std::bit_width(any));
        info_.has_orientation = !orientation_.empty();
        info_.has_gripper =
            std::ranges::any_of(told_, [](const Told& told) { return told.opening.has_value(); });
    }

    DeviceInfo info() const override { return info_; }

    DeviceReading read(double time) noexcept override {
        if (std::isfinite(time)) {
            if (!started_) first_ = time;
            started_ = true;
            at_ = path_time(time);
        }
        const TimedPath::Place place = path_.at(at_);
        DeviceReading reading;
        reading.position = place.position;
        if (!orientation_.empty()) reading.orientation = orientation_[place.row];
        const Told told = told_.empty() ? Told{} : told_[place.row];
        reading.buttons = told.buttons;
        reading.age = told.age;
        reading.opening = told.opening;
        reading.status = at_ > path_.end() ? DeviceStatus::finished : told.status;
        return reading;
    }

    void write(const Wrench& /*wrench*/, double /*time*/) noexcept override {}
    void stop() noexcept override {}

  private:
    double path_time(double time) const noexcept {
        if (loop_) {
            const double passed = std::max(0.0, (time - first_) * speed_);
            return path_.begin() + there_and_back(passed, path_.end() - path_.begin()).time;
        }
        // A session with the clock of the recording gets its rows bit for bit: subtracting and
        // adding the smaller of two times again undoes the rounding of the difference.
        return path_.begin() + (time - first_) * speed_;
    }

    DeviceInfo info_;
    std::vector<Told> told_;
    std::vector<Mat3> orientation_;
    TimedPath path_;
    const double speed_;
    const bool loop_;
    bool started_ = false;
    double first_ = 0;  // [s] of the session, at the first read
    double at_ = 0;     // [s] of the path
};

}  // namespace

DeviceFinding find_recorded() {
    return {.name = "recorded",
            .found = true,
            .what = "a trajectory or a recording (CSV), played back; ignores forces",
            .missing = "",
            .options = "file=FILE.csv,speed=1,loop=no,hand=1"};
}

std::unique_ptr<Device> open_recorded(const DeviceChoice& choice, const DeviceScene& scene) {
    DeviceOptions options(choice, "file");
    const std::string file = options.text("file", "");
    const double speed = options.number("speed", 1, 0.01, 100);
    const bool loop = options.flag("loop", false);
    const int hand = static_cast<int>(options.number("hand", 1, 1, 1000));
    options.finish();
    if (file.empty()) {
        throw std::invalid_argument("device " + choice.name + ": file= is needed: write " +
                                    choice.name + ":FILE.csv");
    }
    DeviceInfo info;
    info.name = "recorded";
    info.model = "recording " + file;
    // No force can do harm here, so none is limited: N, N s/mm.
    info.limits = {.maximum_force = 1000, .rate = scene.rate, .physical_damping = 1};
    return std::make_unique<Recorded>(
        info, read_recording(file, scene.transform(info), hand, scene.progress), speed, loop);
}

}  // namespace palpate::devices
