// Lists devices and shows the state of the one in use.
#include "apps/viewer/panel/device_controls.hpp"

#include <QFormLayout>
#include <QHBoxLayout>
#include <QSignalBlocker>
#include <QStandardItemModel>
#include <QVBoxLayout>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "apps/viewer/panel/level_axis.hpp"
#include "palpate/devices/options.hpp"

namespace palpate::viewer {
namespace {

enum Role { name_role = Qt::UserRole, options_role, missing_role, found_role };

QColor colour_for(DeviceStatus status) {
    switch (status) {
        case DeviceStatus::ready:
            return {0, 158, 115};
        case DeviceStatus::starting:
        case DeviceStatus::uncalibrated:
        case DeviceStatus::stale:
            return {230, 159, 0};
        case DeviceStatus::lost:
        case DeviceStatus::fault:
            return {213, 60, 30};
        case DeviceStatus::finished:
            break;
    }
    return {140, 140, 140};
}

QString length_text(const Vec3& size) {
    return QString("%1 x %2 x %3 mm, %4")
        .arg(std::lround(size[0]))
        .arg(std::lround(size[1]))
        .arg(std::lround(size[2]));
}

}  // namespace

QString words_for(DeviceStatus status) {
    switch (status) {
        case DeviceStatus::starting:
            return "connecting";
        case DeviceStatus::ready:
            return "ready";
        case DeviceStatus::uncalibrated:
            return "needs calibration";
        case DeviceStatus::stale:
            return "sends no new positions";
        case DeviceStatus::lost:
            return "connection lost";
        case DeviceStatus::fault:
            return "reports a fault";
        case DeviceStatus::finished:
            break;
    }
    return "the hand has come to its end";
}

DeviceControls::DeviceControls(QWidget* parent)
    : QWidget(parent),
      picker_(new QComboBox),
      options_(new QLineEdit),
      refresh_(new QPushButton("Look again")),
      connect_(new QPushButton("Connect")),
      missing_(new Note("device_missing", Note::Kind::plain)),
      dot_(new QLabel),
      state_(new QLabel),
      model_(new QLabel),
      workspace_(new QLabel),
      problem_(new Note("device_problem", Note::Kind::warning)),
      scale_(new NumberBox) {
    picker_->setObjectName("devices");
    picker_->setToolTip("Devices; grey: not found, the tip says what was looked for");
    picker_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    picker_->setMinimumContentsLength(12);
    let_wheel_pass(*picker_);
    refresh_->setObjectName("refresh_devices");
    refresh_->setToolTip("Look for devices again; takes about a second");
    options_->setObjectName("device_options");
    options_->setClearButtonEnabled(true);
    connect_->setObjectName("connect_device");
    connect_->setToolTip("Go on with this device; forces ramp up anew");
    dot_->setObjectName("device_dot");
    state_->setObjectName("device_state");
    model_->setObjectName("device_model");
    model_->setWordWrap(true);
    workspace_->setObjectName("device_workspace");
    workspace_->setWordWrap(true);
    workspace_->setToolTip("The box that the device reaches [mm of the hand], and its most force");
    scale_->setObjectName("scale");
    scale_->setSuffix(" mm/mm");
    scale_->setSingleStep(0.1);
    scale_->setToolTip(
        "Scale of the hand: mm in the volume for each mm of the hand. Changes about "
        "the proxy, so that neither it nor the force moves");
    build();
    connect_inputs();
    set_devices({}, {});
}

void DeviceControls::build() {
    auto* first = new QHBoxLayout;
    first->addWidget(picker_, 1);
    first->addWidget(refresh_);
    auto* second = new QHBoxLayout;
    second->addWidget(options_, 1);
    second->addWidget(connect_);
    auto* state = new QHBoxLayout;
    state->setSpacing(6);
    state->addWidget(dot_);
    state->addWidget(state_, 1);
    auto* form = new QFormLayout;
    form->setVerticalSpacing(3);
    form->addRow("State", state);
    form->addRow("Model", model_);
    form->addRow("Reach", workspace_);
    form->addRow("Scale of the hand", scale_);
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(0, 0, 0, 0);
    column->addLayout(first);
    column->addLayout(second);
    column->addWidget(missing_);
    column->addLayout(form);
    column->insertWidget(3, problem_);
}

void DeviceControls::connect_inputs() {
    connect(refresh_, &QPushButton::clicked, this, &DeviceControls::refresh_wanted);
    connect(connect_, &QPushButton::clicked, this, &DeviceControls::connect_device);
    connect(options_, &QLineEdit::returnPressed, this, &DeviceControls::connect_device);
    connect(picker_, QOverload<int>::of(&QComboBox::currentIndexChanged), this,
            &DeviceControls::choose);
    connect(scale_, QOverload<double>::of(&QDoubleSpinBox::valueChanged), this,
            &DeviceControls::scale_wanted);
}

void DeviceControls::set_devices(const std::vector<devices::DeviceFinding>& findings,
                                 const QString& current) {
    current_ = current;
    std::vector<devices::DeviceFinding> all = findings;
    // These two exist on any machine, even before a search.
    for (const char* name : {"mouse", "simulated"}) {
        const auto named = [&](const devices::DeviceFinding& f) { return f.name == name; };
        if (std::ranges::none_of(all, named)) all.insert(all.begin(), {name, true, {}, {}, {}});
    }
    const QSignalBlocker quiet(picker_);
    picker_->clear();
    for (const devices::DeviceFinding& finding : all) {
        const QString name = QString::fromStdString(finding.name);
        const QString what = QString::fromStdString(finding.what);
        picker_->addItem(what.isEmpty() || !finding.found ? name : name + ": " + what, name);
        const int row = picker_->count() - 1;
        picker_->setItemData(row, QString::fromStdString(finding.options), options_role);
        picker_->setItemData(row, QString::fromStdString(finding.missing), missing_role);
        picker_->setItemData(row, finding.found, found_role);
        if (finding.found) {
            picker_->setItemData(row, what, Qt::ToolTipRole);
            continue;
        }
        // Grey but selectable: it may be at another address than the one searched.
        picker_->setItemText(row, name + " (not found)");
        picker_->setItemData(row, palette().brush(QPalette::Disabled, QPalette::Text),
                             Qt::ForegroundRole);
        picker_->setItemData(row, QString::fromStdString(finding.missing), Qt::ToolTipRole);
    }
    show_current();
}

void DeviceControls::show_current() {
    const int colon = current_.indexOf(':');
    const int row = picker_->findData(current_.left(colon), name_role);
    const QSignalBlocker quiet(picker_);
    picker_->setCurrentIndex(std::max(0, row));
    choose(picker_->currentIndex());
    options_->setText(colon < 0 ? QString() : current_.mid(colon + 1));
}

void DeviceControls::choose(int row) {
    const QString options = picker_->itemData(row, options_role).toString();
    options_->clear();
    options_->setPlaceholderText(options.isEmpty() ? "KEY=VALUE,..." : options);
    options_->setToolTip("Options, KEY=VALUE with commas between" +
                         (options.isEmpty() ? QString() : ":\n" + options));
    const bool found = picker_->itemData(row, found_role).toBool();
    missing_->say(found ? QString() : picker_->itemData(row, missing_role).toString());
    picker_->setToolTip(picker_->itemData(row, Qt::ToolTipRole).toString());
}

void DeviceControls::connect_device() {
    const QString options = options_->text().trimmed();
    const QString option =
        picker_->currentData(name_role).toString() + (options.isEmpty() ? "" : ":" + options);
    try {
        devices::parse_device(option.toStdString());
    } catch (const std::invalid_argument& error) {
        Q_EMIT nonsense(QString::fromStdString(error.what()));
        return;
    }
    Q_EMIT chosen(option);
}

void DeviceControls::show_status(DeviceStatus status) {
    if (status == status_ && !state_->text().isEmpty()) return;
    status_ = status;
    state_->setText(words_for(status));
    dot_->setText(QString::fromUtf8("\u25CF"));
    QPalette colours = palette();
    colours.setColor(QPalette::WindowText, colour_for(status));
    dot_->setPalette(colours);
}

void DeviceControls::show_device(const DeviceInfo& info, DeviceStatus status,
                                 const QString& problem) {
    show_status(status);
    problem_->say(problem);
    const QString name = QString::fromStdString(info.name);
    const QString model = QString::fromStdString(info.model);
    const QString both = model.isEmpty() || model == name ? name : name + ", " + model;
    if (model_->text() != both) model_->setText(both);
    const QString most = info.renders_force
                             ? QString("up to %1 N").arg(info.limits.maximum_force, 0, 'g', 3)
                             : QString("gives no force");
    const QString reach = length_text(info.workspace_high - info.workspace_low).arg(most);
    if (workspace_->text() != reach) workspace_->setText(reach);
}

void DeviceControls::show_scale(double scale) {
    if (!scale_->hasFocus()) scale_->show_value(scale);
}

void DeviceControls::clear() {
    for (QLabel* label : {dot_, state_, model_, workspace_}) label->clear();
    problem_->say({});
}

}  // namespace palpate::viewer
