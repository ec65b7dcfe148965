// Shows how the servo loop performs: rate, lateness, compute time, missed deadlines, worst tick.
#pragma once

#include <QLabel>
#include <QWidget>

#include <array>

#include "palpate/servo.hpp"

namespace palpate::viewer {

class LoopView : public QWidget {
    Q_OBJECT

  public:
    LoopView();
    /// `rate` [Hz] as measured.
    void show_report(const ServoReport& report, double rate);
    void clear();

  private:
    using Row = std::array<QLabel*, 4>;  // p50, p99, p99.9, max
    static void put(const Row& row, const LatencySummary& summary);

    Row lateness_{}, compute_{};
    QLabel *rate_, *missed_, *worst_;
};

}  // namespace palpate::viewer
