// palpate touch: a live run. palpate record: the same, always recorded.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "apps/options/no_effect.hpp"
#include "apps/options/run_options.hpp"
#include "apps/options/say.hpp"
#include "apps/palpate/commands.hpp"
#include "apps/palpate/live_hands.hpp"
#include "apps/palpate/live_status.hpp"
#include "apps/palpate/outputs.hpp"
#include "apps/palpate/progress.hpp"
#include "apps/palpate/remote.hpp"
#include "apps/palpate/run_terminal.hpp"
#include "apps/palpate/window.hpp"
#include "io/recording/settings_json.hpp"
#include "palpate/run/run.hpp"

namespace palpate::app {
namespace {

using namespace std::chrono_literals;

struct TouchOptions : RunOptions {
    bool headless = false;
    std::string igtl, igtl_connect;

    bool has_bridge() const { return !igtl.empty() || !igtl_connect.empty(); }
};

void announce(const LiveHand& hand) {
    const run::Run& run = *hand.run;
    const DeviceInfo device = run.device();
    const RendererSettings& settings = run.settings();
    const std::string force =
        device.renders_force
            ? fmt::format("at most {} N, {} N/mm",
                          std::min(settings.force.limit, settings.device.maximum_force),
                          settings.force.stiffness)
            : "position only, no force";
    say("{} ({}): {}; 1 mm of hand is {:.3g} mm of the volume\n", hand.name, device.model, force,
        settings.transform.scale);
}

void announce(const std::vector<LiveHand>& hands) {
    const run::Run& first = *hands.front().run;
    say("isovalue {}\n", first.isovalue());
    for (const LiveHand& hand : hands) announce(hand);
    for (const std::string& sentence : first.privileges()) say("{}\n", sentence);
}

/// One hand has an object of its own. Several hands have a list of objects.
nlohmann::ordered_json reports_json(const std::vector<LiveHand>& hands, double seconds) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const LiveHand& hand : hands) {
        auto report = report_json(hand.run->report(), seconds, hand.device);
        report["settings"] = io::to_json(hand.run->settings());
        if (hands.size() == 1) return report;
        report["hand"] = list.size() + 1;
        report["problem"] = hand.run->device_problem();
        list.push_back(std::move(report));
    }
    return {{"hands", list}};
}

void print_report(const std::vector<LiveHand>& hands, double seconds, const RunOptions& options) {
    if (options.json) return print_json(reports_json(hands, seconds));
    if (options.source.quiet) return;
    for (const LiveHand& hand : hands) {
        const std::string failed = hand.has_failed() ? ": " + hand.run->device_problem() : "";
        if (hands.size() > 1) fmt::print("{}{}\n", hand.name, failed);
        fmt::print("{}", report_text(hand.run->report(), seconds));
    }
}

/// The progress of work after a session, also one that Ctrl-C has ended: a further one ends it.
OnProgress until_interrupted_again() {
    return [before = interruptions()](double) {
        if (interruptions() > before) throw Interrupted{};
    };
}

/// Data::save() for --save, also after Ctrl-C. A further Ctrl-C ends it.
std::string save(run::Data& data, const RunOptions& options) {
    const int before = interruptions();
    ProgressBar bar("saving", options.source.quiet || before > 0);
    try {
        return data.save(options.save, [&](double fraction) {
            if (interruptions() > before) throw Interrupted{};
            if (before == 0) bar.at(fraction);
        });
    } catch (const Interrupted&) {
        throw io::OutputError("saving was interrupted");
    }
}

/// Saves the volume for --save; without it, warns of edits that are lost.
void save_as_asked(run::Data& data, const RunOptions& options) {
    const bool quiet = options.source.quiet;
    if (!options.save.empty() && data.is_streamed() && !data.is_edited()) {
        if (!quiet) say("nothing was edited, so nothing was saved\n");
    } else if (!options.save.empty()) {
        const std::string saved = save(data, options);
        if (!quiet) fmt::print(options.json ? stderr : stdout, "{}\n", saved);
    } else if (!data.is_sequence() && data.editor().state().changed) {
        say("the edits were not saved (--save FILE, or the command save FILE)\n");
    }
}

