// Reads files, then starts the live run or the playback that they describe.
#include "apps/viewer/window/file_controller.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "apps/viewer/model/opening.hpp"
#include "apps/viewer/panel/sentences.hpp"
#include "apps/viewer/window/connector.hpp"
#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/device_controls.hpp"
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
#include "palpate/run/beside.hpp"

namespace palpate::viewer {
namespace {

std::filesystem::path path_of(const QString& name) {
    return std::filesystem::path(name.toStdString());
}

/// A session or layers.
bool is_json(const QString& path) {
    return path.endsWith(".json", Qt::CaseInsensitive);
}

/// The tool of a mesh, whose points take time. Nothing for other tools, and for one that cannot be
/// made: the run says why.
std::optional<io::PointsSpec> points_of(const run::RenderSetup& setup,
                                        const run::LoadedVolume& loaded,
                                        const io::Progress& progress) {
    if (loaded.streamed || !std::holds_alternative<io::MeshSpec>(setup.tool)) return std::nullopt;
    const double usual = io::usual_spacing(loaded.volume.geometry());
    try {
        const auto tool = io::make_tool(setup.tool, setup.tool_spacing.value_or(usual), progress);
        return io::PointsSpec{
            {tool->points().begin(), tool->points().end()}, tool->turns(), tool->shape()};
    } catch (const std::invalid_argument&) {
        return std::nullopt;
    }
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

/// Only the name of the label volume stays, as in a session file.
void forget_labels(SessionHand& hand) {
    if (!hand.settings || !hand.settings->layers || !hand.settings->layers->labels) return;
    Layers layers = *hand.settings->layers;
    layers.labels.reset();
    hand.settings->layers = std::make_shared<const Layers>(std::move(layers));
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
      reader_(messages_),
      loader_(messages_) {
    connect(&panel_.isovalue_controls(), &IsovalueControls::dequantize_wanted, this,
            &FileController::dequantize);
}

/// What is open can be changed meanwhile, which is asked about then.
std::function<void()> FileController::unless_changed(const std::optional<UnsavedWork>& before,
                                                     std::function<void()> then) {
    return [this, before, then = std::move(then)] {
        before == unsaved_work() ? then() : settle_work(then);
    };
}

void FileController::read(BackgroundTask& reader, const QString& path, Worker::Task task,
                          std::function<void()> then) {
    reader_.abandon();  // it was for another file
    reader.start(tr("Reading %1").arg(short_name(path)), std::move(task),
                 unless_changed(unsaved_work(), std::move(then)));
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
        loader_, QString::fromStdString(name_of(source)),
        [result, source, render = content_.request().setup.render](const io::Progress& progress) {
            try {
                result->opened = std::make_shared<Opened>(open(source, progress));
                result->opened->tool = points_of(render, result->opened->loaded, progress);
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
    reader_.abandon();
    loader_.abandon();
    messages_.guarded([&] { then(opened); });
}

void FileController::open_path(const QString& path) {
    remember_folder(path);
    if (is_json(path)) return open_session(path);
    if (path.endsWith(".csv", Qt::CaseInsensitive)) return open_recording(path);
    messages_.guarded([&] {
        // Looks at what it is: a store is felt while it is read.
        const run::Source source = run::source_from({{"volume", path.toStdString()}});
        lacks_layout(source) ? ask_layout(source) : open_volume(source);
    });
}

void FileController::open_dropped(const QString& path) {
    if (!is_json(path)) return settle_work([this, path] { open_path(path); });
    remember_folder(path);
    open_json(path, std::nullopt);
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
    messages_.ask(
        make_grid_dialog(grid, run::given_grid(content_.source()), messages_.window(), use));
}

void FileController::open_volume(const run::Source& source) {
    messages_.forget();
    load(source, [this, request = content_.take_request()](std::shared_ptr<Opened> opened) mutable {
        request.use_devices_of(content_.request());
        run::Setup& setup = request.setup;
        if (!setup.field.isovalue && !setup.render.layers) {
            setup.field.isovalue = first_isovalue(*opened);
        }
        feel(std::move(opened), request, [this] { panel_.look_controls().use_usual_look(); });
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

bool FileController::loading() const {
    return reader_.busy() || loader_.busy() || panel_.device_controls().connector().task().busy();
}

void FileController::tell_felt(const Opened& opened, const std::vector<run::Setup>& hands) {
    QStringList names;
    for (const run::Setup& hand : hands) names << QString::fromStdString(run::text_of(hand.device));
    QString words = names.size() == 1 ? tr("Felt through the device %1").arg(names.front())
                                      : tr("Felt through the devices %1").arg(names.join(", "));
    for (const std::string& sentence : content_.live()->privileges()) {
        words += "; " + in_words(sentence);
    }
    messages_.show_done(words);
    Q_EMIT content_.device_changed();
    remember_file(QString::fromStdString(io::address_to_keep(opened.loaded.name)));
    for (const std::string& note : opened.loaded.notes) {
        messages_.show_done(QString::fromStdString(note));
    }
    tell_choices(opened);
}

/// As Connector::feel().
void FileController::feel(std::shared_ptr<Opened> opened, const RunRequest& request,
                          std::function<void()> then,
                          std::function<void(const std::exception_ptr&)> otherwise) {
    std::vector<run::Setup> hands = request.setups();
    for (run::Setup& hand : hands) {
        if (opened->tool && std::holds_alternative<io::MeshSpec>(hand.render.tool)) {
            hand.render.tool = *opened->tool;
        }
    }
    const auto felt = [=, this, record = QString::fromStdString(request.record)] {
        tell_felt(*opened, hands);
        if (!record.isEmpty()) recordings_.start(record);
        then();
    };
    panel_.device_controls().connector().feel(opened, hands, felt, std::move(otherwise));
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
    const auto read_again = [this, on] {
        if (!content_.live()) return;
        run::Source source = content_.source();
        const auto& terraces = content_.volume()->terraces;
        const int rounds = terraces ? terraces->rounds() : filters::DequantizeOptions{}.rounds;
        source.dequantize = on ? rounds : 0;
        feel_again(source);
    };
    if (saver_.may_lose_edits(read_again)) read_again();
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

/// Devices and settings are those in use, whatever the command line named.
RunRequest FileController::request_for_same() {
    RunRequest request = content_.take_request();
    request.device.reset();
    request.buttons.clear();
    request.named_settings = {};
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
    // Labels are read again, and lie beside the volume as it lies now.
    forget_labels(session);
    for (SessionHand& other : session.others) forget_labels(other);
    load(session.source,
         [this, session, request = request_for_same()](std::shared_ptr<Opened> opened) {
             feel_session(
                 std::move(opened), session, request,
                 [this, session] { layers_.restore(session, {}); }, false);
         });
}

void FileController::open_recording(const QString& path) {
    messages_.forget();
    const auto source = std::make_shared<run::Source>();
    read(
        reader_, path,
        [source, path](const io::Progress&) {
            *source = run::recorded_source(io::read_recording_head(path_of(path)), path_of(path));
        },
        [this, source, path] {
            (void)content_.take_request();  // they were for a volume to feel
            load_or_reuse(*source, [this, path](std::shared_ptr<Opened> opened) {
                play(std::move(opened), path);
            });
        });
}

void FileController::play(std::shared_ptr<Opened> opened, const QString& path) {
    auto result = std::make_shared<std::vector<Playback>>();
    read(
        loader_, path,
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
    feel_session(content_.volume(), session, request_for_same(), [this, layers] {
        if (!layers.empty()) content_.use_layers(layers);
    });
}

}  // namespace palpate::viewer
