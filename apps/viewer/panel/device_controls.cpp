// Lists devices and shows the state of the one in use.
#include "apps/viewer/panel/device_controls.hpp"

#include <QBoxLayout>
#include <QGridLayout>
#include <QSignalBlocker>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "apps/options/words.hpp"
#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/panel/names.hpp"
#include "palpate/devices/options.hpp"

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

namespace {

struct StatusLook {
    QString words;
    QColor colour;
};

StatusLook look_of(DeviceStatus status) {
    const QColor green(0, 158, 115), orange(230, 159, 0), red(213, 60, 30), grey(140, 140, 140);
    switch (status) {
        case DeviceStatus::starting:
            return {DeviceControls::tr("connecting"), orange};
        case DeviceStatus::ready:
            return {DeviceControls::tr("ready"), green};
        case DeviceStatus::uncalibrated:
            return {DeviceControls::tr("needs calibration"), orange};
        case DeviceStatus::stale:
            return {DeviceControls::tr("sends no new positions"), orange};
        case DeviceStatus::lost:
            return {DeviceControls::tr("connection lost"), red};
        case DeviceStatus::fault:
            return {DeviceControls::tr("reports a fault"), red};
        case DeviceStatus::finished:
            break;
    }
    return {DeviceControls::tr("the hand has come to its end"), grey};
}

QString length_text(const Vec3& size) {
    return QString("%1 x %2 x %3 mm")
        .arg(std::lround(size[0]))
        .arg(std::lround(size[1]))
        .arg(std::lround(size[2]));
}

}  // namespace

DeviceControls::DeviceControls(Effect& effect)
    : effect_(effect),
      picker_(named(new QComboBox, "devices",
                    tr("Devices; grey: not found, the tip says what was looked for"))),
      options_(named(new QLineEdit, "device_options")),
      refresh_(named(new QPushButton(tr("Look again")), "refresh_devices",
                     tr("Look for devices again; takes about a second"))),
      connect_(named(new QPushButton(tr("Connect")), "connect_device",
                     tr("Go on with this device; forces ramp up anew"))),
      add_(named(new QPushButton(tr("Add as second hand")), "add_hand",
                 tr("One more hand with the device above. Each feels what the other edits"))),
      remove_(named(new QPushButton(tr("Remove this hand")), "remove_hand",
                    tr("Its force ends; the other hand goes on"))),
      missing_(new Note("device_missing", Note::Kind::plain)),
      dot_(named(new QLabel, "device_dot")),
      state_(named(new QLabel, "device_state")),
      model_(named(new QLabel, "device_model")),
      workspace_(named(new QLabel, "device_workspace",
                       tr("The box that the device reaches [mm of the hand], and its most force"))),
      problem_(new Note("device_problem", Note::Kind::warning)),
      scale_(named(new NumberBox, "scale",
                   tr("Scale of the hand: mm in the volume for each mm of the hand. Changes about "
                      "the proxy, so that neither it nor the force moves"))) {
    options_->setAccessibleName(tr("Options of the device"));
    picker_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    picker_->setMinimumContentsLength(12);
    let_wheel_pass(*picker_);
    options_->setClearButtonEnabled(true);
    model_->setWordWrap(true);
    workspace_->setWordWrap(true);
    scale_->setSuffix(" mm/mm");
    scale_->setSingleStep(0.1);
    build();
    connect_inputs();
    connect_effect();
    set_devices({}, {});
    set_hands(1);
}

void DeviceControls::build() {
    auto* state = row_of({dot_, state_}, 1);
    state->layout()->setSpacing(6);
    auto* form = new QFormLayout;
    form->setVerticalSpacing(3);
    form->addRow(tr("State"), state);
    form->addRow(tr("Model"), model_);
    form->addRow(tr("Reach"), workspace_);
    form->addRow(tr("Scale of the hand"), scale_);
    column_in(this, {row_of({picker_, refresh_}, 0), row_of({options_, connect_}, 0),
                     row_of({add_, remove_}), missing_, problem_})
        ->addLayout(form);
}

void DeviceControls::connect_inputs() {
    connect(refresh_, &QPushButton::clicked, this, &DeviceControls::refresh_wanted);
    const auto ask_to_connect = [this] { ask_for_device(&DeviceControls::chosen); };
    connect(connect_, &QPushButton::clicked, this, ask_to_connect);
    connect(options_, &QLineEdit::returnPressed, this, ask_to_connect);
    connect(add_, &QPushButton::clicked, this, [this] { ask_for_device(&DeviceControls::added); });
    connect(remove_, &QPushButton::clicked, this, &DeviceControls::removed);
    connect(picker_, qOverload<int>(&QComboBox::currentIndexChanged), this,
            &DeviceControls::choose);
    connect(scale_, qOverload<double>(&NumberBox::valueChanged), this,
            [this](double scale) { effect_.request(command::Scale{scale}); });
}

