// What is open in the window: a volume, and with it either a live run, in which it is felt, or the
// playback of a recording. Both have a hand or two, one of which is chosen: the panel shows its
// settings, and commands are for it. Also the request for the next run.
#pragma once

#include <QObject>
#include <QString>
#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/viewer/model/hands.hpp"
#include "apps/viewer/model/layer_set.hpp"
#include "apps/viewer/model/opening.hpp"
#include "apps/viewer/model/playback.hpp"
#include "apps/viewer/model/run_closer.hpp"
#include "apps/viewer/panel/effect.hpp"
#include "palpate/run/run.hpp"

namespace palpate::viewer {

/// Settings from the command line for the runs to come, and the devices used last.
struct RunRequest {
    run::Setup setup;
    /// The device of the command line: used instead of those in a session file, with `others`.
    std::optional<devices::DeviceChoice> device = {};
    std::string record = {};  ///< recording to write; empty: none
    /// Of the hands beside the first.
    std::vector<devices::DeviceChoice> others = {};
    /// The buttons that the command line names: used instead of those in a session file.
    std::vector<std::pair<run::ButtonSetup run::Buttons::*, run::ButtonSetup>> buttons = {};

    /// Puts the values that the command line names into the settings of a session file; may be
    /// empty.
    std::function<void(RendererSettings&)> named_settings = {};

    std::vector<run::Setup> setups() const;
    void use_devices_of(const RunRequest& other);
};

/// Its address is that of one hand.
struct HandKey {};

/// A hand of a live run.
struct LiveHand {
    /// Opens its device, on any thread; `close` closes the one that the hand has, if that is the
    /// same. Throws as run::Run.
    static LiveHand with(std::shared_ptr<run::Data> data, run::Setup setup,
                         std::shared_ptr<const HandKey> key, std::function<void()> close,
                         const OnProgress& progress = {});

    std::shared_ptr<const HandKey> key;  ///< by which devices know the hand that they serve
    std::unique_ptr<run::Run> run;
};
/// For a new hand.
inline std::shared_ptr<const HandKey> new_key() {
    return std::make_shared<const HandKey>();
}
/// The hands of a volume, not started. On any thread; throws as run::Run.
std::vector<LiveHand> make_hands(const Opened& volume, const std::vector<run::Setup>& setups,
                                 const OnProgress& progress = {});

class Content : public QObject {
    Q_OBJECT

  public:
    explicit Content(RunRequest request = {});
    /// Closes what was open first, and starts these hands. If they cannot be started, the caller
    /// still has them.
    void start_run(std::shared_ptr<Opened> volume, std::vector<LiveHand>&& hands);
    void start_playback(std::shared_ptr<Opened> volume, std::vector<Playback> hands);
    /// Devices and recordings are closed on another thread: closer().
    void close();
    /// As run::Run::use_buttons and use_field, of all hands. If they throw, the runs have what they
    /// had.
    void use_buttons(const run::Buttons& buttons);
    void use_field(Solid solid, Interpolation interpolation);

    /// None if nothing is open. They are numbered from 1.
    int hands() const { return static_cast<int>(std::max(hands_.size(), playbacks_.size())); }
    /// The chosen one.
    int hand() const { return hand_; }
    void choose_hand(int hand);
    /// For a hand that feels with another device what the chosen one began with, at the level that
    /// it feels now.
    run::Setup setup_with(const devices::DeviceChoice& device) const;
    /// One more beside that of a live run, with the same buttons on the same field. It is chosen.
    /// If it cannot be added, the caller still has it. Throws as run::Run::start_beside.
    void add_hand(LiveHand&& hand);
    /// Goes on with this hand in place of the one with the same key, which ends, as
    /// run::Run::start_as(). `closed`, from any thread, once its device is closed, or at once where
    /// there is no such hand any more: then, and if it throws, the caller still has `next`.
    void replace_hand(LiveHand&& next, std::function<void()> closed = {});
    const std::shared_ptr<const HandKey>& key() const { return hands_[index(hand_)].key; }
    /// A hand of the live run has this key.
    bool has_hand(const std::shared_ptr<const HandKey>& key) const {
        return std::ranges::find(hands_, key, &LiveHand::key) != hands_.end();
    }
    /// The chosen one, of two: its force ends.
    void remove_hand();
    /// Ends the run; emits nothing. Forces go to zero on threads of closer().
    void end_run();
    RunCloser& closer() { return closer_; }

    /// With the devices and buttons in use.
    RunRequest& request();
    /// The request for another run. The level, the layers and the recording of the command line are
    /// for the first one only.
    RunRequest take_request();

