// palpate touch: a live run. palpate record: the same, always recorded.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "apps/options/no_effect.hpp"
#include "apps/options/run_options.hpp"
#include "apps/options/say.hpp"
#include "apps/palpate/commands.hpp"
#include "apps/palpate/live_commands.hpp"
#include "apps/palpate/live_status.hpp"
#include "apps/palpate/outputs.hpp"
#include "apps/palpate/progress.hpp"
#include "apps/palpate/remote.hpp"
#include "apps/palpate/request_queue.hpp"
#include "apps/palpate/terminal.hpp"
#include "apps/palpate/window.hpp"
#include "palpate/run/run.hpp"

namespace palpate::app {
namespace {

using namespace std::chrono_literals;

struct TouchOptions : RunOptions {
    bool headless = false;
    std::string igtl, igtl_connect;
};

/// What became of a request.
enum class Obeyed : std::uint8_t { yes, no_room, quit };

/// The terminal of a run: commands from a file, keys, the status line.
class Terminal {
  public:
    /// `remote` may be null.
    Terminal(run::Run& run, const RunOptions& options, std::vector<TimedRequest> requests,
             LiveCommands& commands, Remote* remote)
        : run_(run),
          remote_(remote),
          device_name_(run.device().name),
          options_(options),
          requests_(std::move(requests)),
          commands_(commands),
          line_(!options.source.quiet && ::isatty(STDERR_FILENO)) {
        if (keys_.available() && !options.source.quiet) note(LiveCommands::key_help());
    }
    ~Terminal() {
        if (line_) std::fputs("\r\033[K", stderr);
    }

    /// One round, every 10 ms of the session; false once the run is to end.
    bool update() {
        if (run_.device_failure() != DeviceFailure::none) return false;
        const auto now = run_.snapshot();
        if (!now) return true;
        if (!obey_due(*now) || !serve(*now)) return false;
        if (const auto key = keys_.next()) {
            const auto request = commands_.from_key(*key, *now);
            const Obeyed obeyed = request ? obey(*request, *now) : Obeyed::yes;
            if (obeyed == Obeyed::quit) return false;
            if (obeyed == Obeyed::no_room) note("too many commands at once: one was left out");
        }
        ++rounds_;
        print_messages();
        watch_device(now->session.device.status);
        watch_files();
        if (line_ && rounds_ % 20 == 0) {
            say("\r\033[K{}", status_line(*now, run_.settings().layers.get(), run_.report(),
                                          terminal_columns() - 1));
        }
        if (options_.unpaced) queue_.finish();  // what was asked for takes no time of the session
        const bool over = options_.seconds > 0 && now->session.tick.time >= options_.seconds;
        return !over && now->session.device.status != DeviceStatus::finished;
    }

    /// Waits for the requests so far, except after Ctrl-C. Returns why a volume could not be
    /// written; empty if all could.
    std::string finish() {
        queue_.finish();
        queue_.end();  // after Ctrl-C a volume may still be written, or fail to be
        print_messages();
        tell_what_was_left_out();
        return queue_.unsaved();
    }

  private:
    void note(const std::string& text) const { say("{}{}\n", line_ ? "\r\033[K" : "", text); }

    bool is_due(std::size_t i, const Snapshot& now) const {
        return i < requests_.size() && requests_[i].time <= now.session.tick.time;
    }

    /// Carries out the requests that are due, as far as there is room: the others wait for the next
    /// rounds, in their order. False for one to end.
    bool obey_due(const Snapshot& now) {
        for (; is_due(next_, now); ++next_) {
            const bool ends = std::holds_alternative<Quit>(requests_[next_].request);
            if (ends && run_.waiting() > 0) return true;  // first what came before
            const Obeyed obeyed = obey(requests_[next_].request, now);
            if (obeyed == Obeyed::quit) return false;
            if (obeyed == Obeyed::no_room) {
                tell_that_some_wait(now);
                return true;
            }
        }
        return true;
    }

    /// What others asked for; false for another volume.
    bool serve(const Snapshot& now) {
        if (!remote_) return true;
        for (const std::string& text : remote_->notes()) note(text);
        return remote_->serve(run_, now, commands_, queue_,
                              [&](const Request& request) { carry_out(request, now); });
    }

    /// Throws std::invalid_argument, and run::QueueFull.
    void carry_out(const Request& request, const Snapshot& now) {
        const Overloaded how{
            [](Quit) {},
            [&](Help) { note(LiveCommands::key_help()); },
            [&](const DataRequest& data) {
                const double isovalue = now.session.tick.proxy.isovalue;
                queue_.put([this, data, isovalue](const std::stop_token& stop) {
                    return data(run_.data(), run_.field_now(), isovalue, stop);
                });
            },
            [&](const Command& command) { run_.send(command); },
        };
        std::visit(how, request);
    }

