// Data with either an editor or a player.
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
    : loaded_(std::move(loaded)), start_(std::make_shared<const Samples>(loaded_.volume)) {
    if (loaded_.live) {
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
    throw std::invalid_argument(
        "a sequence cannot be edited: open one frame of it by its time step");
}

Player& Data::player() const {
    if (player_) return *player_;
    throw std::invalid_argument("this volume is no sequence: there is nothing to play");
}

void Data::update(Field& field) const {
    if (player_) return player_->apply_position(field);
    field.use(editor_->state().samples);
}

std::unique_ptr<Servo> Data::attach(Session session, const StartServo& start) {
    return player_ ? player_->attach(std::move(session), start)
                   : editor_->attach(std::move(session), start);
}

void Data::detach(const Servo& servo) {
    if (editor_) editor_->detach(servo);
    if (player_) player_->detach(servo);
}

void Data::use_tool(const Servo& servo, std::shared_ptr<const Tool> tool) {
    if (editor_) editor_->use_tool(servo, std::move(tool));
}

std::string Data::problem() const {
    return player_ ? player_->state().problem : editor_->state().problem;
}

std::string Data::save(const std::filesystem::path& path, const io::Progress& progress) {
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
