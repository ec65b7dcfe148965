// Edits the samples of a running session: a brush that follows the proxy, edits that were asked
// for, undo and redo, from a thread of its own. The servo feels each within two ticks.
#pragma once

#include <chrono>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "palpate/editor.hpp"
#include "palpate/servo.hpp"

namespace palpate::app {

/// A brush in the hand. It works where the proxy touches the surface, along the way that it goes:
/// in the air it would have carved away what is to be felt before it is.
struct HandBrush {
    BrushKind kind = BrushKind::carve;
    double radius = 3;    ///< [mm, physical]
    double hardness = 1;  ///< Brush::hardness
    double rate = 10;     ///< [1/s] after a second 1 - exp(-rate) of the work is done; inf: at once
    /// [data units] What it leaves; none: what brush_for() takes. Paint needs one.
    std::optional<double> value = {};
};
/// One that carves a few voxels.
HandBrush usual_brush(const Geometry& geometry);
/// Throws std::invalid_argument, saying what is wrong, for a brush that cannot work.
void check(const HandBrush& brush);

/// What the brush does while a proxy in contact goes from one point to another [mm, physical] in
/// `dt` [s]; nothing where it has nothing to do. `isovalue` is the level felt.
std::optional<edit::Stroke> stroke_of(const HandBrush& brush, const Field& field, double isovalue,
                                      const Vec3& from, const Vec3& to, double dt);

/// Samples in work, as they are at one moment.
struct Work {
    std::shared_ptr<const Samples> samples;
    std::uint64_t version = 0;  ///< as snapshots tell it
    std::size_t undo_steps = 0, redo_steps = 0;
    bool changed = false;      ///< since the start, or since they were saved
    std::string problem = {};  ///< why the brush does nothing though it touches; empty if it works
};

/// Any thread may call anything; work() does not wait for an edit.
class Sculptor {
  public:
    explicit Sculptor(const Field& field);
    ~Sculptor();
    Sculptor(const Sculptor&) = delete;
    Sculptor& operator=(const Sculptor&) = delete;

    /// Whom to watch and to tell; it must stay until the next attach(). Null: nobody. It begins
    /// with the samples as they are, and knows their version.
    void attach(Servo* servo);
    /// Another side is solid from now on, or another background lies round the grid.
    void set_field(const Field& field);
    /// No brush: the hand only feels. Throws as check().
    void set_brush(const std::optional<HandBrush>& brush);
    /// Makes an edit, a step of its own for undo(). Throws std::invalid_argument as check(Edit),
    /// and for a servo that takes no commands.
    void apply(const Edit& edit);
    /// False if there is nothing to take back, or to make again. A brush that touches then rests
    /// until it has been in the air, or off: it would undo the undoing.
    bool undo();
    bool redo();

    Work work() const;
    /// These samples were written to a file.
    void set_saved(const std::shared_ptr<const Samples>& samples);
    /// What a recording needs to know before its first tick: every version so far by how it came
    /// about, without samples, and the one that is felt.
    std::vector<command::Samples> history() const;

  private:
    /// Where the next touch begins: where the proxy was last seen in contact.
    struct Stroke {
        Vec3 at = Vec3::Zero();  ///< [mm, physical]
        double time = 0;         ///< [s] of the session
        std::int64_t tick = -1;
    };

    struct Version {
        std::weak_ptr<const Samples> samples;  // gone once nobody can come back to them
        command::Samples told;                 // without samples
    };

    void run(const std::stop_token& stop);
    void dab();
    bool dab_from(const Stroke& from, const Snapshot& now);
    void edit(const Edit& edit, EditStep step);
    bool go_to(SampleBox changed);
    void send(const command::Samples& command);
    std::uint64_t version_of(const std::shared_ptr<const Samples>& samples) const;

    void show();

    mutable std::mutex mutex_;       // for as long as an edit takes
    mutable std::mutex show_mutex_;  // of shown_; a moment
    Work shown_;
    Field field_;  // for its side and background
    Editor editor_;
    Servo* servo_ = nullptr;
    std::optional<HandBrush> brush_;
    std::optional<Stroke> stroke_;
    double last_dab_ = 0;   // [s] of the session, when the last one changed something
    bool fresh_ = true;     // the next dab begins a step
    bool resting_ = false;  // after an undo, until the brush was in the air
    std::string problem_;
    std::vector<Version> versions_;  // by number
    std::jthread thread_;
};

}  // namespace palpate::app
