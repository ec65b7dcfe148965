// palpate_soak: the live loop for minutes, with a simulated hand, a viewer, commands and a
// recording. Reports whether timing and memory stay constant and whether the recording replays bit
// for bit. How to run and read it: docs/results/soak.md.
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "benchmarks/soak_meter.hpp"
#include "benchmarks/soak_recording.hpp"
#include "palpate/devices/devices.hpp"
#include "palpate/io/recording.hpp"
#include "palpate/io/volume_file.hpp"
#include "palpate/scenes/volumes.hpp"
#include "palpate/servo.hpp"

namespace palpate::benchmarks {
namespace {

using namespace std::chrono_literals;
using SteadyClock = std::chrono::steady_clock;

constexpr double target_us = 20;      // of p99.9 of the compute time
constexpr double settled_after = 60;  // [s] from then on memory must be flat
constexpr std::int64_t most_growth_kb = 4096;
constexpr auto between_frames = 16'667us;
constexpr auto between_commands = 50ms;

struct Options {
    std::string volume = "synthetic:shepp-logan";
    double isovalue = std::nan("");
    double seconds = 600;
    double rate = 1000;
    double every = 10;
    std::string csv = "soak.csv";
    std::string record;
    bool fast_reader = false;
    std::vector<std::string> without;  // viewer, commands, recording

    bool has(const char* part) const { return std::ranges::count(without, part) == 0; }
};

/// A volume, the level to feel, and the field made of them.
struct Scene {
    Volume volume;
    double isovalue;
    Field field;
};

Scene make_scene(const Options& options) {
    std::optional<double> isovalue;
    if (!std::isnan(options.isovalue)) isovalue = options.isovalue;
    const auto with = [&](Volume volume) {
        if (!isovalue) throw std::invalid_argument("--isovalue is needed for a file");
        Field field = linear_field(volume);
        return Scene{std::move(volume), *isovalue, std::move(field)};
    };
    if (options.volume.starts_with("synthetic:")) {
        scenes::Scene scene = scenes::make_volume(options.volume);
        if (!isovalue) isovalue = scene.isovalue;
        return with(std::move(scene.volume));
    }
    io::ReadOptions read;
#ifdef PALPATE_IO_HELPER
    read.helper = PALPATE_IO_HELPER;
#endif
    return with(io::read_volume(options.volume, read).volume);
}

/// The machine's figures about this program and about itself.
struct Usage {
    std::int64_t resident_kb = 0, major_faults = 0;
    double load = 0;  ///< programs that want to run, mean of the last minute
};

Usage usage() {
    Usage usage;
    std::int64_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages >> pages;
    usage.resident_kb = pages * (::sysconf(_SC_PAGESIZE) / 1024);
    rusage of_self{};
    ::getrusage(RUSAGE_SELF, &of_self);
    usage.major_faults = of_self.ru_majflt;
    std::ifstream("/proc/loadavg") >> usage.load;
    return usage;
}

/// Viewers and someone at the panel, on threads of their own.
class Company {
  public:
    Company(Servo& servo, const Scene& scene, const Options& options)
        : servo_(servo),
          isovalue_(scene.isovalue),
          range_(scene.volume.maximum() - scene.volume.minimum()) {
        if (options.has("viewer")) {
            threads_.emplace_back(
                [this](const std::stop_token& stop) { view(stop, between_frames); });
        }
        if (options.fast_reader) {
            threads_.emplace_back([this](const std::stop_token& stop) { view(stop, 0us); });
        }
        if (options.has("commands")) {
            threads_.emplace_back([this](const std::stop_token& stop) { command(stop); });
        }
    }
    void leave() { threads_.clear(); }

    std::int64_t seen() const { return seen_; }
    std::int64_t went_back() const { return went_back_; }
    std::int64_t sent() const { return sent_; }
    std::int64_t refused() const { return refused_; }

