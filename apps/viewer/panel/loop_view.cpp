// Shows the loop's figures in a small table.
#include "apps/viewer/panel/loop_view.hpp"

#include <QGridLayout>

#include "apps/options/words.hpp"
#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/panel/names.hpp"

namespace palpate::viewer {
namespace {

QString time_text(std::int64_t ns) {
    return QString::fromStdString(app::duration_text(ns)).replace(" us", " µs");
}

}  // namespace

LoopView::LoopView()
    : rate_(named(new QLabel, "loop_rate", tr("Ticks a second, as measured [Hz]"))),
      missed_(named(new QLabel, "loop_missed",
                    tr("Deadlines: ticks that did not happen at their time; and forces that were "
                       "taken back because a tick took too long"))),
      worst_(named(new QLabel, "loop_worst")) {
    auto* grid = new QGridLayout(this);
    grid->setContentsMargins(0, 0, 0, 0);
    grid->setVerticalSpacing(2);
    const QString heads[] = {tr("Rate"),     tr("Missed"),  "",
                             tr("Lateness"), tr("Compute"), tr("Worst tick")};
    for (int row = 0; row < 6; ++row) {
        grid->addWidget(new QLabel(heads[row]), row, 0, row == 5 ? Qt::AlignTop : Qt::Alignment());
    }
    grid->addWidget(rate_, 0, 1, 1, 4);
    grid->addWidget(missed_, 1, 1, 1, 4);
    grid->addWidget(worst_, 5, 1, 1, 4);
    worst_->setWordWrap(true);
    const char* columns[] = {"p50", "p99", "p99.9", "max"};
    for (int i = 0; i < 4; ++i) {
        const QString name = QString(columns[i]).remove('.');
        const auto at = static_cast<std::size_t>(i);
        lateness_[at] = named(new QLabel, "lateness_" + name);
        compute_[at] = named(new QLabel, "compute_" + name);
        grid->addWidget(new QLabel(columns[i]), 2, i + 1);
        grid->addWidget(lateness_[at], 3, i + 1);
        grid->addWidget(compute_[at], 4, i + 1);
        grid->setColumnStretch(i + 1, 1);
    }
    setToolTip(
        tr("Lateness: how late a tick began, caused by the rest of the machine.\n"
           "Compute: processor time of a tick."));
    clear();
}

void LoopView::put(const Row& row, const LatencySummary& summary) {
    row[0]->setText(time_text(summary.p50));
    row[1]->setText(time_text(summary.p99));
    row[2]->setText(time_text(summary.p999));
    row[3]->setText(time_text(summary.max));
}

void LoopView::show_report(const ServoReport& report, double rate) {
    rate_->setText(tr("%1 Hz").arg(rate, 0, 'f', 0));
    QStringList missed{tr("%1 of %2 ticks").arg(report.missed).arg(report.missed + report.ticks)};
    if (report.overruns > 0) {
        missed << tr("%n forces taken back", nullptr, static_cast<int>(report.overruns));
    }
    if (report.unrecorded > 0) {
        missed << tr("%n not recorded", nullptr, static_cast<int>(report.unrecorded));
    }
    missed_->setText(missed.join(", "));
    put(lateness_, report.lateness);
    put(compute_, report.compute);
    if (report.worst.tick < 0) return worst_->setText(tr("none yet"));
    const std::int64_t whole = report.worst.lateness_ns + report.worst.work_ns;
    worst_->setText(
        tr("%1, mostly %2").arg(time_text(whole), shown_name(name_of(report.worst.cause))));
}

void LoopView::clear() {
    for (const Row& row : {lateness_, compute_}) {
        for (QLabel* cell : row) cell->setText("-");
    }
    for (QLabel* one : {rate_, missed_, worst_}) one->setText("-");
}

}  // namespace palpate::viewer
