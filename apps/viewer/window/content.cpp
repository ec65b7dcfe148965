// Opens and closes runs and playbacks, and notifies the controllers.
#include "apps/viewer/window/content.hpp"

#include <utility>

namespace palpate::viewer {

/// Before anything else hears of it, the effect is that of the run.
Content::Content() {
    connect(this, &Content::run_changed, &effect_, [this] {
        effect_.begin(live_->field(), live_->isovalue(), live_->settings(), live_->device(),
                      volume_->histogram, [this](const Command& command) {
                          if (live_) live_->send(command);
                      });
    });
}

void Content::start_run(std::shared_ptr<Opened> volume, const run::Setup& setup) {
    close();
    auto data = std::make_shared<run::Data>(volume->loaded, setup.playback);
    auto live = std::make_unique<run::Run>(data, setup);
    live->start();
    data_ = std::move(data);
    live_ = std::move(live);
    volume_ = std::move(volume);
    Q_EMIT run_started();
    Q_EMIT run_changed();
}

void Content::start_playback(std::shared_ptr<Opened> volume, Playback playback) {
    close();
    volume_ = std::move(volume);
    playback_ = std::move(playback);
    time_ = playback_->begin();
    const io::RecordingHead& head = playback_->head();
    DeviceInfo device;
    device.name = device.model = head.device;
    device.limits = head.settings.device;
    effect_.begin(playback_->field(), head.isovalue, head.settings, device, volume_->histogram,
                  nullptr);
    Q_EMIT playback_started();
}

void Content::close() {
    Q_EMIT closing();
    live_.reset();
    data_.reset();
    playback_.reset();
    volume_.reset();
    overview_.reset();
    saved_.reset();
    session_.clear();
    effect_.end();
    Q_EMIT closed();
}

void Content::set_saved(const run::Source& source) {
    saved_ = source;
    Q_EMIT renamed();
}

void Content::set_session(const QString& path) {
    session_ = path;
    Q_EMIT renamed();
}

void Content::use_device(const devices::DeviceChoice& device) {
    live_->use_device(device);
    Q_EMIT run_changed();
}

void Content::use_field(Solid solid, Interpolation interpolation) {
    live_->use_field(solid, interpolation);
    Q_EMIT field_replaced();
    Q_EMIT run_changed();
}

run::VolumeEditor* Content::editor() const {
    return live_ && !live_->data().is_sequence() ? &live_->data().editor() : nullptr;
}

run::Player* Content::player() const {
    return live_ && live_->data().is_sequence() ? &live_->data().player() : nullptr;
}

SharedLayers Content::layers() const {
    if (live_) return live_->settings().layers;
    return playback_ ? playback_->layers_at(time_) : nullptr;
}

std::shared_ptr<const Tool> Content::tool() const {
    if (live_) return live_->settings().tool;
    return playback_ ? playback_->tool_at(time_) : nullptr;
}

Content::OuterSurface Content::outer_surface() {
    const SharedLayers now = layers();
    if (levels_in(now) > 0) return {seen(felt()), now->layers.front().level};
    if (!have_surfaces(now)) return {seen(felt()), live_->isovalue()};
    return {labelled_space(*now), 0.5};
}

std::optional<Snapshot> Content::snapshot() const {
    if (live_) return live_->snapshot();
    if (playback_) return playback_->at(time_);
    return std::nullopt;
}

Field Content::felt() const {
    return live_ ? live_->field_now() : playback_->field();
}

Field Content::felt_at(const Snapshot& snapshot) {
    Field field = live_ ? live_->field_now() : playback_->field_at(snapshot);
    field.set_time(snapshot.session.moment);
    return field;
}

Field Content::seen(Field felt) {
    if (!felt.samples().resident()) return felt;
    if (!overview_) overview_.emplace(felt.volume());
    return Field(overview_->of(felt.samples()), felt.solid(), felt.background(),
                 felt.interpolation());
}

std::optional<Field> Content::felt_round(const Snapshot& snapshot, const Vec3& point) {
    Field field = felt_at(snapshot);
    if (!is_resident(field, point, 0)) return std::nullopt;
    return field;
}

}  // namespace palpate::viewer
