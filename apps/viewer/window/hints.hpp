// Words over the scene, where the eye is: why there is no force, how deep the probe presses, and
// that the brush is on and that a recording runs.
#pragma once

#include <QElapsedTimer>
#include <QLabel>
#include <QObject>
#include <optional>

#include "apps/viewer/model/hands.hpp"

namespace palpate::viewer {

class Content;
class RecordingController;
class Scene;

class Hints : public QObject {
    Q_OBJECT

  public:
    Hints(const Content& content, const RecordingController& recordings, Scene& scene);

    /// Often: shows what holds now. Without the chosen hand no run is felt or played. `brush`: it
    /// is on.
    void observe(const HandSnapshots& hands, bool brush);

  private:
    QString reason_of(const Snapshot& now);
    QString problem_of_hands() const;
    void show_numbers(const HandSnapshots& hands);
    void show_depth(const std::optional<Snapshot>& now);

    const Content& content_;
    const RecordingController& recordings_;
    Scene& scene_;
    QLabel *reason_, *brush_, *depth_, *recording_;
    PerHand<QLabel*> numbers_;
    QElapsedTimer recorded_;
    QElapsedTimer waiting_;  // for data; invalid: the hand does not
};

}  // namespace palpate::viewer
