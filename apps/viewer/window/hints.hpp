// Words that the window says by itself: over the scene, where the eye is, and about a volume that
// is read as it is felt.
#pragma once

#include <QElapsedTimer>
#include <QLabel>
#include <QString>

#include <optional>

#include "apps/viewer/model/hands.hpp"
#include "apps/viewer/window/detail_controller.hpp"
#include "palpate/stream/loader.hpp"

namespace palpate::viewer {

/// "12 MB".
QString bytes_text(double bytes);
/// A line for the status bar: levels, what is missing, what was read.
QString streaming_words(const stream::BrickLoaderStatus& hand, const DetailController::State& seen);
/// The same at length, for a tip.
QString streaming_tip(const stream::BrickLoaderStatus& hand, const DetailController::State& seen);
/// Why the hand waits, for where the eye is.
QString waiting_words(const stream::BrickLoaderStatus& hand);

class Note;
class RecordingController;
class Scene;

class Hints : public Controller {
    Q_OBJECT

  public:
    Hints(const Desk& desk, const RecordingController& recordings);

    /// Often: shows what holds now. Without the chosen hand no run is felt or played. `brush`: it
    /// is on.
    void observe(const HandSnapshots& hands, bool brush);
    /// Over the picture, until they are closed there or hold no more.
    void show_notes(const QList<const Note*>& notes);

  private:
    QString reason_of(const Snapshot& now);
    QString problem_of_hands() const;
    void show_numbers(const HandSnapshots& hands);
    void show_depth(const std::optional<Snapshot>& now);

    const RecordingController& recordings_;
    Scene& scene_;
    QLabel *notes_, *reason_, *brush_, *depth_, *recording_;
    QStringList closed_notes_;
    PerHand<QLabel*> numbers_;
    QElapsedTimer recorded_;
    QElapsedTimer waiting_;  // for data; invalid: the hand does not
};

}  // namespace palpate::viewer
