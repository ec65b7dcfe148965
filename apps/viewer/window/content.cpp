// Opens and closes runs and playbacks, and notifies the controllers.
#include "apps/viewer/window/content.hpp"

#include <stdexcept>
#include <utility>

#include "apps/viewer/scene/threads.hpp"
#include "apps/viewer/window/desk.hpp"
#include "devices/claim.hpp"

namespace palpate::viewer {

Effect& Desk::effect() const {
    return content_.effect();
}

std::vector<run::Setup> RunRequest::setups() const {
    std::vector<run::Setup> hands(1 + others.size(), setup);
    for (std::size_t i = 0; i < others.size(); ++i) hands[i + 1].device = others[i];
    return hands;
}

void RunRequest::use_devices_of(const RunRequest& other) {
    setup.device = other.setup.device;
    setup.buttons = other.setup.buttons;
    others = other.others;
}

/// Before anything else hears of it, the effect is that of the run.
Content::Content(RunRequest request) : request_(std::move(request)) {
    connect(this, &Content::run_changed, &effect_, [this] { begin_effect(); });
}

RunRequest& Content::request() {
    if (!live(1)) return request_;
    request_.setup.device = live(1)->setup().device;
    request_.setup.buttons = live(1)->setup().buttons;
    request_.others.clear();
    for (int hand = 2; live(hand); ++hand) request_.others.push_back(live(hand)->setup().device);
    return request_;
}

RunRequest Content::take_request() {
    RunRequest taken = request();
    request_.setup.field.isovalue.reset();
    request_.setup.render.layers.reset();
    request_.record.clear();
    return taken;
}

/// Of the chosen hand.
void Content::begin_effect() {
    if (const run::Run* run = live()) {
        return effect_.begin(run->field(), run->isovalue(), run->settings(), run->device(),
                             volume_->histogram, [this](const Command& command) {
                                 if (live()) live()->send(command);
                             });
    }
    const io::RecordingHead& head = playback()->head();
    DeviceInfo device;
    device.name = device.model = head.device;
    device.limits = head.settings.device;
    effect_.begin(playback()->field(), head.isovalue, head.settings, device, volume_->histogram,
                  nullptr);
}

LiveHand LiveHand::with(std::shared_ptr<run::Data> data, run::Setup setup,
                        std::shared_ptr<const HandKey> key, std::function<void()> close,
                        const OnProgress& progress) {
    // The run keeps its setup, but `close` is only for now.
    const auto close_now = std::make_shared<std::function<void()>>(std::move(close));
    setup.open_device = [open = setup.open_device, key, close_now](const auto& choice,
                                                                   const auto& scene) {
        const devices::OpenedBy opened_by(key.get(), *close_now);
        return open(choice, scene);
    };
    auto run = std::make_unique<run::Run>(std::move(data), setup, progress);
    *close_now = nullptr;
    return {std::move(key), std::move(run)};
}

std::vector<LiveHand> make_hands(const Opened& volume, const std::vector<run::Setup>& setups,
                                 const OnProgress& progress) {
    const auto data = std::make_shared<run::Data>(volume.loaded, setups.front().playback);
    std::vector<LiveHand> hands;
    for (const run::Setup& setup : setups) {
        hands.push_back(LiveHand::with(data, setup, new_key(), {}, progress));
    }
    return hands;
}

void Content::start_run(std::shared_ptr<Opened> volume, std::vector<LiveHand>&& hands) {
    close();
    for (const LiveHand& hand : hands) hand.run->start();
    data_ = hands.front().run->shared_data();
    hands_ = std::move(hands);
    volume_ = std::move(volume);
    Q_EMIT run_started();
    Q_EMIT run_changed();
}

void Content::start_playback(std::shared_ptr<Opened> volume, std::vector<Playback> hands) {
    close();
    volume_ = std::move(volume);
    playbacks_ = std::move(hands);
    time_ = playback()->begin();
    begin_effect();
    Q_EMIT playback_started();
}

void Content::choose_hand(int hand) {
    if (hand == hand_ || hand < 1 || hand > hands()) return;
    if (playback()) time_ = time_of(hand);
    hand_ = hand;
    if (live()) {
        Q_EMIT run_changed();
    } else {
        begin_effect();
    }
    Q_EMIT hand_changed();
}

run::Setup Content::setup_with(const devices::DeviceChoice& device) const {
    run::Setup setup = live()->setup();
    setup.open_device = request_.setup.open_device;
    setup.device = device;
    const Field& field = live()->field();
    setup.field = {field.solid(), field.background(), live()->isovalue(), field.interpolation()};
    // Layers have levels of their own.
    const auto& layers = setup.render.layers;
    if (layers && !layers->layers.by_label) setup.field.isovalue.reset();
    return setup;
}

void Content::add_hand(LiveHand&& hand) {
    if (!live() || hands() == most_hands) return;
    hand.run->start_beside(*live(1));
    hands_.push_back(std::move(hand));
    choose_hand(hands());
    Q_EMIT device_changed();
}

void Content::replace_hand(LiveHand&& next, std::function<void()> closed) {
    const auto at = std::ranges::find(hands_, next.key, &LiveHand::key);
    if (at == hands_.end()) {
        if (closed) closed();
        return;
    }
    next.run->start_as(*at->run);
    std::swap(*at, next);
    std::vector<LiveHand> old;
    old.push_back(std::move(next));
    close_runs(std::move(old), std::move(closed));
    Q_EMIT run_changed();
    Q_EMIT device_changed();
}

void Content::remove_hand() {
    if (hands_.size() < 2) return;
    const auto removed = hands_.begin() + (hand_ - 1);
    std::vector<LiveHand> old;
    old.push_back(std::move(*removed));
    hands_.erase(removed);
    close_runs(std::move(old));
    hand_ = 1;
    Q_EMIT run_changed();
    Q_EMIT hand_changed();
}

void Content::close_runs(std::vector<LiveHand> hands, std::function<void()> closed) {
    if (hands.empty()) return;
    std::vector<std::unique_ptr<run::Run>> runs;
    for (LiveHand& hand : hands) runs.push_back(std::move(hand.run));
    const auto ended = [this](const RunCloser::Ended& how) {
        hand_over(this, [this, how] { Q_EMIT runs_ended(how); });
    };
    closer_.close(std::move(runs), ended, std::move(closed));
}

void Content::end_run() {
    close_runs(std::exchange(hands_, {}));
}

void Content::close() {
    Q_EMIT closing();
    request();  // with the devices of these runs
    end_run();
    data_.reset();
    playbacks_.clear();
    hand_ = 1;
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

/// A servo in whose thread a driver hangs cannot begin a session anew.
void Content::require_devices() const {
    for (const LiveHand& hand : hands_) {
        if (hand.run->device_failure() != DeviceFailure::hung) continue;
        throw std::invalid_argument(hand.run->device().name + ": " + hand.run->device_problem());
    }
}

void Content::use_buttons(const run::Buttons& buttons) {
    require_devices();
    const run::Buttons before = live()->setup().buttons;
    const auto use = [this](const run::Buttons& wanted) {
        for (const LiveHand& hand : hands_) {
            if (hand.run->setup().buttons != wanted) hand.run->use_buttons(wanted);
        }
    };
    try {
        use(buttons);
    } catch (const std::invalid_argument&) {
        use(before);  // where another hand has a button that this one has not
        throw;
    }
    Q_EMIT run_changed();
}

void Content::use_field(Solid solid, Interpolation interpolation) {
    require_devices();
    for (const LiveHand& hand : hands_) hand.run->use_field(solid, interpolation);
    Q_EMIT field_replaced();
    Q_EMIT run_changed();
}

run::VolumeEditor* Content::editor() const {
    return live() && !data_->is_sequence() ? &data_->editor() : nullptr;
}

run::Player* Content::player() const {
    return live() && data_->is_sequence() ? &data_->player() : nullptr;
}

SharedLayers Content::layers(int hand) const {
    if (live(hand)) return live(hand)->settings().layers;
    return playback(hand) ? playback(hand)->layers_at(time_of(hand)) : nullptr;
}

void Content::use_layers(const std::map<int, SharedLayers>& by_hand) {
    const int chosen = hand_;
    for (const auto& [hand, layers] : by_hand) {
        if (!live(hand)) continue;
        choose_hand(hand);
        effect_.request(command::UseLayers{layers});
    }
    choose_hand(chosen);
    if (live()) Q_EMIT run_changed();
}

std::shared_ptr<const Tool> Content::tool(int hand) const {
    if (live(hand)) return live(hand)->settings().tool;
    return playback(hand) ? playback(hand)->tool_at(time_of(hand)) : nullptr;
}

Content::OuterSurface Content::outer_surface() {
    const SharedLayers now = layers();
    if (levels_in(now) > 0) return {seen(felt()), now->layers.front().level};
    if (!have_surfaces(now)) return {seen(felt()), live()->isovalue()};
    return {labelled_space(*now), 0.5};
}

std::optional<Snapshot> Content::snapshot(int hand) const {
    if (live(hand)) return live(hand)->snapshot();
    if (playback(hand)) return playback(hand)->at(time_of(hand));
    return std::nullopt;
}

/// That which is shown, by the clock of this hand.
double Content::time_of(int hand) const {
    return time_ + playback()->clock() - playback(hand)->clock();
}

HandSnapshots Content::snapshots() const {
    HandSnapshots all;
    for (int hand = 1; hand <= hands(); ++hand) all[hand] = snapshot(hand);
    return all;
}

Field Content::felt() const {
    return live() ? live()->field_now() : playback()->field();
}

Field Content::felt_at(const Snapshot& snapshot) {
    Field field = live() ? live()->field_now() : playback()->field_at(snapshot);
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