void DeviceControls::connect_effect() {
    connect(&effect_, &Effect::begun, this,
            [this] { show_device(effect_.device(), DeviceStatus::starting, {}); });
    connect(&effect_, &Effect::ended, this, &DeviceControls::clear);
    connect(&effect_, &Effect::changed, this,
            [this] { scale_->show_value(effect_.settings().transform.scale); });
    connect(&effect_, &Effect::observed, this, [this](const Snapshot& now) {
        show_status(now.session.device.status);
        // A number that is being typed is left alone.
        if (!scale_->hasFocus()) scale_->show_value(effect_.settings().transform.scale);
    });
}

void DeviceControls::set_devices(const std::vector<devices::DeviceFinding>& findings,
                                 const QString& current) {
    current_ = current;
    findings_ = findings;
    // These two exist on any machine, even before a search.
    for (const char* name : {"mouse", "simulated"}) {
        const auto same = [&](const devices::DeviceFinding& f) { return f.name == name; };
        if (std::ranges::none_of(findings_, same)) {
            findings_.insert(findings_.begin(), {name, true, {}, {}, {}});
        }
    }
    const QSignalBlocker quiet(picker_);
    picker_->clear();
    for (const devices::DeviceFinding& finding : findings_) {
        const QString name = QString::fromStdString(finding.name);
        const QString what = QString::fromStdString(finding.what);
        const int row = picker_->count();
        if (finding.found) {
            picker_->addItem(what.isEmpty() ? name : name + ": " + what, name);
            picker_->setItemData(row, what, Qt::ToolTipRole);
            continue;
        }
        // Grey but selectable: it may be at another address than the one searched.
        picker_->addItem(tr("%1 (not found)").arg(name), name);
        picker_->setItemData(row, palette().brush(QPalette::Disabled, QPalette::Text),
                             Qt::ForegroundRole);
        picker_->setItemData(row, QString::fromStdString(finding.missing), Qt::ToolTipRole);
    }
    show_current();
}

void DeviceControls::show_current() {
    const int colon = current_.indexOf(':');
    const int row = picker_->findData(current_.left(colon));
    const QSignalBlocker quiet(picker_);
    picker_->setCurrentIndex(std::max(0, row));
    choose(picker_->currentIndex());
    options_->setText(colon < 0 ? QString() : current_.mid(colon + 1));
}

void DeviceControls::choose(int row) {
    const devices::DeviceFinding& finding = findings_[static_cast<std::size_t>(row)];
    const QString options = QString::fromStdString(finding.options);
    options_->clear();
    const QString all = tr("Options, KEY=VALUE with commas between");
    options_->setPlaceholderText(options.isEmpty() ? "KEY=VALUE,..." : options);
    options_->setToolTip(options.isEmpty() ? all : all + ":\n" + options);
    missing_->say(finding.found ? QString() : QString::fromStdString(finding.missing));
    picker_->setToolTip(picker_->itemData(row, Qt::ToolTipRole).toString());
}

void DeviceControls::ask_for_device(void (DeviceControls::*signal)(const QString&)) {
    const QString options = options_->text().trimmed();
    const QString option =
        picker_->currentData().toString() + (options.isEmpty() ? "" : ":" + options);
    try {
        devices::parse_device(option.toStdString());
    } catch (const std::invalid_argument& error) {
        Q_EMIT nonsense(QString::fromStdString(error.what()));
        return;
    }
    Q_EMIT(this->*signal)(option);
}

void DeviceControls::set_hands(int hands) {
    add_->setVisible(hands < 2);
    remove_->setVisible(hands > 1);
}

void DeviceControls::show_status(DeviceStatus status) {
    if (status == status_ && !state_->text().isEmpty()) return;
    status_ = status;
    const StatusLook look = look_of(status);
    state_->setText(look.words);
    dot_->setText(QString::fromUtf8("\u25CF"));
    QPalette colours = palette();
    colours.setColor(QPalette::WindowText, look.colour);
    dot_->setPalette(colours);
}

void DeviceControls::show_device(const DeviceInfo& info, DeviceStatus status,
                                 const QString& problem) {
    show_status(status);
    problem_->say(problem);
    const QString name = QString::fromStdString(info.name);
    const QString model = QString::fromStdString(info.model);
    const QString both = model.isEmpty() || model == name ? name : name + ", " + model;
    model_->setText(both);
    const QString most = info.renders_force
                             ? tr("up to %1 N").arg(info.limits.maximum_force, 0, 'g', 3)
                             : tr("gives no force");
    workspace_->setText(
        QString("%1, %2").arg(length_text(info.workspace_high - info.workspace_low), most));
}

void DeviceControls::clear() {
    for (QLabel* label : {dot_, state_, model_, workspace_}) label->clear();
    problem_->say({});
}

}  // namespace palpate::viewer