    /// The settings of the live run, which commands change, or of the recording.
    Effect& effect() { return effect_; }
    /// Null if nothing is open.
    const std::shared_ptr<Opened>& volume() const { return volume_; }
    /// Where the volume as it is felt can be read again: the file that it was saved to last, else
    /// where it came from. For an open volume.
    run::Source source() const { return saved_ ? *saved_ : volume_->loaded.source; }
    /// Of an open volume: it is a file or a store, which lies as its header says.
    bool from_file() const {
        const auto& from = volume_->loaded.source.from;
        return std::holds_alternative<run::FileSource>(from) ||
               std::holds_alternative<run::StoreSource>(from);
    }
    /// The volume as it is felt was written there.
    void set_saved(const run::Source& source);
    bool saved_elsewhere() const { return saved_.has_value(); }
    /// The session file that was opened or saved last; empty: none.
    const QString& session() const { return session_; }
    void set_session(const QString& path);
    /// Null unless there is a live run, and in it this hand.
    run::Run* live() const { return live(hand_); }
    run::Run* live(int hand) const {
        return has(hands_, hand) ? hands_[index(hand)].run.get() : nullptr;
    }
    /// The live run's data, for threads that may outlive the run.
    const std::shared_ptr<run::Data>& data() const { return data_; }
    /// Null unless the run's data can be edited.
    run::VolumeEditor* editor() const;
    /// Null unless the run's data are a sequence.
    run::Player* player() const;
    /// Null unless a recording is open.
    Playback* playback() { return playbacks_.empty() ? nullptr : &playbacks_[index(hand_)]; }
    const Playback* playback() const { return playback(hand_); }
    const Playback* playback(int hand) const {
        return has(playbacks_, hand) ? &playbacks_[index(hand)] : nullptr;
    }
    /// [s] The time of the recording that is shown, by the clock of the chosen hand. Hands are
    /// shown as long after their first ticks.
    double time() const { return time_; }
    void set_time(double time) { time_ = time; }

    /// The layers in use now, or at the time shown; null: none.
    SharedLayers layers() const { return layers(hand_); }
    SharedLayers layers(int hand) const;
    /// Hands of the live run feel these. The chosen one stays chosen.
    void use_layers(const std::map<int, SharedLayers>& by_hand);
    /// The tool in use now, or at the time shown; null: a point.
    std::shared_ptr<const Tool> tool() const { return tool(hand_); }
    std::shared_ptr<const Tool> tool(int hand) const;
    /// The outermost surface that is felt: a field and its level. For a live run.
    struct OuterSurface {
        Field field;
        double level;
    };
    OuterSurface outer_surface();
    /// What is felt now, or was at the time shown. Nothing before the first tick.
    std::optional<Snapshot> snapshot() const { return snapshot(hand_); }
    std::optional<Snapshot> snapshot(int hand) const;
    HandSnapshots snapshots() const;
    /// The data that are felt now, or as a recording began; those of such a snapshot.
    Field felt() const;
    Field felt_at(const Snapshot& snapshot);
    /// Those of a snapshot with all samples that a field needs at this point [mm, physical];
    /// nothing while a store's have not come.
    std::optional<Field> felt_round(const Snapshot& snapshot, const Vec3& point);
    /// The same for pictures: of a store the overview, on a grid of its own, with the edits.
    Field seen(Field felt);

  Q_SIGNALS:
    void closing();
    void closed();
    void run_started();
    /// The other side is solid: another field.
    void field_replaced();
    /// The run has started, or has another device, field or settings.
    void run_changed();
    void playback_started();
    /// The chosen hand has another device: also of a run that has started. After run_changed().
    void device_changed();
    /// Another hand is chosen, added or removed. After run_changed().
    void hand_changed();
    /// source() or session() is another one.
    void renamed();
    /// Runs were closed, which may have taken time.
    void runs_ended(const RunCloser::Ended& how);

  private:
    static std::size_t index(int hand) { return static_cast<std::size_t>(hand - 1); }
    static bool has(const auto& all, int hand) { return index(hand) < all.size(); }
    void begin_effect();
    double time_of(int hand) const;
    void require_devices() const;
    void close_runs(std::vector<LiveHand> hands, std::function<void()> closed = {});

    RunRequest request_;
    Effect effect_;
    std::shared_ptr<Opened> volume_;
    std::optional<run::Source> saved_;
    QString session_;
    std::shared_ptr<run::Data> data_;
    std::vector<LiveHand> hands_;      // on the same data
    std::vector<Playback> playbacks_;  // the same of a recording
    int hand_ = 1;                     // the chosen one
    double time_ = 0;
    std::optional<ShownEdits> overview_;  // of a store
    RunCloser closer_;
};

}  // namespace palpate::viewer