  private:
    void view(const std::stop_token& stop, std::chrono::microseconds period) {
        std::int64_t last = -1;
        for (auto next = SteadyClock::now(); !stop.stop_requested(); next += period) {
            std::this_thread::sleep_until(next);
            const auto snapshot = servo_.snapshot();
            if (!snapshot) continue;
            ++seen_;
            went_back_ += snapshot->number < last;
            last = snapshot->number;
        }
    }

    void command(const std::stop_token& stop) {
        auto next = SteadyClock::now();
        for (int i = 0; !stop.stop_requested(); ++i) {
            std::this_thread::sleep_until(next += between_commands);
            (servo_.send(nth(i)) ? sent_ : refused_) += 1;
        }
    }

    /// All kinds in turn; frozen for a twentieth of a second every two.
    Command nth(int i) const {
        // A scale is about the SCP, wherever that is: without this the volume would drift away.
        if (i % 200 == 100) return servo_.settings().transform;
        if (i % 40 >= 38) return command::Freeze{i % 40 == 38};
        const int round = i / 5;
        ForceSettings force = servo_.settings().force;
        const double friction = 0.2 * (round % 3);
        switch (i % 5) {
            case 0:
                return command::Isovalue{isovalue_ + 0.01 * range_ * (round % 4)};
            case 1:
                force.stiffness *= 1 - 0.25 * (round % 3);
                return force;
            case 2:
                return round % 4 == 3 ? penetrability_threshold(3, isovalue_) : no_penetrability();
            case 3:
                return command::Scale{servo_.settings().transform.scale *
                                      (1 + 0.1 * (round % 3 - 1))};
            default:
                return Friction{friction, 0.5 * friction};
        }
    }

    Servo& servo_;
    const double isovalue_, range_;
    std::atomic<std::int64_t> seen_{0}, went_back_{0}, sent_{0}, refused_{0};
    std::vector<std::jthread> threads_;  // last: they use all of the above
};

/// A row every interval: what happened in it, and the servo's own percentiles from the start.
class Table {
  public:
    Table(const Options& options, const Meter& meter) : every_(options.every), meter_(meter) {
        file_.open(options.csv);
        file_ << "seconds,ticks,missed,resident_kb,major_faults,load,snapshots,commands,"
                 "lateness_p50_ns,lateness_p99_ns,lateness_p999_ns,lateness_max_ns,"
                 "cpu_p50_ns,cpu_p99_ns,cpu_p999_ns,cpu_max_ns,"
                 "compute_p50_ns,compute_p99_ns,compute_p999_ns,compute_max_ns\n";
        if (!file_) throw io::OutputError(options.csv + ": cannot be written");
    }

    /// Writes the rows of the intervals that are over at this time of the session [s].
    void write(double time, const Servo& servo, const Company& company) {
        while (time >= every_ * static_cast<double>(rows_ + 1)) row(servo, company);
    }

    std::int64_t growth_kb() const { return most_kb_ - settled_kb_; }
    /// Whether there was any row after memory had settled.
    bool judged() const { return judged_; }

  private:
    void row(const Servo& servo, const Company& company) {
        const Usage now = usage();
        const ServoReport report = servo.report();
        const auto& interval = meter_.interval(rows_);
        const double seconds = every_ * static_cast<double>(++rows_);
        file_ << fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", seconds,
                             report.ticks - before_.ticks, report.missed - before_.missed,
                             now.resident_kb, now.major_faults, now.load, company.seen(),
                             company.sent(), cells(interval.lateness.summary()),
                             cells(interval.cpu.summary()), cells(report.compute))
              << std::flush;
        before_ = report;
        if (seconds < settled_after) return;
        judged_ = settled_kb_ > 0;
        if (!judged_) settled_kb_ = now.resident_kb;
        most_kb_ = std::max(most_kb_, now.resident_kb);
    }
    static std::string cells(const LatencySummary& s) {
        return fmt::format("{},{},{},{}", s.p50, s.p99, s.p999, s.max);
    }

