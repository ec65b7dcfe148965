// Sessions: opens and saves their files, and feels a volume again as a session says.
#include <algorithm>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "apps/options/exit_status.hpp"
#include "apps/viewer/model/opening.hpp"
#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/display_controller.hpp"
#include "apps/viewer/window/file_controller.hpp"
#include "apps/viewer/window/file_dialogs.hpp"
#include "apps/viewer/window/layers_controls.hpp"
#include "apps/viewer/window/look_controls.hpp"
#include "apps/viewer/window/measure_controller.hpp"
#include "apps/viewer/window/messages.hpp"
#include "apps/viewer/window/panel.hpp"
#include "apps/viewer/window/save_controller.hpp"

namespace palpate::viewer {
namespace {

QString reason_of(const std::exception_ptr& error) {
    try {
        std::rethrow_exception(error);
    } catch (const std::exception& e) {
        return QString::fromStdString(app::failure_of(e).text);
    }
}

}  // namespace

SessionFile FileController::session_now() const {
    SessionFile session;
    session.source = content_.source();
    const auto hand_now = [](const run::Run& live) {
        SessionHand hand{live.setup().device, live.isovalue(), live.settings()};
        if (const auto now = live.snapshot()) hand.settings->transform = now->session.transform;
        return hand;
    };
    if (const run::Run* live = content_.live(1)) {
        session.solid = live->field().solid();
        session.interpolation = live->field().interpolation();
        session.background = live->field().background();
        session.method = live->setup().render.method;
        session.buttons = live->setup().buttons;
        static_cast<SessionHand&>(session) = hand_now(*live);
        for (int hand = 2; hand <= content_.hands(); ++hand) {
            session.others.push_back(hand_now(*content_.live(hand)));
        }
    } else {
        const io::RecordingHead& head = content_.playback(1)->head();
        session.solid = head.solid;
        session.interpolation = head.interpolation;
        session.background = head.background;
        session.isovalue = head.isovalue;
        session.device = content_.request().setup.device;
        for (const devices::DeviceChoice& device : content_.request().others) {
            const Playback* other = content_.playback(2);
            session.others.push_back({device, (other ? other->head() : head).isovalue, {}});
        }
        session.method = run::named_method(head.method);
        session.buttons = content_.request().setup.buttons;
        session.settings = head.settings;
    }
    display_.save_view(session);
    return session;
}

void FileController::save_session(const QString& path) {
    if (!content_.volume()) return;
    write_session(path.toStdString(), session_now());
    measuring_.set_saved();
    content_.set_session(path);
    remember_file(path);
    messages_.show_done(tr("Saved %1").arg(path));
}

void FileController::ask_save_session(const QString& name, const std::function<void()>& then) {
    saver_.save_edits_first([=, this] {
        const QString path = !name.isEmpty()
                                 ? name
                                 : ask_save_name(messages_.window(), tr("Save the session"),
                                                 "session.json", "json", tr("Sessions (*.json)"));
        if (path.isEmpty()) return;
        save_session(path);
        layers_.set_saved();
        if (then) then();
    });
}

void FileController::open_session(const QString& path) {
    open_json(path, unsaved_work());
}

/// `before`: what was unsaved when the person was asked about it; nothing: not asked yet.
void FileController::open_json(const QString& path, const std::optional<UnsavedWork>& before) {
    messages_.forget();
    struct Result {
        std::optional<io::LayersFile> layers;
        SessionFile session;
    };
    const auto result = std::make_shared<Result>();
    const auto feel_it = [this, result, path] {
        const SessionFile& session = result->session;
        const Then feel = [this, session, path,
                           request = content_.take_request()](std::shared_ptr<Opened> opened) {
            feel_session(std::move(opened), session, request, [this, session, path] {
                content_.set_session(path);
                measuring_.set_saved();
                remember_file(path);
                layers_.restore(session, path);
            });
        };
        const bool outdated = content_.volume() && is_outdated(*content_.volume());
        outdated ? load(session.source, feel) : load_or_reuse(session.source, feel);
    };
    reader_.start(
        tr("Reading %1").arg(short_name(path)),
        [result, file = std::filesystem::path(path.toStdString())](const io::Progress& progress) {
            const std::string text = session_text(file, progress);
            if (LayersControls::is_layers(text)) {
                result->layers = io::layers_from_text(text, file.string());
            } else {
                result->session = session_from(text, file);
            }
        },
        [this, result, path, settled = unless_changed(before, feel_it)] {
            result->layers ? layers_.take(path, *result->layers) : settled();
        });
}

/// Devices, buttons, and the settings that the command line names are its own, the others those of
/// the session. Where devices cannot be had, those chosen in this window are used.
void FileController::feel_session(std::shared_ptr<Opened> opened, SessionFile session,
                                  RunRequest request, std::function<void()> then, bool in_place) {
    run::Setup& setup = request.setup;
    setup.field = {session.solid, session.background, session.isovalue, session.interpolation};
    if (!request.device) {
        request.others.clear();
        for (const SessionHand& other : session.others) request.others.push_back(other.device);
    }
    setup.device = request.device.value_or(session.device);
    setup.buttons = session.buttons;
    for (const auto& [member, wanted] : request.buttons) setup.buttons.*member = wanted;
    const auto use_named = [&](SessionHand& hand) {
        if (hand.settings && request.named_settings) request.named_settings(*hand.settings);
    };
    use_named(session);
    std::ranges::for_each(session.others, use_named);
    setup.render.method = session.method;
    setup.render.layers.reset();  // the session's are in its settings
    // The usual one is smaller for a fast device.
    const int budget = session.settings.value_or(RendererSettings{}).proxy.step_budget;
    if (!setup.render.step_budget && budget != ProxySettings{}.step_budget) {
        setup.render.step_budget = budget;
    }
    const auto felt = [=, this] {
        panel_.look_controls().use_usual_look();
        restore_hands(session, in_place);
        display_.restore_view(session);
        if (then) then();
    };
    feel(opened, request, felt, [=, this](const std::exception_ptr& error) {
        const RunRequest& chosen = content_.request();
        if (request.setup.device == chosen.setup.device && request.others == chosen.others) {
            std::rethrow_exception(error);
        }
        RunRequest other = request;
        other.use_devices_of(chosen);
        feel(opened, other, [=, this] {
            felt();
            messages_.show_done(tr("%1; felt through the device %2")
                                    .arg(reason_of(error),
                                         QString::fromStdString(run::text_of(other.setup.device))));
        });
    });
}

void FileController::restore_hands(const SessionFile& session, bool in_place) {
    if (session.settings) restore(*session.settings, in_place);
    int hand = 1;
    for (const SessionHand& other : session.others) {
        if (!content_.live(++hand)) break;  // its device cannot be had
        content_.choose_hand(hand);
        content_.effect().request(command::Isovalue{other.isovalue});
        if (other.settings) restore(*other.settings, in_place);
    }
    content_.choose_hand(1);
}

/// Requests those of the settings for which there are commands. Not layers that lack_labels(). Not
/// `in_place`: hands are where this run has put them, as the data lie elsewhere.
void FileController::restore(const RendererSettings& settings, bool in_place) {
    const auto send = [this](const Command& command) { content_.effect().request(command); };
    if (!settings.tool) send(command::UseTool{nullptr});  // beside one, other things are refused
    send(settings.force);
    send(settings.proxy.friction);
    send(settings.penetrability);
    if (settings.layers && !lack_labels(settings.layers)) {
        send(command::UseLayers{settings.layers});
    }
    if (settings.tool) send(command::UseTool{settings.tool});
    if (in_place) send(settings.transform);
    send(command::Forces{settings.forces_on});
    Q_EMIT content_.run_changed();
}

}  // namespace palpate::viewer
