// Reads files, then starts the live run or the playback that they describe.
#include "apps/viewer/window/file_controller.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "apps/options/exit_status.hpp"
#include "apps/viewer/model/opening.hpp"
#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/display_controller.hpp"
#include "apps/viewer/window/file_dialogs.hpp"
#include "apps/viewer/window/isovalue_controls.hpp"
#include "apps/viewer/window/layers_controls.hpp"
#include "apps/viewer/window/look_controls.hpp"
#include "apps/viewer/window/measure_controller.hpp"
#include "apps/viewer/window/messages.hpp"
#include "apps/viewer/window/open_dialogs.hpp"
#include "apps/viewer/window/panel.hpp"
#include "apps/viewer/window/recording_controller.hpp"
#include "apps/viewer/window/save_controller.hpp"
#include "apps/viewer/window/views.hpp"
#include "palpate/io/address.hpp"
#include "palpate/io/sample_volume.hpp"

namespace palpate::viewer {
namespace {

std::filesystem::path path_of(const QString& name) {
    return std::filesystem::path(name.toStdString());
}

/// What replaces the file's own orientation and spacing now.
io::GivenGrid given_grid(const run::Source& source) {
    if (const auto* file = std::get_if<run::FileSource>(&source.from)) {
        return {file->spacing, file->orientation};
    }
    const auto* store = std::get_if<run::StoreSource>(&source.from);
    return store ? io::GivenGrid{store->options.spacing, store->options.orientation}
                 : io::GivenGrid{};
}

/// The same source, its grid lying otherwise.
run::Source with_grid(run::Source source, const io::GivenGrid& grid) {
    const auto put_into = [&](auto& options) {
        options.spacing = grid.spacing;
        options.orientation = grid.orientation;
    };
    if (auto* file = std::get_if<run::FileSource>(&source.from)) put_into(*file);
    if (auto* store = std::get_if<run::StoreSource>(&source.from)) put_into(store->options);
    return source;
}

}  // namespace

FileController::FileController(const Desk& desk, Panel& panel, RecordingController& recordings,
                               DisplayController& display, MeasureController& measuring,
                               SaveController& saver)
    : Controller(desk),
      panel_(panel),
      layers_(panel.layers_controls()),
      recordings_(recordings),
      display_(display),
      measuring_(measuring),
      saver_(saver),
      loader_(messages_) {
    connect(&panel_.isovalue_controls(), &IsovalueControls::dequantize_wanted, this,
            &FileController::dequantize);
}

/// What is open can be changed meanwhile, which is asked about then.
void FileController::read(const QString& label, Worker::Task task, std::function<void()> then) {
    loader_.start(label, std::move(task), [this, before = unsaved_work(), then = std::move(then)] {
        unsaved_work() == before ? then() : settle_work(then);
    });
}

FileController::UnsavedWork FileController::unsaved_work() const {
    UnsavedWork work{saver_.unsaved(), {}, nullptr};
    if (measuring_.unsaved()) work.measurements = measuring_.measurements();
    if (layers_.unsaved()) work.layers = layers_.layers();
    return work;
}

void FileController::settle_work(const std::function<void()>& action) {
    if (may_lose_work([this, action] { settle_work(action); })) action();
}

bool FileController::may_lose_work(const std::function<void()>& once_saved) {
    if (!saver_.may_lose_edits(once_saved)) return false;
    const bool measured = measuring_.unsaved();
    if (!measured && !layers_.unsaved()) return true;
    return messages_.may_lose(
        "lose_work",
        measured ? tr("The measurements are in no session file yet. Save the session?")
                 : tr("The changed layers are in no file yet. Save them in the session?"),
        {}, [this, once_saved] { ask_save_session(content_.session(), once_saved); });
}

void FileController::load(const run::Source& source, Then then) {
    struct Result {
        std::shared_ptr<Opened> opened;
        std::optional<io::SeriesChoice> choice;
    };
    auto result = std::make_shared<Result>();
    read(
        tr("Reading %1").arg(short_name(QString::fromStdString(name_of(source)))),
        [result, source](const io::Progress& progress) {
            try {
                result->opened = std::make_shared<Opened>(open(source, progress));
            } catch (const io::SeriesChoice& choice) {
                result->choice = choice;
            }
        },
        [this, result, source, then = std::move(then)] {
            if (result->choice) return choose_series(*result->choice, source, then);
            then(result->opened);
        });
}

/// Asks which series, and loads it.
void FileController::choose_series(const io::SeriesChoice& choice, const run::Source& source,
                                   const Then& then) {
    const QString name = short_name(QString::fromStdString(name_of(source)));
    const auto open = [this, source, then](int number) {
        run::Source chosen = source;
        std::get<run::FileSource>(chosen.from).series = std::to_string(number);
        load(chosen, then);
    };
    messages_.ask(make_series_dialog(name, choice.series(), messages_.window(), open),
                  QString::fromStdString(choice.what()));
}

/// As load(), but does not read a volume again that is open already. Addresses whose query was left
/// out cannot be compared.
void FileController::load_or_reuse(const run::Source& source, Then then) {
    const std::shared_ptr<Opened> opened = content_.volume();
    // The samples of one that was saved elsewhere are those of before its edits.
    const auto names = run::to_names(source);
    if (!opened || content_.saved_elsewhere() || names.contains("secrets") ||
        run::to_names(opened->loaded.source) != names) {
        return load(source, std::move(then));
    }
    loader_.abandon();
    messages_.guarded([&] { then(opened); });
}

void FileController::open_path(const QString& path) {
    remember_folder(path);
    if (LayersControls::is_layers_file(path)) return layers_.open(path);
    if (path.endsWith(".json", Qt::CaseInsensitive)) return open_session(path);
    if (path.endsWith(".csv", Qt::CaseInsensitive)) return open_recording(path);
    messages_.guarded([&] {
        // Looks at what it is: a store is felt while it is read.
        const run::Source source = run::source_from({{"volume", path.toStdString()}});
        lacks_layout(source) ? ask_layout(source) : open_volume(source);
    });
}

void FileController::ask_layout(const run::Source& source) {
    const auto open = [this, source](const run::FileSource& file) {
        run::Source known = source;
        known.from = file;
        open_volume(known);
    };
    const QString name = QString::fromStdString(name_of(source));
    messages_.ask(make_raw_dialog(name, messages_.window(), open));
}

void FileController::ask_address() {
    const auto open = [this](const run::Source& source) { open_volume(source); };
    messages_.ask(make_store_dialog(std::nullopt, 0, messages_.window(), open));
}

void FileController::ask_level() {
    if (!content_.live()) return;
    const run::Source felt = content_.source();
    const auto* store = std::get_if<run::StoreSource>(&felt.from);
    if (!store) return;
    const auto open = [this, channel = store->options.channel](const run::Source& chosen) {
        const bool same = std::get<run::StoreSource>(chosen.from).options.channel == channel;
        same ? feel_again(chosen) : open_volume(chosen);
    };
    messages_.ask(make_store_dialog(*store, felt.frame.value_or(0), messages_.window(), open));
}

void FileController::ask_grid() {
    const run::LoadedVolume& loaded = content_.volume()->loaded;
    const Geometry& grid = loaded.streamed ? loaded.streamed->store->info().levels[0].geometry
                                           : loaded.volume.geometry();
    const auto use = [this](const io::GivenGrid& given) {
        messages_.guarded([&] { use_grid(given); });
    };
    messages_.ask(make_grid_dialog(grid, given_grid(content_.source()), messages_.window(), use));
}

void FileController::open_volume(const run::Source& source) {
    messages_.forget();
    load(source, [this, request = content_.take_request()](std::shared_ptr<Opened> opened) mutable {
        request.use_devices_of(content_.request());
        run::Setup& setup = request.setup;
        if (!setup.field.isovalue && !setup.render.layers) {
            setup.field.isovalue = first_isovalue(*opened);
        }
        feel(std::move(opened), request);
        panel_.look_controls().use_usual_look();
    });
}

void FileController::open_sample() {
    messages_.guarded([&] {
        const std::string path = io::sample_volume_path().string();
        // Layers have levels of their own.
        run::Setup& setup = content_.request().setup;
        if (!setup.field.isovalue && !setup.render.layers) {
            setup.field.isovalue = io::sample_volume_skin;
        }
        open_volume(run::source_named(path));
    });
}

void FileController::start(std::shared_ptr<Opened> volume, const std::vector<run::Setup>& hands) {
    content_.start_run(std::move(volume), hands);
    QStringList names;
    for (const run::Setup& hand : hands) names << QString::fromStdString(run::text_of(hand.device));
    QString words = names.size() == 1 ? tr("Felt through the device %1").arg(names.front())
                                      : tr("Felt through the devices %1").arg(names.join(", "));
    for (const std::string& sentence : content_.live()->privileges()) {
        words += "; " + QString::fromStdString(sentence);
    }
    messages_.show_done(words);
    Q_EMIT content_.device_changed();
}

void FileController::feel(std::shared_ptr<Opened> opened, const RunRequest& request) {
    start(opened, request.setups());
    if (!request.record.empty()) recordings_.start(QString::fromStdString(request.record));
    remember_file(QString::fromStdString(io::address_to_keep(opened->loaded.name)));
    for (const std::string& note : opened->loaded.notes) {
        messages_.show_done(QString::fromStdString(note));
    }
    tell_choices(*opened);
}

/// Of a store with several channels or times one is felt.
void FileController::tell_choices(const Opened& opened) {
    if (!opened.loaded.streamed) return;
    const stream::StoreInfo& info = opened.loaded.streamed->store->info();
    const auto channels = std::max<int>(1, static_cast<int>(info.channels.size()));
    if (channels == 1 && info.times == 1) return;
    messages_.show_done(tr("%1 channels, %2 times: Data > Level, channel and time chooses another")
                            .arg(channels)
                            .arg(info.times));
}

void FileController::dequantize(bool on) {
    saver_.settle_edits([this, on] {
        if (!content_.live()) return;
        run::Source source = content_.source();
        const auto& terraces = content_.volume()->terraces;
        const int rounds = terraces ? terraces->rounds() : filters::DequantizeOptions{}.rounds;
        source.dequantize = on ? rounds : 0;
        feel_again(source);
    });
}

/// Another reading of the same volume, in the same view.
void FileController::feel_again(const run::Source& source) {
    if (!content_.live()) return;
    SessionFile session = session_now();
    session.source = source;
    load(source, [this, session, request = request_for_same()](std::shared_ptr<Opened> opened) {
        feel_session(std::move(opened), session, request);
    });
}

/// The devices are those in use, whatever the command line named.
RunRequest FileController::request_for_same() {
    RunRequest request = content_.take_request();
    request.device.reset();
    request.buttons.clear();
    return request;
}

void FileController::use_grid(const io::GivenGrid& grid) {
    if (!content_.live()) return;
    SessionFile session = session_now();
    session.source = with_grid(session.source, grid);
    // Places in the volume are elsewhere now.
    session.camera.reset();
    session.crosshair.reset();
    session.measurements.clear();
    session.look.cut = Cut::nothing;
    load(session.source,
         [this, session, request = request_for_same()](std::shared_ptr<Opened> opened) {
             feel_session(std::move(opened), session, request, false);
         });
}

void FileController::open_recording(const QString& path) {
    messages_.forget();
    messages_.guarded([&] {
        const io::RecordingHead head = io::read_recording_head(path_of(path));
        const run::Source source = run::recorded_source(head, path_of(path));
        (void)content_.take_request();  // they were for a volume to feel
        load_or_reuse(source, [this, path](std::shared_ptr<Opened> opened) {
            play(std::move(opened), path);
        });
    });
}

void FileController::play(std::shared_ptr<Opened> opened, const QString& path) {
    auto result = std::make_shared<std::vector<Playback>>();
    read(
        tr("Reading %1").arg(short_name(path)),
        [result, opened, path](const io::Progress& progress) {
            *result = Playback::read_hands(path_of(path), opened->loaded, progress);
        },
        [this, result, opened, path] {
            const bool same = content_.volume() == opened;
            content_.start_playback(opened, std::move(*result));
            if (!same) panel_.look_controls().use_usual_look();
            remember_file(path);
        });
}

void FileController::leave_playback() {
    if (!content_.playback()) return;
    SessionFile session = session_now();
    session.settings.reset();  // the recorded device's
    const int chosen = content_.hand();
    if (chosen <= 1 + static_cast<int>(session.others.size())) {
        SessionHand& shown = chosen == 1 ? session : session.others.at(std::size_t(chosen - 2));
        shown.isovalue = views_.shown().isovalue;
    }
    std::map<int, SharedLayers> layers;
    for (int hand = 1; hand <= content_.hands(); ++hand) {
        if (content_.layers(hand)) layers[hand] = content_.layers(hand);
    }
    feel_session(content_.volume(), session, request_for_same());
    if (!layers.empty()) content_.use_layers(layers);
}

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
        const QString path =
            !name.isEmpty()
                ? name
                : ask_save_name(messages_.window(), tr("Save the session"), "session.json", "json");
        if (path.isEmpty()) return;
        save_session(path);
        layers_.set_saved();
        if (then) then();
    });
}

