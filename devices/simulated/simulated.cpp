// The device `simulated`: its options, the hand's trajectory, and a Device around the dynamics.
#include "devices/simulated/simulated.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "devices/link.hpp"
#include "devices/simulated/dynamics.hpp"
#include "devices/simulated/servo_ticks.hpp"
#include "devices/timed_path.hpp"
#include "palpate/io/trajectory.hpp"
#include "palpate/scenes/motions.hpp"

namespace palpate::devices {
namespace {

/// After a gap between two reads at most this much [s] is simulated; the rest is skipped, so that a
/// read after a stall does not itself cause the next stall.
constexpr double longest_simulated = 0.05;

const char* const usual_profile = "omni";

/// Options of the hand. Lengths are in device mm.
struct HandOptions {
    std::string motion = "explore";
    std::string file;
    double seconds = 30;
    double speed = 50;
    double depth = 4;
    int seed = 1;
    bool loop = false;
};

/// How the hand turns the handle: from straight to `angle` and, if it sways, back and so on.
struct TurnOptions {
    double angle = 0;  ///< [rad] 0: it keeps it straight
    double time = 1;   ///< [s] for one way
    std::string axis = "z";
    bool sways = false;
};

struct Choice {
    DeviceProfile device;
    std::string grip = "normal";
    HandGrip grip_numbers;
    HandOptions hand;
    TurnOptions turn;
};

/// The motions a hand can make, by the names used here.
std::vector<std::string> hand_names() {
    std::vector<std::string> names = scenes::motion_names();
    std::erase(names, "random");  // jumps about, which no hand does
    std::ranges::replace(names, "approach", "hold");
    return names;
}

constexpr double degree = std::numbers::pi / 180;

/// The rotational part of the profile, the grip and the hand.
void choose_rotation(Choice& choice, DeviceOptions& options, const DeviceChoice& given) {
    DeviceProfile& device = choice.device;
    if (!device.has_orientation) {
        for (const char* key :
             {"turn", "turn_time", "turn_axis", "sway", "angle_step", "torque_step", "hand_inertia",
              "hand_turn_damping", "hand_turn_stiffness"}) {
            if (!given.options.contains(key)) continue;
            throw std::invalid_argument("device " + given.name + ": " + key +
                                        "= has no meaning with profile=" + device.name +
                                        ", which measures no orientation");
        }
    }
    device.angle_step = degree * options.number("angle_step", device.angle_step / degree, 0, 5);
    device.torque_step = options.number("torque_step", device.torque_step, 0, 50);
    HandGrip& numbers = choice.grip_numbers;
    numbers.inertia = options.number("hand_inertia", numbers.inertia, 0, 1e4);
    numbers.rotational_damping =
        options.number("hand_turn_damping", numbers.rotational_damping, 0, 1e3);
    numbers.rotational_stiffness =
        options.number("hand_turn_stiffness", numbers.rotational_stiffness, 0, 1e5);
    TurnOptions& turn = choice.turn;
    turn.angle = degree * options.number("turn", 0, -170, 170);
    turn.time = options.number("turn_time", turn.time, 0.05, 3600);
    turn.axis = options.one_of("turn_axis", turn.axis, {"x", "y", "z"});
    turn.sways = options.flag("sway", turn.sways);
}

Choice choose(const DeviceChoice& given) {
    DeviceOptions options(given, "profile");
    Choice choice;
    choice.device = profile(options.one_of("profile", usual_profile, profile_names()));
    DeviceProfile& device = choice.device;
    if (!options.flag("friction", true)) device.friction = device.rotational_friction = 0;
    device.encoder_step = options.number("encoder", device.encoder_step, 0, 5);
    device.delay = 1e-3 * options.number("delay", 1e3 * device.delay, 0, 100);
    device.force_step = options.number("force_step", device.force_step, 0, 5);
    device.jitter = options.flag("jitter", device.jitter);

    choice.grip = options.one_of("grip", choice.grip, grip_names());
    HandGrip& numbers = choice.grip_numbers = grip(choice.grip);
    numbers.mass = options.number("hand_mass", numbers.mass, 0, 10);
    numbers.damping = options.number("hand_damping", numbers.damping, 0, 1);
    numbers.stiffness = options.number("hand_stiffness", numbers.stiffness, 0, 100);

    choose_rotation(choice, options, given);

    HandOptions& hand = choice.hand;
    hand.file = options.text("file", "");
    hand.loop = options.flag("loop", hand.loop);
    if (!hand.file.empty()) {
        for (const char* key : {"hand", "seconds", "speed", "depth", "seed"}) {
            if (!given.options.contains(key)) continue;
            throw std::invalid_argument("device " + given.name + ": " + key +
                                        "= has no meaning with file=: leave one of them out");
        }
    }
    hand.motion = options.one_of("hand", hand.motion, hand_names());
    hand.seconds = options.number("seconds", hand.seconds, 0.5, 3600);
    hand.speed = options.number("speed", hand.speed, 1, 1000);
    hand.depth = options.number("depth", hand.depth, 0, 50);
    hand.seed = options.whole_number("seed", hand.seed, 0, 1'000'000'000);
    options.finish();
    return choice;
}

TimedPath hand_path(const HandOptions& hand, const DeviceScene& scene,
                    const DeviceTransform& transform) {
    std::vector<double> time;
    std::vector<Vec3> position;
    if (!hand.file.empty()) {
        io::Trajectory read = io::read_trajectory(hand.file);
        time = std::move(read.time);
        position = std::move(read.position);
    } else {
        const std::string motion = hand.motion == "hold" ? "approach" : hand.motion;
        const auto samples = scenes::make_motion(motion, scene.field, scene.isovalue,
                                                 {.rate_hz = 1000,
                                                  .duration_s = hand.seconds,
                                                  .speed_mm_s = hand.speed * transform.scale,
                                                  .depth_mm = hand.depth * transform.scale,
                                                  .seed = static_cast<std::uint64_t>(hand.seed)});
        for (const scenes::HandSample& sample : samples) {
            time.push_back(sample.t);
            position.push_back(sample.position);
        }
    }
    for (Vec3& point : position) point = device_from_physical(transform, point);
    return {std::move(time), std::move(position)};
}

DeviceInfo info_of(const Choice& choice, double rate) {
    const DeviceProfile& device = choice.device;
    DeviceInfo info;
    info.name = "simulated";
    info.model = "simulated " + device.model + ", " + choice.grip + " grip";
    info.limits.maximum_force = device.maximum_force;
    info.limits.rate = rate;
    info.limits.delay = device.delay;
    if (device.jitter) info.limits.delay += exchange_delay(1 / ServoTicks::usual);
    info.limits.continuous_force = device.continuous_force;
    info.limits.physical_damping = device.damping + choice.grip_numbers.damping;
    if (device.has_orientation) {
        info.limits.maximum_torque = device.maximum_torque;
        info.limits.physical_rotational_damping =
            device.rotational_damping + choice.grip_numbers.rotational_damping;
    }
    info.has_orientation = device.has_orientation;
    info.renders_torque = device.maximum_torque > 0;
    info.stiffness = device.stiffness;
    info.workspace_low = device.workspace_low;
    info.workspace_high = device.workspace_high;
    return info;
}

/// Twice the wrenches that are under way at this rate.
std::size_t room_for(double delay, double rate) {
    rate = std::max(rate, ServoTicks::fastest);
    return 16 + static_cast<std::size_t>(2 * delay * std::min(1e5, rate));
}

class Simulated final : public Device {
  public:
    Simulated(const Choice& choice, const DeviceInfo& info, TimedPath path)
        : info_(info),
          device_(choice.device),
          path_(std::move(path)),
          loop_(choice.hand.loop),
          line_(device_.delay, longest_force, room_for(device_.delay, info.limits.rate)),
          ticks_(static_cast<std::uint64_t>(choice.hand.seed)),
          system_(hand_and_device(device_, choice.grip_numbers, path_.at(path_.begin()).position)),
          turn_(choice.turn),
          turn_axis_(Vec3::Unit(turn_.axis[0] - 'x')),
          turning_(turning_hand_and_device(device_, choice.grip_numbers, Quaternion::Identity())) {}

    DeviceInfo info() const override { return info_; }

    DeviceReading read(double time) noexcept override {
        if (std::isfinite(time)) {
            if (!started_) now_ = next_tick_ = time;
            started_ = true;
            if (time > now_) {
                pass(std::min(time, now_ + longest_simulated));
                now_ = time;
            }
            tick_if_due();
        }
        return device_.jitter ? link_.read(nanoseconds(now_)) : measured();
    }

    void write(const Wrench& wrench, double time) noexcept override {
        if (device_.jitter) return link_.write(wrench, nanoseconds(now_));
        line_.send(wrench, time);
    }

    void stop() noexcept override { stopped_.store(true, std::memory_order_relaxed); }

  private:
    static std::int64_t nanoseconds(double time) noexcept {
        return std::llround(1e9 * std::clamp(time, -9e9, 9e9));
    }

    DeviceReading measured() const noexcept {
        DeviceReading reading;
        reading.position = encoder_position(device_, system_.position);
        if (device_.has_orientation) {
            reading.orientation =
                encoder_orientation(device_, turning_.orientation).toRotationMatrix();
        }
        const bool finished = !loop_ && path_.begin() + script_time_ > path_.end();
        reading.status = finished ? DeviceStatus::finished : DeviceStatus::ready;
        return reading;
    }

    /// The work of the thread of a device with a servo of its own.
    void tick_if_due() noexcept {
        if (!device_.jitter || now_ < next_tick_) return;
        const std::int64_t now = nanoseconds(now_);
        link_.report(measured(), now);
        line_.send(link_.wrench(now), now_);
        next_tick_ = now_ + ticks_.next();
    }

    /// Lets the system move on to a time, from one change of the wrench, or tick, to the next.
    void pass(double end) noexcept {
        while (now_ < end) {
            const WrenchLine::Acting acting = line_.at(now_);
            double until = std::min(end, acting.until);
            if (device_.jitter) until = std::min(until, next_tick_);
            Wrench given;
            if (!stopped_.load(std::memory_order_relaxed)) {
                given = {motor_force(device_, acting.wrench.force),
                         motor_torque(device_, acting.wrench.torque)};
            }
            integrate(given, until - now_);
            now_ = until;
            tick_if_due();
        }
    }

    void integrate(const Wrench& motors, double duration) noexcept {
        // Less a rounding: a millisecond that came out of a difference is still 40 steps.
        const double wanted = duration / longest_step - 1e-6;
        const int steps = std::max(1, static_cast<int>(std::ceil(wanted)));
        const double dt = duration / steps;
        const double from = script_time_;
        for (int i = 1; i <= steps; ++i) {
            const TimedPath::Place target = target_at(from + i * dt);
            advance(system_, target.position, target.velocity, motors.force, dt);
            if (!device_.has_orientation) continue;
            const Turn turn = turn_at(from + i * dt);
            advance(turning_, turn.orientation, turn.velocity, motors.torque, dt);
        }
        script_time_ = from + duration;
    }

    TimedPath::Place target_at(double script_time) noexcept {
        if (!loop_) return path_.at(path_.begin() + script_time);
        const ThereAndBack turn = there_and_back(script_time, path_.end() - path_.begin());
        TimedPath::Place place = path_.at(path_.begin() + turn.time);
        place.velocity *= turn.direction;
        return place;
    }

    struct Turn {
        Quaternion orientation;
        Vec3 velocity;  // [rad/s]
    };
    /// Half a cosine for one way, so that the hand begins and ends at rest.
    Turn turn_at(double script_time) const noexcept {
        if (turn_.angle == 0) return {Quaternion::Identity(), Vec3::Zero()};
        const double done = script_time / turn_.time;
        const double phase = std::numbers::pi * (turn_.sways ? done : std::min(1.0, done));
        const double angle = turn_.angle * 0.5 * (1 - std::cos(phase));
        const double speed = turn_.angle * 0.5 * std::sin(phase) * std::numbers::pi / turn_.time;
        return {turned(Quaternion::Identity(), turn_axis_ * angle), turn_axis_ * speed};
    }

    const DeviceInfo info_;
    const DeviceProfile device_;
    TimedPath path_;
    const bool loop_;
    WrenchLine line_;
    Link link_;  // with jitter
    ServoTicks ticks_;
    double next_tick_ = 0;  // [s] of the session
    HandAndDevice system_;
    const TurnOptions turn_;
    const Vec3 turn_axis_;
    TurningHandAndDevice turning_;
    bool started_ = false;
    double now_ = 0;          // [s] of the session
    double script_time_ = 0;  // [s] since the first read, without what was skipped
    std::atomic<bool> stopped_{false};
};

/// KEY=OTHERWISE with what else may stand there.
std::string choice_of(const std::string& key, const std::string& otherwise,
                      const std::vector<std::string>& accepted) {
    std::string text;
    for (const std::string& name : accepted) text += (text.empty() ? "" : "|") + name;
    return key + "=" + otherwise + " (" + text + "), ";
}

}  // namespace

DeviceFinding find_simulated() {
    const Choice usual;
    return {.name = "simulated",
            .found = true,
            .what = "a haptic device and the hand that holds it, computed",
            .missing = "",
            .options = choice_of("profile", usual_profile, profile_names()) +
                       choice_of("hand", usual.hand.motion, hand_names()) +
                       choice_of("grip", usual.grip, grip_names()) +
                       "file=TRAJECTORY.csv instead of hand, loop=no, seconds=30, speed=50, "
                       "depth=4, seed=1, friction=yes, jitter=no (touch: yes); the profile's and "
                       "the grip's own: "
                       "encoder=MM, delay=MS, force_step=N, hand_mass=KG, "
                       "hand_damping=N_S_PER_MM, hand_stiffness=N_PER_MM; of a profile with "
                       "orientation: turn=DEG (0), turn_time=1, turn_axis=z (x|y|z), sway=no, "
                       "angle_step=DEG, torque_step=N_MM, hand_inertia=KG_MM2, "
                       "hand_turn_damping=N_MM_S, hand_turn_stiffness=N_MM"};
}

std::unique_ptr<Device> open_simulated(const DeviceChoice& given, const DeviceScene& scene) {
    const Choice choice = choose(given);
    const DeviceInfo info = info_of(choice, scene.rate);
    return std::make_unique<Simulated>(choice, info,
                                       hand_path(choice.hand, scene, scene.transform(info)));
}

}  // namespace palpate::devices
