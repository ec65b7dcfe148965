// Shows the loop's figures in a small table.
#include "apps/viewer/panel/loop_view.hpp"

#include <QGridLayout>

#include "apps/options/words.hpp"

namespace palpate::viewer {
namespace {

QString time_text(std::int64_t ns) {
    return QString::fromStdString(app::duration_text(ns));
}

QLabel* label(const QString& text, const QString& name = {}) {
    auto* made = new QLabel(text);
    made->setObjectName(name);
    return made;
}

}  // namespace

LoopView::LoopView(QWidget* parent)
    : QWidget(parent),
      rate_(label({}, "loop_rate")),
      missed_(label({}, "loop_missed")),
      worst_(label({}, "loop_worst")) {
    auto* grid = new QGridLayout(this);
    grid->setContentsMargins(0, 0, 0, 0);
    grid->setVerticalSpacing(2);
    grid->addWidget(label("Rate"), 0, 0);
    grid->addWidget(rate_, 0, 1, 1, 4);
    grid->addWidget(label("Missed"), 1, 0);
    grid->addWidget(missed_, 1, 1, 1, 4);
    const char* heads[] = {"p50", "p99", "p99.9", "max"};
    const char* names[] = {"p50", "p99", "p999", "max"};
    grid->addWidget(label("Lateness"), 3, 0);
    grid->addWidget(label("Compute"), 4, 0);
    for (int i = 0; i < 4; ++i) {
        const auto at = static_cast<std::size_t>(i);
        grid->addWidget(label(heads[i]), 2, i + 1);
        lateness_[at] = label({}, QString("lateness_") + names[i]);
        compute_[at] = label({}, QString("compute_") + names[i]);
        grid->addWidget(lateness_[at], 3, i + 1);
        grid->addWidget(compute_[at], 4, i + 1);
        grid->setColumnStretch(i + 1, 1);
    }
    grid->addWidget(label("Worst tick"), 5, 0, Qt::AlignTop);
    grid->addWidget(worst_, 5, 1, 1, 4);
    worst_->setWordWrap(true);
    rate_->setToolTip("Ticks a second, as measured [Hz]");
    missed_->setToolTip(
        "Deadlines: ticks that did not happen at their time; and forces that were "
        "taken back because a tick took too long");
    setToolTip(
        "Lateness: how long after its time a tick began, the machine's doing.\n"
        "Compute: processor time of a tick, ours.");
    clear();
}

void LoopView::put(const Row& row, const LatencySummary& summary) {
    row[0]->setText(time_text(summary.p50));
    row[1]->setText(time_text(summary.p99));
    row[2]->setText(time_text(summary.p999));
    row[3]->setText(time_text(summary.max));
}

void LoopView::show_report(const ServoReport& report, double rate) {
    rate_->setText(QString("%1 Hz").arg(rate, 0, 'f', 0));
    QString missed = QString("%1 of %2 ticks").arg(report.missed).arg(report.ticks);
    if (report.overruns > 0) missed += QString(", %1 forces taken back").arg(report.overruns);
    if (report.unrecorded > 0) missed += QString(", %1 not recorded").arg(report.unrecorded);
    missed_->setText(missed);
    put(lateness_, report.lateness);
    put(compute_, report.compute);
    if (report.worst.tick < 0) return worst_->setText("none yet");
    const std::int64_t whole = report.worst.lateness_ns + report.worst.work_ns;
    worst_->setText(QString("%1, mostly %2").arg(time_text(whole), name_of(report.worst.cause)));
}

void LoopView::clear() {
    for (const Row& row : {lateness_, compute_}) {
        for (QLabel* cell : row) cell->setText("-");
    }
    for (QLabel* one : {rate_, missed_, worst_}) one->setText("-");
}

}  // namespace palpate::viewer