void FileController::open_session(const QString& path) {
    messages_.forget();
    messages_.guarded([&] {
        const SessionFile session = read_session(path.toStdString());
        load_or_reuse(session.source, [this, session, path, request = content_.take_request()](
                                          std::shared_ptr<Opened> opened) {
            feel_session(std::move(opened), session, request);
            content_.set_session(path);
            measuring_.set_saved();
            remember_file(path);
            layers_.restore(session, path);
        });
    });
}

/// Devices and buttons are those of the command line, else the session's; where they cannot be had,
/// those chosen in this window.
void FileController::feel_session(std::shared_ptr<Opened> opened, const SessionFile& session,
                                  RunRequest request, bool in_place) {
    run::Setup& setup = request.setup;
    setup.field = {session.solid, session.background, session.isovalue, session.interpolation};
    if (!request.device) {
        request.others.clear();
        for (const SessionHand& other : session.others) request.others.push_back(other.device);
    }
    setup.device = request.device.value_or(session.device);
    setup.buttons = session.buttons;
    for (const auto& [member, wanted] : request.buttons) setup.buttons.*member = wanted;
    setup.render.method = session.method;
    setup.render.layers.reset();  // the session's are in its settings
    // The usual one is smaller for a fast device.
    const int budget = session.settings.value_or(RendererSettings{}).proxy.step_budget;
    if (!setup.render.step_budget && budget != ProxySettings{}.step_budget) {
        setup.render.step_budget = budget;
    }
    try {
        feel(opened, request);
    } catch (const std::exception& e) {
        const RunRequest& chosen = content_.request();
        if (setup.device == chosen.setup.device && request.others == chosen.others) throw;
        const QString why = QString::fromStdString(app::failure_of(e).text);
        request.use_devices_of(chosen);
        feel(opened, request);
        messages_.show_done(tr("%1; felt through the device %2")
                                .arg(why, QString::fromStdString(run::text_of(setup.device))));
    }
    panel_.look_controls().use_usual_look();
    restore_hands(session, in_place);
    display_.restore_view(session);
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
