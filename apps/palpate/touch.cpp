// palpate touch: a live session. palpate record: the same, for its recording.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <memory>
#include <thread>

#include "apps/live/data_in_hand.hpp"
#include "apps/live/touch_options.hpp"
#include "apps/palpate/commands.hpp"
#include "apps/palpate/errands.hpp"
#include "apps/palpate/live_commands.hpp"
#include "apps/palpate/live_status.hpp"
#include "apps/palpate/outputs.hpp"
#include "apps/palpate/progress.hpp"
#include "apps/palpate/terminal.hpp"
#include "apps/palpate/window.hpp"
#include "palpate/devices/last_resort.hpp"

namespace palpate::app {
namespace {

using namespace std::chrono_literals;

/// Looks after a running session from outside: words, keys, the line on the terminal.
class Attendant {
  public:
    Attendant(Servo& servo, LiveScene& scene, DataInHand& data,
              const io::RecordingWriter* recording, const TouchOptions& options,
              std::vector<TimedRequest> requests, LiveCommands& commands)
        : servo_(servo),
          scene_(scene),
          data_(data),
          errands_(data),
          recording_(recording),
          options_(options),
          requests_(std::move(requests)),
          commands_(commands),
          line_(!options.volume.quiet && ::isatty(STDERR_FILENO)) {
        if (keys_.available() && !options.volume.quiet) note(LiveCommands::key_help());
    }
    ~Attendant() {
        if (line_) std::fputs("\r\033[K", stderr);
    }

    /// One round, every 10 ms; false once the session is to end.
    bool attend() {
        const auto now = servo_.snapshot();
        if (!now) return true;
        if (!ask(*now)) return false;
        if (const auto key = keys_.next()) {
            const auto request = commands_.from_key(*key, *now);
            if (request && !obey(*request, *now)) return false;
        }
        ++rounds_;
        tell();
        watch_device(now->session.device.status);
        watch_recording();
        watch_data();
        if (line_ && rounds_ % 20 == 0) {
            fmt::print(stderr, "\r\033[K{}",
                       status_line(*now, servo_.report(), terminal_columns() - 1));
        }
        const bool over = options_.seconds > 0 && now->session.tick.time >= options_.seconds;
        return !over && now->session.device.status != DeviceStatus::finished;
    }

    /// Waits for what was asked for, but for Ctrl-C. Why a volume could not be written, if one
    /// could not.
    std::string finish() {
        if (!interrupted()) errands_.finish();
        tell();
        return errands_.unsaved();
    }

  private:
    void note(const std::string& text) const {
        fmt::print(stderr, "{}{}\n", line_ ? "\r\033[K" : "", text);
    }

    /// Carries out what has become due.
    bool ask(const Snapshot& now) {
        while (next_ < requests_.size() && requests_[next_].time <= now.session.tick.time) {
            if (!obey(requests_[next_].request, now)) return false;
            ++next_;
        }
        return true;
    }

    bool obey(const Request& request, const Snapshot& now) {
        if (std::holds_alternative<Quit>(request)) return false;
        if (std::holds_alternative<Help>(request)) {
            note(LiveCommands::key_help());
            return true;
        }
        try {
            if (const auto* data = std::get_if<DataRequest>(&request)) {
                errands_.put(*data, now);
            } else if (!servo_.send(std::get<Command>(request))) {
                note("too many commands at once: one was left out");
            }
        } catch (const std::invalid_argument& e) {
            note(e.what());
        }
        return true;
    }

    /// Tells when the device's status changes, and what is wrong with it when that does.
    void watch_device(DeviceStatus status) {
        const bool changed = status_ != status;
        if (!changed && rounds_ % 50 != 0) return;
        const std::string problem = scene_.device->problem();
        if (!changed && problem == problem_) return;
        status_ = status;
        problem_ = problem;
        if (options_.volume.quiet || status == DeviceStatus::finished) return;
        note(fmt::format("device {}: {}{}{}", scene_.info.name, name_of(status),
                         problem.empty() ? "" : ": ", problem));
    }

    void tell() {
        for (const Errands::Word& word : errands_.words()) {
            if (word.is_problem || !options_.volume.quiet) note(word.text);
        }
    }