/// Puts edits that would be lost into another place. Returns what became of them; empty if there
/// are none.
std::string rescued(run::Data& data) {
    if (data.is_sequence() || !data.editor().state().changed) return "";
    try {
        return "; the edits are kept in " + data.rescue(until_interrupted_again()).string();
    } catch (const Interrupted&) {
        return "; keeping them elsewhere was interrupted";
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
    } catch (const std::exception& e) {
        add(unsaved, e.what());
    }
    return unsaved.empty() ? unsaved : unsaved + rescued(data);
}

/// The same after a session that failed: saves edits only, and reports no success.
void save_after_failure(run::Data& data, const RunOptions& options) {
    if (data.is_sequence() || !data.editor().state().changed) return;
    std::string told = "the session failed";
    try {
        if (!options.save.empty()) told = save(data, options);
    } catch (const std::exception& e) {
        told += "; " + std::string(e.what());
    }
    say("palpate: {}{}\n", told, rescued(data));
}

void start_recording(std::vector<LiveHand>& hands, const RunOptions& options) {
    if (options.record.empty()) return;
    record(hands, options.record);
    if (hands.front().run->data().loaded().live && !options.source.quiet) {
        say("note: the frames of a live source are not recorded: the recording can be "
            "plotted, but not rendered again\n");
    }
}

void finish_recording(std::vector<LiveHand>& hands, const RunOptions& options) {
    const io::RecordingWriter* recording = hands.front().run->recording();
    const bool was_told = recording && !recording->problem().empty();  // by the terminal
    std::vector<std::int64_t> ticks;
    try {
        ticks = stop_recording(hands, until_interrupted_again());
    } catch (const Interrupted&) {
        throw io::OutputError(options.record +
                              ": is not complete: its reader was not waited for any longer");
    } catch (const io::OutputError&) {
        if (!was_told) throw;
        throw io::OutputError(options.record + ": is not complete");
    }
    if (!ticks.empty() && !options.json && !options.source.quiet) {
        fmt::print("recorded {} ticks in {}\n", fmt::join(ticks, " and "), options.record);
    }
}

constexpr auto between_rounds = 10ms;

/// A hand that needs no hardware, so that there may be any number of it.
bool is_made_up(const run::Setup& setup) {
    return setup.device.name == "simulated" || setup.device.name == "recorded";
}

/// Throws std::invalid_argument for hands that cannot be together.
void check_hands(const TouchOptions& options, const std::vector<run::Setup>& setups) {
    if (setups.size() == 1) return;
    if (setups.size() > devices::LastResort::most) {
        throw std::invalid_argument(
            fmt::format("--device: at most {} hands at once", devices::LastResort::most));
    }
    if (options.has_bridge()) {
        throw std::invalid_argument("--igtl shows one hand: give one --device");
    }
    for (const run::Setup& setup : setups) {
        const auto is_the_same = [&](const run::Setup& s) { return s.device == setup.device; };
        if (is_made_up(setup) || std::ranges::count_if(setups, is_the_same) == 1) continue;
        throw std::invalid_argument(
            "--device " + run::text_of(setup.device) +
            ": a device serves one hand: tell two of a kind apart by their options");
    }
}

