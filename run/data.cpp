// Data with an editor, a player or a streamer.
#include "palpate/run/data.hpp"

#include <stdexcept>

#include "palpate/io/raw_options.hpp"
#include "palpate/io/written_formats.hpp"

namespace palpate::run {

void check_volume_name(const std::string& path, const Geometry& geometry) {
    const std::string problem = io::why_not_written(path, geometry);
    if (!problem.empty()) throw std::invalid_argument(problem);
}

Data::Data(LoadedVolume loaded, const PlaybackSetup& playback)
    : loaded_(std::move(loaded)), start_(start_samples(loaded_)) {
    if (loaded_.streamed) {
        streamer_ = std::make_unique<Streamer>(loaded_);
    } else if (loaded_.live) {
        player_ = std::make_unique<Player>(loaded_.live);
    } else if (loaded_.sequence.count() > 1) {
        player_ = std::make_unique<Player>(loaded_.sequence, playback.loader);
    } else {
        editor_ = std::make_unique<VolumeEditor>(start_);
    }
    if (player_) player_->play(playback.speed);
}

VolumeEditor& Data::editor() const {
    if (editor_) return *editor_;
    if (streamer_) {
        throw std::invalid_argument("a volume that is read as it is felt cannot be edited");
    }
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

std::unique_ptr<Servo> Data::attach(Session session, const StartServo& start) {
    if (streamer_) return streamer_->attach(std::move(session), start);
    return player_ ? player_->attach(std::move(session), start)
                   : editor_->attach(std::move(session), start);
}

void Data::detach(const Servo& servo) {
    if (editor_) editor_->detach(servo);
    if (player_) player_->detach(servo);
    if (streamer_) streamer_->detach(servo);
}

stream::BrickLoaderStatus Data::streaming() const {
    return streamer_ ? streamer_->status() : stream::BrickLoaderStatus{};
}

void Data::use_tool(const Servo& servo, std::shared_ptr<const Tool> tool) {
    if (editor_) editor_->use_tool(servo, std::move(tool));
}

std::string Data::problem() const {
    if (streamer_) return streamer_->status().problem;
    return player_ ? player_->state().problem : editor_->state().problem;
}

void Data::require_saving() const {
    if (streamer_) {
        throw std::invalid_argument(
            "a volume that is read as it is felt is not saved: palpate convert copies it");
    }
}

std::string Data::save(const std::filesystem::path& path, const io::Progress& progress) {
    require_saving();
    Field now(start_);
    update(now);
    io::WriteOptions options;
    options.progress = progress;
    const Volume volume = flattened(now.samples(), now.moment());
    io::write_volume(volume, path, options);
    if (editor_) editor_->set_saved(now.shared_samples());
    return "saved " + path.string() + io::opening_words(path, volume);
}

}  // namespace palpate::run