    void watch_recording() {
        if (!recording_ || recording_told_ || rounds_ % 50 != 0) return;
        const std::string problem = recording_->problem();
        if (problem.empty()) return;
        recording_told_ = true;
        note("palpate: " + problem);
    }

    void watch_data() {
        if (rounds_ % 25 != 0) return;
        const std::string problem =
            data_.is_sequence() ? data_.player().view().problem : data_.sculptor().work().problem;
        if (std::exchange(data_problem_, problem) == problem || problem.empty()) return;
        note("palpate: " + problem);
    }

    Servo& servo_;
    LiveScene& scene_;
    DataInHand& data_;
    Errands errands_;
    const io::RecordingWriter* recording_;
    const TouchOptions& options_;
    std::vector<TimedRequest> requests_;
    std::size_t next_ = 0;
    LiveCommands& commands_;
    Keys keys_;
    std::optional<DeviceStatus> status_;
    std::string problem_;  // of the device, as told
    bool recording_told_ = false;
    std::string data_problem_;
    bool line_;
    int rounds_ = 0;
};

void announce(const Servo& servo, const LiveScene& scene, bool quiet) {
    if (quiet) return;
    const RendererSettings& settings = servo.settings();
    const std::string force =
        scene.info.renders_force
            ? fmt::format("at most {} N, {} N/mm",
                          std::min(settings.force.limit, settings.device.maximum_force),
                          settings.force.stiffness)
            : "position only, no force";
    fmt::print(stderr, "isovalue {}\ndevice {} ({}): {}; 1 mm of hand is {:.3g} mm of the volume\n",
               scene.isovalue, scene.info.name, scene.info.model, force, settings.transform.scale);
    for (const std::string& sentence : servo.privileges()) fmt::print(stderr, "{}\n", sentence);
}

/// The brush that --brush asks for.
void take_up_brush(const TouchOptions& options, LiveCommands& commands, DataInHand& data) {
    const Request request = commands.from_words("brush " + options.brush);
    const auto& asked = std::get<ask::SetBrush>(std::get<DataRequest>(request));
    data.sculptor().set_brush(asked.brush);
}

/// Those who change the data know the servo as long as this lives.
class Attachment {
  public:
    Attachment(DataInHand& data, Servo& servo) : data_(data) { data_.attach(&servo); }
    ~Attachment() { data_.attach(nullptr); }
    Attachment(const Attachment&) = delete;
    Attachment& operator=(const Attachment&) = delete;