/// Throws std::invalid_argument for a session that only goes with the clock.
void require_own_time(const TouchOptions& options, const std::vector<run::Setup>& setups) {
    if (!options.unpaced) return;
    if (std::ranges::all_of(setups, &is_made_up) && !options.has_bridge()) return;
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

/// One volume, from the start of the servos to their end. Returns why a volume could not be
/// written; empty if all could.
std::string feel(std::vector<LiveHand>& hands, const RunOptions& options, Remote* remote) {
    for (LiveHand& hand : hands) hand.run->start();
    if (!options.source.quiet) announce(hands);
    RunTerminal terminal(hands, options, remote);
    while (!interrupted() && terminal.update()) {
        if (options.unpaced) {
            step(hands, std::chrono::duration<double>(between_rounds).count());
        } else {
            std::this_thread::sleep_for(between_rounds);
        }
    }
    for (LiveHand& hand : hands) hand.run->stop();
    return terminal.finish();
}

/// Refuses to overwrite files that this command reads.
void check_saving(run::Data& data, const TouchOptions& options) {
    data.keep(options.commands);
    data.keep(options.record);
    for (const std::string& input : options.render.inputs()) data.keep(input);
    if (!options.save.empty()) data.check_save_name(options.save);
}

void touch(const CLI::App& command, const TouchOptions& options) {
    const std::vector<run::Setup> setups = options.setups();
    check_volume_name(options.save);
    std::vector<std::string> inputs = options.render.inputs();
    inputs.insert(inputs.end(), {options.source.name(), options.commands});
    check_outputs(inputs, {options.record, options.save});
    for (const run::Setup& setup : setups) require_no_mouse(setup);
    check_hands(options, setups);
    require_own_time(options, setups);
    if (options.unpaced) {
        warn_of_no_effect(command, {"--normal-priority", "--overrun"},
                          "--unpaced has no thread of its own, and no clock");
    }
    const auto remote = make_remote(options.igtl, options.igtl_connect, options.source.quiet);
    run::LoadedVolume loaded = load_for_terminal(options.source);
    auto data = std::make_shared<run::Data>(std::move(loaded), setups.front().playback,
                                            options.unpaced ? Pace::by_steps : Pace::own_thread);
    std::vector<LiveHand> hands = open_hands(data, setups);
    warn_of_isovalue(hands.front().run->field(), hands.front().run->isovalue());
    const auto& layers = hands.front().run->setup().render.layers;
    if (layers) warn_of_layers(*layers, data->loaded());
    check_saving(*data, options);
    if (!options.commands.empty()) read_commands(options.commands, hands);
    if (!options.brush.empty()) take_up_brush(hands, options.brush);
    start_recording(hands, options);
    if (!options.source.quiet) note_terraces(data->loaded());
    stay_awake();
    auto begin = std::chrono::steady_clock::now();
    std::string unsaved;
    try {
        unsaved = feel(hands, options, remote.get());
        while (auto pushed = remote ? remote->take_pushed() : nullptr) {
            const std::string kept = rescued(*data);  // of what came after the last save
            if (!kept.empty()) add(unsaved, data->loaded().name + " was replaced" + kept);
            data = std::move(pushed);
            hands.clear();  // a device opens once
            hands = open_hands(data, setups);
            begin = std::chrono::steady_clock::now();
            add(unsaved, feel(hands, options, remote.get()));
        }
    } catch (...) {
        hands.clear();  // no force while it is saved
        save_after_failure(*data, options);
        throw;
    }
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    print_report(hands, seconds, options);
    if (data->is_streamed() && !options.json && !options.source.quiet) {
        fmt::print("{}\n", streaming_text(data->streaming()));
    }
    unsaved = save_at_end(*data, options, unsaved);
    finish_recording(hands, options);
    if (!unsaved.empty()) throw io::OutputError(unsaved);
    const std::string failure = failure_of(hands);
    if (!failure.empty()) throw devices::DeviceError(failure);
    stop_if_interrupted();
}

/// False for scripts and without a display.
bool wants_window(const TouchOptions& options) {
    constexpr std::size_t most_hands = 2;  // in a window
    const bool script = options.has_bridge() || options.devices.size() > most_hands ||
                        options.json || options.seconds > 0 || options.unpaced ||
                        !options.commands.empty() || !options.brush.empty() ||
                        !options.save.empty();
    return !options.headless && !script && has_display() && !viewer_program().empty();
}

void add_session(CLI::App& app, const char* name, const char* what, bool is_record,
                 const Words& words, const char* example) {
    auto options = std::make_shared<TouchOptions>();
    CLI::App* command = app.add_subcommand(name, what);
    command->footer(fmt::format(
        "{} Forces begin at zero once the computed force is small.\nThey end at zero, however the "
        "session ends. On a terminal, keys work while it runs (? lists them).\n\nExample:\n  {}",
        is_record ? "Without --device, a simulated hand explores the volume."
                  : "If there is a display, the viewer opens and the mouse is the hand. Without a "
                    "window, a simulated hand explores the volume.",
        example));
    options->add_to(*command, is_record ? RunOptions::For::record : RunOptions::For::touch);
    if (!is_record) {
        command->add_flag("--headless", options->headless,
                          "Open no window, even if there is a display. The options --json, "
                          "--seconds, --unpaced, --commands, --brush, --save, --igtl and a third "
                          "--device also open none");
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