    Obeyed obey(const Request& request, const Snapshot& now) {
        try {
            carry_out(request, now);
        } catch (const run::QueueFull&) {
            return Obeyed::no_room;
        } catch (const std::invalid_argument& e) {
            note(e.what());
        }
        return std::holds_alternative<Quit>(request) ? Obeyed::quit : Obeyed::yes;
    }

    /// Once, however many rounds they wait.
    void tell_that_some_wait(const Snapshot& now) {
        if (std::exchange(wait_told_, true)) return;
        std::size_t end = next_;
        while (is_due(end, now)) ++end;
        const std::int64_t count = static_cast<std::int64_t>(end - next_) + run_.waiting();
        note(fmt::format(
            "{} commands are due, more than fit into one tick: carried out in order, late", count));
    }

    /// After the end. Those that were not due yet were not to be carried out.
    void tell_what_was_left_out() const {
        std::int64_t count = run_.waiting();
        const auto now = run_.snapshot();
        const bool quits =
            next_ < requests_.size() && std::holds_alternative<Quit>(requests_[next_].request);
        for (std::size_t i = next_; now && !quits && is_due(i, *now); ++i) ++count;
        if (count == 0) return;
        note(fmt::format("{} commands that were due were not carried out before the end", count));
    }

    /// Reports when the status of the device changes, or its problem.
    void watch_device(DeviceStatus status) {
        const bool changed = status_ != status;
        if (!changed && rounds_ % 50 != 0) return;
        const std::string problem = run_.device_problem();
        if (!changed && problem == problem_) return;
        status_ = status;
        problem_ = problem;
        if (options_.source.quiet || status == DeviceStatus::finished) return;
        note(fmt::format("device {}: {}{}{}", device_name_, name_of(status),
                         problem.empty() ? "" : ": ", problem));
    }

    void print_messages() {
        for (const RequestQueue::Message& message : queue_.messages()) {
            if (message.is_problem || !options_.source.quiet) note(message.text);
        }
    }

    /// Reports problems of data and recording when they are new.
    void watch_files() {
        if (rounds_ % 25 != 0) return;
        const auto tell = [&](std::string& told, const std::string& problem) {
            if (std::exchange(told, problem) != problem && !problem.empty()) {
                note("palpate: " + problem);
            }
        };
        tell(data_problem_, run_.data().problem());
        if (run_.recording()) tell(recording_problem_, run_.recording()->problem());
    }

