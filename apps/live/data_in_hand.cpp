// Which of the two it is.
#include "apps/live/data_in_hand.hpp"

#include <stdexcept>

namespace palpate::app {

void check_volume_name(const std::string& path) {
    for (const char* end : {".nrrd", ".nhdr", ".mha", ".mhd", ".nii", ".nii.gz", ".vti"}) {
        if (path.ends_with(end)) return;
    }
    throw std::invalid_argument(path +
                                ": a volume is written as .nrrd, .nhdr, .mha, .mhd, .nii, .nii.gz "
                                "or .vti: name one of these");
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

void DataInHand::save(const std::filesystem::path& path, const io::Progress& progress) {
    const Field now = field();
    io::WriteOptions options;
    options.progress = progress;
    io::write_volume(flattened(now.samples(), now.moment()), path, options);
    if (sculptor_) sculptor_->set_saved(now.shared_samples());
}

}  // namespace palpate::app
