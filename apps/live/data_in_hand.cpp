// Which of the two it is.
#include "apps/live/data_in_hand.hpp"

#include <stdexcept>

#include "palpate/io/raw_options.hpp"
#include "palpate/io/written_formats.hpp"

namespace palpate::app {

void check_volume_name(const std::string& path, const Geometry& geometry) {
    const std::string problem = io::why_not_written(path, geometry);
    if (!problem.empty()) throw std::invalid_argument(problem);
}

DataInHand::DataInHand(const LoadedVolume& loaded, const Field& field,
                       const io::LoaderSettings& settings)
    : field_(field) {
    if (loaded.live) {
        player_ = std::make_unique<Player>(loaded.live);
    } else if (loaded.sequence.count() > 1) {
        player_ = std::make_unique<Player>(loaded.sequence, settings);
    } else {
        sculptor_ = std::make_unique<Sculptor>(field);
    }
}

Sculptor& DataInHand::sculptor() const {
    if (sculptor_) return *sculptor_;
    throw std::invalid_argument(
        "a sequence cannot be edited: open one frame of it (--time-step N)");
}

Player& DataInHand::player() const {
    if (player_) return *player_;
    throw std::invalid_argument("this volume is no sequence: there is nothing to play");
}

Field DataInHand::field() const {
    Session session{{field_, {}, {}, {}}, {}};
    bring(session);
    return session.renderer.field;
}

void DataInHand::set_field(const Field& field) {
    field_ = field;
    if (sculptor_) sculptor_->set_field(field);
}

void DataInHand::attach(Servo* servo) {
    if (sculptor_) sculptor_->attach(servo);
    if (player_) player_->attach(servo);
}

void DataInHand::bring(Session& session) const {
    if (player_) return player_->bring(session);
    const Work work = sculptor_->work();
    apply(session, command::Samples{work.samples, work.version});
}

std::vector<Command> DataInHand::history() const {
    if (player_) return player_->history();
    const auto versions = sculptor_->history();
    return {versions.begin(), versions.end()};
}

std::string DataInHand::save(const std::filesystem::path& path, const io::Progress& progress) {
    const Field now = field();
    io::WriteOptions options;
    options.progress = progress;
    const Volume volume = flattened(now.samples(), now.moment());
    io::write_volume(volume, path, options);
    if (sculptor_) sculptor_->set_saved(now.shared_samples());
    return "saved " + path.string() + io::opening_words(path, volume);
}

}  // namespace palpate::app