  private:
    DataInHand& data_;
};

void print_report(const ServoReport& report, double seconds, const DeviceInfo& device,
                  const TouchOptions& options) {
    if (options.json) {
        fmt::print("{}", report_json(report, seconds, device.name + " (" + device.model + ")"));
    } else if (!options.volume.quiet) {
        fmt::print("{}", report_text(report, seconds));
    }
}

/// What --save asks for; or a word about edits that are lost.
void save_at_end(DataInHand& data, const TouchOptions& options) {
    if (!options.save.empty()) {
        // After Ctrl-C as well: then without a bar, which would give it up.
        std::string saved;
        {
            ProgressBar bar("saving", options.volume.quiet || interrupted());
            saved = data.save(options.save, [&](double fraction) {
                if (!interrupted()) bar.at(fraction);
            });
        }
        if (!options.volume.quiet) fmt::print(options.json ? stderr : stdout, "{}\n", saved);
    } else if (!data.is_sequence() && data.sculptor().work().changed && !options.volume.quiet) {
        fmt::print(stderr, "the edits were not saved (--save FILE, or the command save FILE)\n");
    }
}

std::unique_ptr<io::RecordingWriter> recording_of(const LiveScene& scene, const DataInHand& data,
                                                  const TouchOptions& options) {
    if (options.record.empty()) return nullptr;
    auto recording = std::make_unique<io::RecordingWriter>(
        options.record, recording_head(scene.session, scene.info, options));
    tell(*recording, data.history());
    if (scene.loaded.live && !options.volume.quiet) {
        fmt::print(stderr,
                   "note: what a live source pushes is not recorded: the recording can be plotted, "
                   "not rendered again\n");
    }
    return recording;
}

void require_no_mouse(const TouchOptions& options) {
    if (devices::parse_device(options.device).name != "mouse") return;
    throw devices::DeviceError(
        "device mouse: there is no window to move it in (--headless, --json, --seconds and "
        "--commands have none, nor has a machine without a display); palpate devices lists "
        "others");
}

void touch(const TouchOptions& options) {
    check_outputs({options.volume.volume, options.commands}, {options.record, options.save});
    require_no_mouse(options);
    LiveScene scene = make_scene(load_for_terminal(options.volume), options);
    if (!options.save.empty()) check_volume_name(options.save, scene.field.volume().geometry());
    LiveCommands commands(scene.field, scene.isovalue, scene.session.renderer.settings);
    std::vector<TimedRequest> requests;
    if (!options.commands.empty()) requests = read_commands(options.commands, commands);
    DataInHand data(scene.loaded, scene.field, options.loader());
    if (data.is_sequence()) data.player().play(options.playback);
    if (!options.brush.empty()) take_up_brush(options, commands, data);
    data.bring(scene.session);
    const auto recording = recording_of(scene, data, options);
    const devices::LastResort last_resort(*scene.device);
    Servo servo(std::move(scene.session), *scene.device,
                {.rate = options.render.rate,
                 .real_time = !options.normal_priority,
                 .recorder = recording ? &recording->queue() : nullptr});
    // Stopped in the middle, the program could not let go. Ctrl-Z does nothing while it runs.
    std::signal(SIGTSTP, SIG_IGN);
    servo.start();
    announce(servo, scene, options.volume.quiet);
    const auto begin = std::chrono::steady_clock::now();
    std::string unsaved;
    {
        const Attachment attachment(data, servo);
        Attendant attendant(servo, scene, data, recording.get(), options, std::move(requests),
                            commands);
        while (!interrupted() && attendant.attend()) std::this_thread::sleep_for(10ms);
        servo.stop();  // first of all: an edit under way may take seconds
        unsaved = attendant.finish();
    }
    scene.device->stop();
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    const ServoReport report = servo.report();
    print_report(report, seconds, scene.info, options);
    save_at_end(data, options);
    if (recording) {
        recording->finish(report.unrecorded);
        if (!options.json && !options.volume.quiet) {
            fmt::print("recorded {} ticks in {}\n", recording->ticks(), options.record);
        }
    }
    if (!unsaved.empty()) throw io::OutputError(unsaved);
    stop_if_interrupted();
}

/// Scripts and terminals without a display get no window.
bool wants_window(const TouchOptions& options, bool headless) {
    const bool script = options.json || options.seconds > 0 || !options.commands.empty() ||
                        !options.brush.empty() || !options.save.empty();
    return !headless && !script && has_display() && !viewer_program().empty();
}

void add_session(CLI::App& app, const char* name, const char* what, bool is_record,
                 const Words& words, const char* example) {
    struct Options : TouchOptions {
        bool headless = false;
    };
    auto options = std::make_shared<Options>();
    CLI::App* command = app.add_subcommand(name, what);
    command->footer(fmt::format(
        "Without --device a simulated hand explores the volume. Forces begin at zero, when the "
        "wanted one is small, and end at zero,\nwhatever ends the session. With a terminal, keys "
        "work while it runs (? lists them).\n\nExample:\n  {}",
        example));
    options->add_to(*command, is_record ? TouchOptions::For::record : TouchOptions::For::touch);
    if (!is_record) {
        command->add_flag("--headless", options->headless,
                          "No window, even where there is a display; so too with --json, "
                          "--seconds, --commands");
    }
    command->callback([options, command, words, is_record] {
        options->finish(*command);
        if (!is_record && wants_window(*options, options->headless)) become_viewer(words);
        touch(*options);
    });
}

}  // namespace

void add_touch(CLI::App& app, const Words& words) {
    add_session(app, "touch", "Feel a volume live, through a haptic device", false, words,
                "palpate touch head.nrrd --isovalue 500 --device haply --record session.csv");
}

void add_record(CLI::App& app) {
    add_session(app, "record", "Feel a volume live and record the session", true, {},
                "palpate record head.nrrd --isovalue 500 --device haply --output session.csv");
}

}  // namespace palpate::app