    const double every_;
    const Meter& meter_;
    std::ofstream file_;
    std::size_t rows_ = 0;
    ServoReport before_;
    std::int64_t settled_kb_ = 0, most_kb_ = 0;
    bool judged_ = false;
};

/// The session that `palpate touch` would begin, and the device for it.
struct Live {
    std::unique_ptr<Device> device;
    Session session;
};

Live make_live(const Scene& scene, double rate) {
    const auto transform = [&](const DeviceInfo& info) {
        return fit_workspace(scene.field.geometry(), info);
    };
    auto device = devices::open_device(devices::parse_device("simulated:loop=yes"),
                                       {scene.field, scene.isovalue, rate, transform});
    const DeviceInfo info = device->info();
    RendererSettings settings;
    settings.device = info.limits;
    settings.force.limit = info.limits.maximum_force;
    settings.force.stiffness = std::min(settings.force.stiffness, info.stiffness);
    settings.force.start_below = 0.3;
    settings.proxy.step_budget =
        static_cast<int>(settings.proxy.step_budget * std::min(1.0, 1000 / rate));
    settings.transform = transform(info);
    return {std::move(device), {make_renderer(scene.field, scene.isovalue, settings), {}}};
}

io::RecordingHead head_of(const Scene& scene, const Live& live, const Options& options) {
    io::RecordingHead head;
    head.version = "palpate_soak";
    head.volume = io::identify(scene.volume, {{"volume", options.volume}});
    head.solid = scene.field.solid();
    head.background = scene.field.background();
    head.isovalue = scene.isovalue;
    head.device = live.device->info().model;
    head.rate = options.rate;
    head.method = "exact";
    head.settings = live.session.renderer.settings;
    head.session = live.session.settings;
    return head;
}

std::string four(const LatencySummary& s) {
    const auto us = [](std::int64_t ns) { return 1e-3 * static_cast<double>(ns); };
    return fmt::format("p50 {:.1f}, p99 {:.1f}, p99.9 {:.1f}, max {:.1f} us", us(s.p50), us(s.p99),
                       us(s.p999), us(s.max));
}

void print(const ServoReport& r) {
    fmt::print(
        "ticks {}, missed deadlines {}, forces cancelled {}, events lost {}\n"
        "compute time (ours)    {}\n"
        "lateness (the machine) {}\n"
        "work (wall clock)      {}\n"
        "period                 {}\n"
        "worst tick {}: {:.3f} ms late, {:.3f} ms of work, {:.3f} ms computing; mostly {}\n"
        "target, p99.9 of the compute time under {} us: {}\n",
        r.ticks, r.missed, r.overruns, r.unrecorded, four(r.compute), four(r.lateness),
        four(r.work), four(r.period), r.worst.tick, 1e-6 * static_cast<double>(r.worst.lateness_ns),
        1e-6 * static_cast<double>(r.worst.work_ns), 1e-6 * static_cast<double>(r.worst.compute_ns),
        name_of(r.worst.cause), target_us,
        1e-3 * static_cast<double>(r.compute.p999) < target_us ? "held" : "not held");
}

/// Runs the loop; gives what went wrong, a sentence each.
std::vector<std::string> soak(const Options& options, const Scene& scene,
                              const std::filesystem::path& recording) {
    Live live = make_live(scene, options.rate);
    Meter meter(*live.device, options.rate, options.every, options.seconds);
    Table table(options, meter);
    std::unique_ptr<io::RecordingWriter> writer;
    if (options.has("recording")) {
        writer = std::make_unique<io::RecordingWriter>(recording, head_of(scene, live, options));
    }
    const Usage begin = usage();
    Servo servo(std::move(live.session), meter,
                {.rate = options.rate, .recorder = writer ? &writer->queue() : nullptr});
    servo.start();
    for (const std::string& sentence : servo.privileges()) fmt::print("{}\n", sentence);
    Company company(servo, scene, options);
    for (double time = 0; time < options.seconds;) {
        std::this_thread::sleep_for(50ms);
        if (const auto now = servo.snapshot()) time = now->session.tick.time;
        table.write(time, servo, company);
    }
    company.leave();
    servo.stop();
    const ServoReport report = servo.report();
    if (writer) writer->finish(report.unrecorded);

    print(report);
    const Usage end = usage();
    fmt::print(
        "resident memory {} kB, grown by {} kB after the first minute; major page faults {}\n"
        "snapshots {}, commands {}, load of the machine {} to {}\n",
        end.resident_kb, table.judged() ? std::to_string(table.growth_kb()) : "(too short)",
        end.major_faults - begin.major_faults, company.seen(), company.sent(), begin.load,
        end.load);
    std::vector<std::string> problems;
    if (report.unrecorded > 0) problems.push_back(fmt::format("{} lost", report.unrecorded));
    if (company.refused() > 0) problems.push_back(fmt::format("{} refused", company.refused()));
    if (company.went_back() > 0) problems.emplace_back("snapshots went back");
    if (table.judged() && table.growth_kb() > most_growth_kb) {
        problems.push_back(fmt::format("memory grew by {} kB", table.growth_kb()));
    }
    if (writer && writer->ticks() != report.ticks) problems.emplace_back("ticks are missing");
    return problems;
}

int run(const Options& options) {
    const Scene scene = make_scene(options);
    const std::filesystem::path recording = options.record.empty()
                                                ? std::filesystem::temp_directory_path() /
                                                      fmt::format("palpate-soak-{}.csv", ::getpid())
                                                : std::filesystem::path(options.record);
    std::vector<std::string> problems = soak(options, scene, recording);
    if (options.has("recording")) {
        const ReadBack r = read_back(recording, scene.field);
        fmt::print(
            "recording: {} ticks, {} commands, {:.1f} MB; in contact {}, with force {}, at "
            "most {:.2f} N; rendered again: {}\n"
            "its proxy updates as they ran        {}\n"
            "its ticks rendered again, best of {} {}\n",
            r.ticks, r.commands, 1e-6 * static_cast<double>(std::filesystem::file_size(recording)),
            r.in_contact, r.with_force, r.largest_force,
            r.problem.empty() ? "the same bit for bit" : "NOT the same", four(r.update),
            ReadBack::repeats, four(r.again));
        if (!r.problem.empty()) problems.push_back(r.problem);
        if (r.with_force == 0) problems.emplace_back("the hand never felt anything");
        if (options.record.empty() && problems.empty()) std::filesystem::remove(recording);
    }
    for (const std::string& problem : problems) fmt::print("FAILED: {}\n", problem);
    return problems.empty() ? 0 : 1;
}

}  // namespace
}  // namespace palpate::benchmarks

