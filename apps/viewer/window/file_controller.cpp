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
#include "apps/viewer/window/layers_controller.hpp"
#include "apps/viewer/window/measure_controller.hpp"
#include "apps/viewer/window/messages.hpp"
#include "apps/viewer/window/open_dialogs.hpp"
#include "apps/viewer/window/recording_controller.hpp"
#include "apps/viewer/window/run_controller.hpp"
#include "palpate/io/address.hpp"
#include "palpate/io/sample_volume.hpp"

namespace palpate::viewer {
namespace {

std::filesystem::path path_of(const QString& name) {
    return std::filesystem::path(name.toStdString());
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

FileController::FileController(const Desk& desk, RunController& run, LayersController& layers,
                               RecordingController& recordings, DisplayController& display,
                               MeasureController& measuring)
    : Controller(desk),
      run_(run),
      layers_(layers),
      recordings_(recordings),
      display_(display),
      measuring_(measuring),
      loader_(messages_) {}

void FileController::guard(std::function<UnsavedWork()> unsaved,
                           std::function<void(const std::function<void()>&)> settle) {
    unsaved_ = std::move(unsaved);
    settle_ = std::move(settle);
}

void FileController::read(const QString& label, Worker::Task task, std::function<void()> then) {
    loader_.start(label, std::move(task), [this, before = unsaved_(), then = std::move(then)] {
        unsaved_() == before ? then() : settle_(then);
    });
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
    auto* dialog = new SeriesDialog(name, choice.series(), messages_.window());
    connect(dialog, &QDialog::accepted, this, [this, dialog, source, then] {
        run::Source chosen = source;
        std::get<run::FileSource>(chosen.from).series = std::to_string(dialog->chosen());
        load(chosen, then);
    });
    messages_.ask(dialog, QString::fromStdString(choice.what()));
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
    if (LayersController::is_layers_file(path)) return layers_.open(path);
    if (path.endsWith(".json", Qt::CaseInsensitive)) return open_session(path);
    if (path.endsWith(".csv", Qt::CaseInsensitive)) return open_recording(path);
    messages_.guarded([&] {
        // Looks at what it is: a store is felt while it is read.
        const run::Source source = run::source_from({{"volume", path.toStdString()}});
        lacks_layout(source) ? ask_layout(source) : open_volume(source);
    });
}

void FileController::ask_layout(const run::Source& source) {
    auto* dialog = new RawDialog(QString::fromStdString(name_of(source)), messages_.window());
    connect(dialog, &QDialog::accepted, this, [this, dialog, source] {
        run::Source known = source;
        known.from = dialog->layout_source();
        open_volume(known);
    });
    messages_.ask(dialog);
}

void FileController::ask_address() {
    auto* dialog = new StoreDialog(std::nullopt, 0, messages_.window());
    connect(dialog, &QDialog::accepted, this, [this, dialog] { open_volume(dialog->source()); });
    messages_.ask(dialog);
}

void FileController::ask_level() {
    if (!content_.live()) return;
    const run::Source felt = content_.source();
    const auto* store = std::get_if<run::StoreSource>(&felt.from);
    if (!store) return;
    auto* dialog = new StoreDialog(*store, felt.frame.value_or(0), messages_.window());
    connect(dialog, &QDialog::accepted, this, [this, dialog, channel = store->options.channel] {
        const run::Source chosen = dialog->source();
        const bool same = std::get<run::StoreSource>(chosen.from).options.channel == channel;
        same ? feel_again(chosen) : open_volume(chosen);
    });
    messages_.ask(dialog);
}

void FileController::open_volume(const run::Source& source) {
    messages_.forget();
    load(source, [this, request = run_.take_request()](std::shared_ptr<Opened> opened) mutable {
        request.use_devices_of(run_.request());
        run::Setup& setup = request.setup;
        if (!setup.field.isovalue && !setup.render.layers) {
            setup.field.isovalue = first_isovalue(*opened);
        }
        feel(std::move(opened), request);
        display_.use_usual_look();
    });
}

void FileController::open_sample() {
    messages_.guarded([&] {
        const std::string path = io::sample_volume_path().string();
        run_.set_first_isovalue(io::sample_volume_skin);
        open_volume(run::source_named(path));
    });
}

void FileController::feel(std::shared_ptr<Opened> opened, const RunRequest& request) {
    run_.start(opened, request.setups());
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
    if (!content_.live()) return;
    run::Source source = content_.source();
    const auto& terraces = content_.volume()->terraces;
    const int rounds = terraces ? terraces->rounds() : filters::DequantizeOptions{}.rounds;
    source.dequantize = on ? rounds : 0;
    feel_again(source);
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
    RunRequest request = run_.take_request();
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
        (void)run_.take_request();  // they were for a volume to feel
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
            if (!same) display_.use_usual_look();
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
        shown.isovalue = display_.isovalue().value_or(shown.isovalue);
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
        session.device = run_.request().setup.device;
        for (const devices::DeviceChoice& device : run_.request().others) {
            const Playback* other = content_.playback(2);
            session.others.push_back({device, (other ? other->head() : head).isovalue, {}});
        }
        session.method = run::named_method(head.method);
        session.buttons = run_.request().setup.buttons;
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

void FileController::open_session(const QString& path) {
    messages_.forget();
    messages_.guarded([&] {
        const SessionFile session = read_session(path.toStdString());
        load_or_reuse(session.source, [this, session, path, request = run_.take_request()](
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
        run_.set_devices(request);
    } catch (const std::exception& e) {
        const RunRequest& chosen = run_.request();
        if (setup.device == chosen.setup.device && request.others == chosen.others) throw;
        const QString why = QString::fromStdString(app::failure_of(e).text);
        request.use_devices_of(chosen);
        feel(opened, request);
        messages_.show_done(tr("%1; felt through the device %2")
                                .arg(why, QString::fromStdString(run::text_of(setup.device))));
    }
    display_.use_usual_look();
    restore_hands(session, in_place);
    display_.restore_view(session);
}

void FileController::restore_hands(const SessionFile& session, bool in_place) {
    if (session.settings) run_.restore(*session.settings, in_place);
    int hand = 1;
    for (const SessionHand& other : session.others) {
        if (!content_.live(++hand)) break;  // its device cannot be had
        content_.choose_hand(hand);
        content_.effect().request(command::Isovalue{other.isovalue});
        if (other.settings) run_.restore(*other.settings, in_place);
    }
    content_.choose_hand(1);
}

}  // namespace palpate::viewer