    run::Run& run_;
    Remote* remote_;
    RequestQueue queue_;
    const std::string device_name_;
    const RunOptions& options_;
    std::vector<TimedRequest> requests_;
    std::size_t next_ = 0;
    bool wait_told_ = false;
    LiveCommands& commands_;
    Keys keys_;
    std::optional<DeviceStatus> status_;
    std::string problem_, data_problem_, recording_problem_;  // as told; the first the device's
    bool line_;
    int rounds_ = 0;
};

void announce(const run::Run& run, const DeviceInfo& device) {
    const RendererSettings& settings = run.settings();
    const std::string force =
        device.renders_force
            ? fmt::format("at most {} N, {} N/mm",
                          std::min(settings.force.limit, settings.device.maximum_force),
                          settings.force.stiffness)
            : "position only, no force";
    say("isovalue {}\ndevice {} ({}): {}; 1 mm of hand is {:.3g} mm of the volume\n",
        run.isovalue(), device.name, device.model, force, settings.transform.scale);
    for (const std::string& sentence : run.privileges()) say("{}\n", sentence);
}

void print_report(const ServoReport& report, double seconds, const DeviceInfo& device,
                  const RunOptions& options) {
    if (options.json) {
        print_json(report_json(report, seconds, device));
    } else if (!options.source.quiet) {
        fmt::print("{}", report_text(report, seconds));
    }
}

/// Saves the volume for --save; without it, warns of edits that are lost.
void save_as_asked(run::Data& data, const RunOptions& options) {
    const bool quiet = options.source.quiet;
    if (!options.save.empty() && data.is_streamed() && !data.editor().state().changed) {
        if (!quiet) say("nothing was edited, so nothing was saved\n");
    } else if (!options.save.empty()) {
        // After Ctrl-C as well: then without a bar, which would cancel it.
        std::string saved;
        {
            ProgressBar bar("saving", quiet || interrupted());
            saved = data.save(options.save, [&](double fraction) {
                if (!interrupted()) bar.at(fraction);
            });
        }
        if (!quiet) fmt::print(options.json ? stderr : stdout, "{}\n", saved);
    } else if (!data.is_sequence() && data.editor().state().changed && !quiet) {
        say("the edits were not saved (--save FILE, or the command save FILE)\n");
    }
}

/// Puts edits that would be lost into another place. Returns what became of them; empty if there
/// are none.
std::string rescued(run::Data& data) {
    if (data.is_sequence() || !data.editor().state().changed) return "";
    try {
        return "; the edits are kept in " + data.rescue().string();
    } catch (const std::exception& e) {
        return "; they could not be kept elsewhere: " + std::string(e.what());
    }
}

/// One more of the things that went wrong, if it is not empty.
void add(std::string& problems, const std::string& problem) {
    if (!problems.empty() && !problem.empty()) problems += "; ";
    problems += problem;
}

/// `unsaved`: why a command could not save; empty: none failed. Edits that could not be saved where
/// they should be go to another place. Returns what went wrong and where they are.
std::string save_at_end(run::Data& data, const RunOptions& options, std::string unsaved) {
    try {
        save_as_asked(data, options);
    } catch (const Interrupted&) {
        throw;
    } catch (const std::exception& e) {
        add(unsaved, e.what());
    }
    return unsaved.empty() ? unsaved : unsaved + rescued(data);
}

/// The same after a session that failed: without words of success, and only what was edited.
void save_after_failure(run::Data& data, const RunOptions& options) {
    if (data.is_sequence() || !data.editor().state().changed) return;
    std::string told = "the session failed";
    try {
        if (!options.save.empty()) told = data.save(options.save, {});
    } catch (const std::exception& e) {
        told += "; " + std::string(e.what());
    }
    std::fprintf(stderr, "palpate: %s%s\n", told.c_str(), rescued(data).c_str());
}

void start_recording(run::Run& run, const RunOptions& options) {
    if (options.record.empty()) return;
    run.record(options.record);
    if (run.data().loaded().live && !options.source.quiet) {
        say("note: the frames of a live source are not recorded: the recording can be "
            "plotted, but not rendered again\n");
    }
}

void finish_recording(run::Run& run, const RunOptions& options) {
    if (!run.recording()) return;
    const std::int64_t ticks = run.stop_recording();
    if (!options.json && !options.source.quiet) {
        fmt::print("recorded {} ticks in {}\n", ticks, options.record);
    }
}

constexpr auto between_rounds = 10ms;

/// A round's time of an unpaced session. Data that is being read goes at its own pace.
void step(run::Run& run) {
    const double until = std::chrono::duration<double>(between_rounds).count();
    for (double passed = 0; passed < until - 1e-9; passed += run.period()) {
        if (!run.data().is_settled()) std::this_thread::sleep_for(1ms);
        run.step();
    }
}

/// Throws std::invalid_argument for a session that only goes with the clock.
void require_own_time(const TouchOptions& options, const run::Setup& setup) {
    if (!options.unpaced) return;
    if ((setup.device.name == "simulated" || setup.device.name == "recorded") &&
        options.igtl.empty() && options.igtl_connect.empty()) {
        return;
    }
    throw std::invalid_argument(
        "--unpaced is for a simulated or recorded hand without a bridge: all others need the "
        "clock");
}

void require_no_mouse(const run::Setup& setup) {
    if (setup.device.name != "mouse") return;
    throw devices::DeviceError(
        "device mouse: there is no window to move it in: --headless, --json, --seconds and "
        "--commands open none, nor does a machine without a display; palpate devices lists others");
}

/// One volume, from the start of the servo to its end. Returns why a volume could not be written;
/// empty if all could.
std::string feel(run::Run& run, const RunOptions& options, std::vector<TimedRequest> requests,
                 LiveCommands& commands, Remote* remote) {
    run.start();
    if (!options.source.quiet) announce(run, run.device());
    Terminal terminal(run, options, std::move(requests), commands, remote);
    while (!interrupted() && terminal.update()) {
        if (options.unpaced) {
            step(run);
        } else {
            std::this_thread::sleep_for(between_rounds);
        }
    }
    run.stop();
    return terminal.finish();
}

LiveCommands commands_for(const run::Run& run) {
    return {run.field(), run.isovalue(), run.settings()};
}

void take_up_brush(run::Run& run, LiveCommands& commands, const std::string& words) {
    const Request brush = commands.from_words("brush " + words);
    std::get<DataRequest>(brush)(run.data(), run.field(), run.isovalue(), {});
}

/// What this command reads stays as it is.
void check_saving(run::Data& data, const TouchOptions& options) {
    data.keep(options.commands);
    data.keep(options.render.labels);
    if (!options.save.empty()) data.check_save_name(options.save);
}

void touch(const CLI::App& command, const TouchOptions& options) {
    const run::Setup setup = options.setup();
    const std::string flaw = flaw_in_volume_name(options.save);
    if (!flaw.empty()) throw std::invalid_argument(flaw);
    check_outputs({options.source.name(), options.commands, options.render.labels},
                  {options.record, options.save});
    require_no_mouse(setup);
    require_own_time(options, setup);
    if (options.unpaced) {
        warn_of_no_effect(command, {"--normal-priority"}, "--unpaced has no thread of its own");
    }
    const auto remote = make_remote(options.igtl, options.igtl_connect, options.source.quiet);
    run::LoadedVolume loaded = load_for_terminal(options.source);
    auto data = std::make_shared<run::Data>(std::move(loaded), setup.playback,
                                            options.unpaced ? Pace::by_steps : Pace::own_thread);
    auto run = std::make_unique<run::Run>(data, setup);
    warn_of_isovalue(run->field(), run->isovalue());
    check_saving(*data, options);
    LiveCommands commands = commands_for(*run);
    std::vector<TimedRequest> requests;
    if (!options.commands.empty()) requests = read_commands(options.commands, commands);
    if (!options.brush.empty()) take_up_brush(*run, commands, options.brush);
    start_recording(*run, options);
    if (!options.source.quiet) note_terraces(data->loaded());
    const DeviceInfo device = run->device();
    stay_awake();
    auto begin = std::chrono::steady_clock::now();
    std::string unsaved;
    try {
        unsaved = feel(*run, options, std::move(requests), commands, remote.get());
        while (auto pushed = remote ? remote->take_pushed() : nullptr) {
            const std::string kept = rescued(*data);  // of what came after the last save
            if (!kept.empty()) add(unsaved, data->loaded().name + " was replaced" + kept);
            data = std::move(pushed);
            run.reset();  // a device opens once
            run = std::make_unique<run::Run>(data, setup);
            commands = commands_for(*run);
            begin = std::chrono::steady_clock::now();
            add(unsaved, feel(*run, options, {}, commands, remote.get()));
        }
    } catch (...) {
        run.reset();  // no force while it is saved
        save_after_failure(*data, options);
        throw;
    }
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    print_report(run->report(), seconds, device, options);
    if (data->is_streamed() && !options.json && !options.source.quiet) {
        fmt::print("{}\n", streaming_text(data->streaming()));
    }
    unsaved = save_at_end(*data, options, unsaved);
    finish_recording(*run, options);
    if (!unsaved.empty()) throw io::OutputError(unsaved);
    if (run->device_failure() != DeviceFailure::none) {
        throw devices::DeviceError("device " + device.name + ": " + run->device_problem());
    }
    stop_if_interrupted();
}

/// False for scripts and without a display.
bool wants_window(const TouchOptions& options) {
    const bool remote = !options.igtl.empty() || !options.igtl_connect.empty();
    const bool script = remote || options.json || options.seconds > 0 || options.unpaced ||
                        !options.commands.empty() || !options.brush.empty() ||
                        !options.save.empty();
    return !options.headless && !script && has_display() && !viewer_program().empty();
}

void add_session(CLI::App& app, const char* name, const char* what, bool is_record,
                 const Words& words, const char* example) {
    auto options = std::make_shared<TouchOptions>();
    CLI::App* command = app.add_subcommand(name, what);
    command->footer(fmt::format(
        "Without --device a simulated hand explores the volume. Forces begin at zero once the "
        "computed force is small.\nThey end at zero, however the session ends. On a terminal, keys "
        "work while it runs (? lists them).\n\nExample:\n  {}",
        example));
    options->add_to(*command, is_record ? RunOptions::For::record : RunOptions::For::touch);
    if (!is_record) {
        command->add_flag("--headless", options->headless,
                          "Open no window, even if there is a display. The options --json, "
                          "--seconds, --commands and --igtl do the same");
    }
    command
        ->add_option("--igtl", options->igtl,
                     "Send poses and force to 3D Slicer by OpenIGTLink, and receive volumes and "
                     "commands: wait for clients at [HOST:]PORT")
        ->type_name("[HOST:]PORT");
    command
        ->add_option("--igtl-connect", options->igtl_connect,
                     "The same, but connect to a server, and again after a break")
        ->type_name("[HOST:]PORT");
    command->callback([options, words, is_record, command] {
        if (!is_record && wants_window(*options)) become_viewer(words);
        touch(*command, *options);
    });
}

}  // namespace

void add_touch(CLI::App& app, const Words& words) {
    add_session(app, "touch", "Touch a volume live with a haptic device", false, words,
                "palpate touch head.nrrd --isovalue 34.5 --device haply --record session.csv");
}

void add_record(CLI::App& app) {
    add_session(app, "record", "Touch a volume live and record the session", true, {},
                "palpate record head.nrrd --isovalue 34.5 --device haply --output session.csv");
}

}  // namespace palpate::app
