// Carries out requests that arrive by OpenIGTLink.
#include "apps/palpate/remote.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <stdexcept>

#include "apps/options/say.hpp"
#include "apps/palpate/commands.hpp"
#include "palpate/run/labels.hpp"
#include "palpate/surface.hpp"

namespace palpate::app {
namespace {

/// Commands that change the settings of touch, and nothing beyond the run.
constexpr std::array allowed{"isovalue", "stiffness",     "damping", "viscosity", "friction",
                             "freeze",   "penetrability", "clutch",  "scale",     "undo",
                             "redo",     "play",          "pause",   "step",      "seek"};

bool is_label_map(const std::string& name) {
    std::string lower;
    for (const unsigned char c : name) lower += static_cast<char>(std::tolower(c));
    return lower.find("label") != std::string::npos;
}

run::LoadedVolume loaded_from(bridge::VolumePushed& pushed) {
    run::Source source;
    source.from =
        run::FileSource{.path = "igtl:" + pushed.name, .raw = {}, .spacing = {}, .series = {}};
    return {.volume = std::move(pushed.volume), .source = source, .name = "igtl:" + pushed.name};
}

}  // namespace

Request remote_request(LiveCommands& commands, const std::string& words) {
    const std::string name = words.substr(0, words.find(' '));
    const bool is_safe = std::ranges::find(allowed, name) != allowed.end() ||
                         words == "forces off" || words == "layers off";
    if (is_safe) return commands.from_words(words);
    std::string names;
    for (const char* const one : allowed) names += std::string(one) + ", ";
    throw std::invalid_argument("'" + name + "' is not for others to ask: there are " + names +
                                "forces off, layers off, surface");
}

bool Remote::serve(run::Run& run, const Snapshot& now, LiveCommands& commands, RequestQueue& queue,
                   const std::function<void(const Request&)>& carry_out) {
    bridge_.show(now, run.settings().tool != nullptr);
    for (bridge::Request& asked : bridge_.requests()) {
        try {
            answer(run, now, commands, queue, carry_out, asked);
        } catch (const std::exception& e) {
            bridge_.reply(asked.peer, std::string("not done: ") + e.what());
        }
    }
    return pushed_ == nullptr;
}

void Remote::answer(run::Run& run, const Snapshot& now, LiveCommands& commands, RequestQueue& queue,
                    const std::function<void(const Request&)>& carry_out, bridge::Request& asked) {
    if (auto* const words = std::get_if<bridge::WordsAsked>(&asked.what)) {
        if (words->text == "surface") return send_surface(run, now, queue, asked.peer);
        carry_out(remote_request(commands, words->text));
        bridge_.reply(asked.peer, "done: " + words->text);
    } else if (auto* const volume = std::get_if<bridge::VolumePushed>(&asked.what)) {
        bridge_.reply(asked.peer, "done: " + take_volume(run, *volume));
    } else {
        send_surface(run, now, queue, asked.peer);
    }
}

void Remote::send_surface(const run::Run& run, const Snapshot& now, RequestQueue& queue, int peer) {
    if (surface_under_way_.exchange(true)) {
        throw std::invalid_argument("another surface is being made: ask again");
    }
    queue.put([this, field = run.field_now(), level = now.session.tick.proxy.isovalue,
               peer](const std::stop_token&) {
        try {
            SurfaceOptions options;
            options.progress = [](double) { return !interrupted(); };
            bridge_.send_surface(peer, extract_surface(field, level, options));
        } catch (const std::exception& e) {
            bridge_.reply(peer, std::string("not done: ") + e.what());
        }
        surface_under_way_ = false;
        return std::string();
    });
}

/// Everything that can be wrong with it is found out before the run ends.
std::string Remote::take_volume(run::Run& run, bridge::VolumePushed& volume) {
    run::LoadedVolume loaded = loaded_from(volume);
    const std::string name = loaded.name;
    if (is_label_map(volume.name)) {
        const io::LayersFile file = run::layers_by_label(loaded);
        run.send(command::UseLayers{std::make_shared<const Layers>(file.layers)});
        const std::string warning = run::layers_warning(file, run.data().loaded());
        return name + " as labels" + (warning.empty() ? "" : ": " + warning);
    }
    if (run.recording()) {
        throw std::invalid_argument("the session is recorded: a recording has one volume");
    }
    if (!run.data().is_sequence() && run.data().editor().state().changed) {
        throw std::invalid_argument("the volume felt has edits that were not saved");
    }
    const run::Setup& setup = run.setup();
    auto data = std::make_shared<run::Data>(std::move(loaded), setup.playback);
    const Field field = run::make_field(data->start(), setup.field, setup.render.method.method);
    const double isovalue = run::isovalue_of(data->loaded(), setup);
    run::make_session(field, isovalue, run.device(), setup);
    pushed_ = std::move(data);
    return fmt::format("{} at isovalue {}", name, isovalue);
}

std::unique_ptr<Remote> make_remote(const std::string& listen, const std::string& connect,
                                    bool quiet) {
    if (listen.empty() && connect.empty()) return nullptr;
    if (!listen.empty() && !connect.empty()) {
        throw std::invalid_argument("--igtl and --igtl-connect: give one of them");
    }
    const bool client = listen.empty();
    try {
        const bridge::Settings settings = bridge::settings_from(client ? connect : listen, client);
        if (!bridge::is_local(settings)) {
            say("warning: OpenIGTLink has no passwords and no encryption: everybody who "
                "reaches {} can read the session and change volume and level. Use it only "
                "in a network of your own, or over ssh: ssh -L 18944:localhost:18944\n",
                settings.host);
        }
        auto remote = std::make_unique<Remote>(settings);
        if (!quiet) {
            say("OpenIGTLink: {} {}:{}\n", client ? "connecting to" : "waiting at", settings.host,
                remote->port());
        }
        return remote;
    } catch (const std::runtime_error& e) {
        throw std::invalid_argument(e.what());
    }
}

}  // namespace palpate::app