int main(int argc, char** argv) {
    palpate::benchmarks::Options options;
    CLI::App app("The live loop for minutes: does it keep its time and its memory?");
    app.add_option("VOLUME", options.volume, "File or synthetic:NAME")->capture_default_str();
    app.add_option("-i,--isovalue", options.isovalue, "Level to feel; files need it");
    app.add_option("--seconds", options.seconds, "How long")
        ->check(CLI::Range(1.0, 1e6))
        ->capture_default_str();
    app.add_option("--rate", options.rate, "[Hz]")->check(CLI::Range(250, 8000));
    app.add_option("--every", options.every, "Seconds between two rows of the table")
        ->check(CLI::Range(0.5, 1e4))
        ->capture_default_str();
    app.add_option("--csv", options.csv, "Table to write")->capture_default_str();
    app.add_option(
        "--record", options.record,
        "Recording to write and keep (default: a temporary one, kept if all is not well)");
    app.add_flag("--fast-reader", options.fast_reader, "A second reader that never rests");
    app.add_option("--without", options.without, "Leave these out: viewer, commands, recording")
        ->delimiter(',')
        ->check(CLI::IsMember({"viewer", "commands", "recording"}));
    CLI11_PARSE(app, argc, argv);
    try {
        return palpate::benchmarks::run(options);
    } catch (const std::exception& e) {
        fmt::print(stderr, "palpate_soak: {}\n", e.what());
        return 2;
    }
}
