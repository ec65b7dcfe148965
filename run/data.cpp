// Data with an editor, a player or a streamer.
#include "palpate/run/data.hpp"

#include <algorithm>
#include <cstdlib>
#include <random>
#include <stdexcept>

#include "io/system/system.hpp"
#include "palpate/io/error.hpp"
#include "palpate/io/output.hpp"
#include "palpate/io/raw_options.hpp"
#include "palpate/io/sequence.hpp"
#include "palpate/io/written_formats.hpp"
#include "palpate/stream/convert.hpp"
#include "palpate/stream/edits.hpp"
#include "palpate/stream/read_files.hpp"

namespace palpate::run {
namespace {

bool is_zarr(const std::filesystem::path& path) {
    const std::filesystem::path name = io::without_slash(path);
    return name.extension() == ".zarr" && !name.stem().empty();
}

std::vector<std::filesystem::path> places_of_rescue() {
    std::vector<std::filesystem::path> places;
    std::error_code error;
    const auto temporary = std::filesystem::temp_directory_path(error);
    if (!error) places.push_back(temporary);
    if (const char* home = std::getenv("HOME")) places.emplace_back(home);
    places.emplace_back(".");
    return places;
}

/// With access for this user only: in a folder of temporary files, others could put links.
std::filesystem::path new_folder_in(const std::filesystem::path& place) {
    std::random_device random;
    std::filesystem::path folder;
    do {
        folder = place / ("palpate-edits-" + std::to_string(random()));
    } while (!std::filesystem::create_directory(folder));
    (void)io::give_mode(folder, std::filesystem::perms::owner_all);
    return folder;
}

}  // namespace

void check_volume_name(const std::string& path, const Geometry& geometry) {
    if (is_zarr(path)) return;
    const std::string problem = io::why_not_written(path, geometry);
    if (!problem.empty()) throw std::invalid_argument(problem);
}

Data::Data(LoadedVolume loaded, const PlaybackSetup& playback, Pace pace)
    : pace_(pace), loaded_(std::move(loaded)), start_(start_samples(loaded_)) {
    if (loaded_.streamed) {
        streamer_ = std::make_unique<Streamer>(loaded_, pace);
        editor_ = std::make_unique<VolumeEditor>(start_, *streamer_,
                                                 loaded_.streamed->loader.memory, pace);
    } else if (loaded_.live) {
        player_ = std::make_unique<Player>(loaded_.live, pace);
    } else if (loaded_.sequence.count() > 1) {
        player_ = std::make_unique<Player>(loaded_.sequence, playback.loader, pace);
    } else {
        editor_ = std::make_unique<VolumeEditor>(start_, pace);
    }
    if (player_) player_->play(playback.speed);
}

void Data::step(std::chrono::steady_clock::time_point now) {
    if (player_) player_->step(now);
    if (editor_) editor_->step(now);
    if (streamer_) streamer_->step(now);
}

bool Data::is_settled() const {
    if (player_) return player_->is_settled();
    return !streamer_ || streamer_->status().missing == 0;
}

VolumeEditor& Data::editor() const {
    if (editor_) return *editor_;
    throw std::invalid_argument(
        "a sequence cannot be edited: open one frame of it by its time step");
}

Player& Data::player() const {
    if (player_) return *player_;
    throw std::invalid_argument("this volume is no sequence: there is nothing to play");
}

void Data::update(Field& field) const {
    if (player_) return player_->apply_position(field);
    if (streamer_) return field.use(streamer_->samples());
    field.use(editor_->state().samples);
}

void Data::check_recording() const {
    if (!editor_ || editor_->knows_history()) return;
    throw io::OutputError(
        "more edits were made than a recording can begin with: save them, open the result, and "
        "record that");
}

std::unique_ptr<Servo> Data::attach(Session session, const StartServo& start) {
    return player_ ? player_->attach(std::move(session), start)
                   : editor_->attach(std::move(session), start);
}

void Data::detach(const Servo& servo) {
    if (editor_) editor_->detach(servo);
    if (player_) player_->detach(servo);
}

void Data::record(const Servo& servo, const BeginRecording& begin) {
    player_ ? player_->record(servo, begin) : editor_->record(servo, begin);
}

stream::BrickLoaderStatus Data::streaming() const {
    return streamer_ ? streamer_->status() : stream::BrickLoaderStatus{};
}

void Data::rest_brush(const Servo& servo, const std::shared_ptr<const Tool>& tool) {
    if (editor_) editor_->rest_brush(servo, tool);
}

std::string Data::problem() const {
    const std::string missing = streamer_ ? streamer_->status().problem : "";
    if (!missing.empty()) return missing;
    return player_ ? player_->state().problem : editor_->state().problem;
}

void Data::keep(const std::filesystem::path& path) {
    const std::lock_guard lock(mutex_);
    kept_.push_back(path);
}

void Data::release(const std::filesystem::path& path) {
    const std::lock_guard lock(mutex_);
    const auto at = std::find(kept_.begin(), kept_.end(), path);
    if (at != kept_.end()) kept_.erase(at);
}

void Data::require_unused(const std::filesystem::path& path) const {
    const std::filesystem::path own = place_of(loaded_.source);
    const std::lock_guard lock(mutex_);
    const auto is_used = [&](const auto& used) {
        return !used.empty() && stream::is_read_from(path, used);
    };
    if (!is_used(own) && std::none_of(kept_.begin(), kept_.end(), is_used)) return;
    throw io::OutputError(path.string() +
                          " is in use and would be replaced: choose another output");
}

void Data::check_save_name(const std::string& path) const {
    require_unused(path);
    if (streamer_) return stream::check_edits_place(path, loaded_.streamed->opened);
    check_volume_name(path, start_->geometry());
    is_zarr(path) ? stream::check_zarr_place(path) : io::check_output(path);
}

bool Data::is_edited() const {
    if (!editor_) return false;
    const EditState state = editor_->state();
    return state.changed || (state.samples->bricks() && state.samples->bricks()->size() > 0);
}

void Data::require_saving() const {
    if (streamer_ && !is_edited()) {
        throw std::invalid_argument("nothing was edited: palpate convert copies the volume");
    }
}

io::VolumeIdentity Data::identity(const OnProgress& progress) const {
    const std::lock_guard lock(identifying_);
    if (!identity_) identity_ = io::identify(start_->volume(), to_names(loaded_.source), progress);
    return *identity_;
}

std::string Data::save(const std::filesystem::path& path, const io::Progress& progress) {
    require_saving();
    require_unused(path);
    if (streamer_) return save_edits(path, progress);
    Field now = linear_field(start_);
    update(now);
    const Volume volume = flattened(now.samples(), now.moment(), [&](double) {
        if (progress) progress(0);
    });
    if (is_zarr(path)) {
        stream::ConvertOptions options;
        options.progress = progress;
        options.resumable = false;
        stream::convert_to_zarr(*stream::store_of(volume, loaded_.name), 0, path, options);
    } else {
        io::WriteOptions options;
        options.progress = progress;
        io::write_volume(volume, path, options);
    }
    if (editor_) editor_->set_saved(now.shared_samples());
    return "saved " + path.string() + io::opening_words(path, volume);
}

std::filesystem::path Data::rescue(const io::Progress& progress) {
    // Reads nothing of the original, because a silent server would keep the edits waiting.
    if (loaded_.streamed) loaded_.streamed->opened.is_rescue = true;
    std::string problems;
    for (const std::filesystem::path& place : places_of_rescue()) {
        std::filesystem::path folder;
        const auto remove_empty = [&] {
            std::error_code ignored;
            if (!folder.empty()) std::filesystem::remove(folder, ignored);
        };
        try {
            folder = new_folder_in(place);
            std::filesystem::path kept = folder / (streamer_ ? "edits.zarr" : "edits.nrrd");
            save(kept, progress);
            return kept;
        } catch (const std::exception& e) {
            problems += (problems.empty() ? "" : "; ") + std::string(e.what());
            remove_empty();
        } catch (...) {  // of `progress`
            remove_empty();
            throw;
        }
    }
    throw io::OutputError(problems);
}

/// Saves the edits of a store, beside it.
std::string Data::save_edits(const std::filesystem::path& path, const io::Progress& progress) {
    const auto& from = std::get<StoreSource>(loaded_.source.from);
    const std::shared_ptr<const Samples> edits = editor_->state().samples;
    stream::save_edits(*loaded_.streamed->store, loaded_.streamed->opened, from.loader.level,
                       *edits, path, progress);
    editor_->set_saved(edits);
    return "saved the edits of " + io::without_secrets(from.address) + " as " + path.string() +
           ": it opens as the edited volume while the original stays where it is";
}

}  // namespace palpate::run
