// Lists devices, changes to another one, and shows the state of the one in use and of all hands.
#include "apps/viewer/window/device_controls.hpp"

#include <QBoxLayout>
#include <QButtonGroup>
#include <QGridLayout>
#include <QRegularExpression>
#include <QSignalBlocker>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "apps/options/words.hpp"
#include "apps/viewer/panel/colours.hpp"
#include "apps/viewer/panel/form.hpp"
#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/panel/sentences.hpp"
#include "apps/viewer/window/brush_controls.hpp"
#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/messages.hpp"
#include "palpate/devices/options.hpp"

namespace palpate::viewer {
namespace {

constexpr const char* percentiles[] = {"p50", "p99", "p99.9", "max"};

QString time_text(std::int64_t ns) {
    return QString::fromStdString(app::duration_text(ns)).replace(" us", " µs");
}

}  // namespace

LoopView::LoopView(const Desk& desk) : Desk(desk) {
    auto* grid = new QGridLayout(this);
    grid->setContentsMargins(0, 0, 0, 0);
    grid->setVerticalSpacing(2);
    const auto add = [&](int row, const QString& head, const char* name, const QString& tip) {
        auto* label = named(new QLabel, name, tip);
        label->setWordWrap(true);
        grid->addWidget(new QLabel(head), row, 0, Qt::AlignTop);
        grid->addWidget(label, row, 1, 1, 2);
    };
    add(0, tr("Rate"), "loop_rate", tr("Ticks per second, as measured [Hz]"));
    add(1, tr("Missed"), "loop_missed",
        tr("Deadlines: ticks that did not happen at their time; and forces that were cancelled "
           "because a tick took too long"));
    grid->addWidget(new QLabel(tr("Lateness")), 2, 1);
    grid->addWidget(new QLabel(tr("Compute")), 2, 2);
    for (int i = 0; i < 4; ++i) {
        const QString name = QString(percentiles[i]).remove('.');
        grid->addWidget(new QLabel(percentiles[i]), 3 + i, 0);
        grid->addWidget(named(new QLabel, "lateness_" + name), 3 + i, 1);
        grid->addWidget(named(new QLabel, "compute_" + name), 3 + i, 2);
    }
    for (const int column : {1, 2}) grid->setColumnStretch(column, 1);
    add(7, tr("Worst tick"), "loop_worst", {});
    setToolTip(
        tr("Lateness: how late a tick began, caused by the rest of the machine.\n"
           "Compute: processor time of a tick."));
    for (const auto over : {&Effect::begun, &Effect::ended}) {
        connect(&content_.effect(), over, this, &LoopView::clear);
    }
    connect(&content_, &Content::hand_changed, this, [this] {
        ticks_ = std::numeric_limits<std::int64_t>::max();  // of another servo
    });
    since_.start();
    clear();
}

void LoopView::observe() {
    if (!content_.live()) return;
    const ServoReport report = content_.live()->report();
    const double seconds = 1e-3 * static_cast<double>(since_.restart());
    const std::int64_t ticks = report.ticks - std::exchange(ticks_, report.ticks);
    // Fewer than before: another servo.
    if (ticks < 0 || !(seconds > 0)) return;
    show_report(report, static_cast<double>(ticks) / seconds);
}

void LoopView::put(const QString& name, const QString& text) {
    findChild<QLabel*>(name)->setText(text);
}

void LoopView::show_report(const ServoReport& report, double rate) {
    put("loop_rate", tr("%1 Hz").arg(rate, 0, 'f', 0));
    QStringList missed{tr("%1 of %2 ticks").arg(report.missed).arg(report.missed + report.ticks)};
    if (report.overruns > 0) {
        missed << tr("%n forces cancelled", nullptr, static_cast<int>(report.overruns));
    }
    if (report.unrecorded > 0) {
        missed << tr("%n not recorded", nullptr, static_cast<int>(report.unrecorded));
    }
    put("loop_missed", missed.join(", "));
    const auto put_times = [this](const QString& row, const auto& its) {
        const std::int64_t times[] = {its.p50, its.p99, its.p999, its.max};
        for (int i = 0; i < 4; ++i)
            put(row + QString(percentiles[i]).remove('.'), time_text(times[i]));
    };
    put_times("lateness_", report.lateness);
    put_times("compute_", report.compute);
    if (report.worst.tick < 0) return put("loop_worst", tr("none yet"));
    const std::int64_t whole = report.worst.lateness_ns + report.worst.work_ns;
    put("loop_worst",
        tr("%1, mostly %2").arg(time_text(whole), shown_name(name_of(report.worst.cause))));
}

void LoopView::clear() {
    for (auto* label : findChildren<QLabel*>(QRegularExpression("_"))) label->setText("-");
}

namespace {

struct StatusLook {
    const char* words;
    QRgb colour;
};
constexpr QRgb green = 0xff009e73, orange = 0xffe69f00, red = 0xffd53c1e, grey = 0xff8c8c8c;

/// In the order of DeviceStatus.
constexpr StatusLook status_looks[] = {
    {QT_TRANSLATE_NOOP("palpate::viewer::DeviceControls", "connecting"), orange},
    {QT_TRANSLATE_NOOP("palpate::viewer::DeviceControls", "ready"), green},
    {QT_TRANSLATE_NOOP("palpate::viewer::DeviceControls", "needs calibration"), orange},
    {QT_TRANSLATE_NOOP("palpate::viewer::DeviceControls", "sends no new positions"), orange},
    {QT_TRANSLATE_NOOP("palpate::viewer::DeviceControls", "connection lost"), red},
    {QT_TRANSLATE_NOOP("palpate::viewer::DeviceControls", "reports a fault"), red},
    {QT_TRANSLATE_NOOP("palpate::viewer::DeviceControls", "the hand has come to its end"), grey}};

QString length_text(const Vec3& size) {
    return QString("%1 x %2 x %3 mm")
        .arg(std::lround(size[0]))
        .arg(std::lround(size[1]))
        .arg(std::lround(size[2]));
}

}  // namespace

DeviceControls::DeviceControls(const Desk& desk)
    : EffectForm(desk.effect()),
      Desk(desk),
      search_(messages_),
      connector_(desk),
      picker_(named(new QComboBox, "devices",
                    tr("Devices; grey: not found, the tip says what was looked for"))),
      options_(named(new QLineEdit, "device_options")),
      missing_(new Note(this, "device_missing", Note::Kind::plain)),
      dot_(named(new QLabel, "device_dot")),
      state_(named(new QLabel, "device_state")),
      model_(named(new QLabel, "device_model")),
      workspace_(named(new QLabel, "device_workspace",
                       tr("The box that the device reaches [mm of the hand], and its most force"))),
      problem_(new Note(this, "device_problem", Note::Kind::warning)) {
    search_.setParent(nullptr);  // nobody waits for it
    options_->setAccessibleName(tr("Options of the device"));
    picker_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    picker_->setMinimumContentsLength(12);
    let_wheel_pass(*picker_);
    options_->setClearButtonEnabled(true);
    model_->setWordWrap(true);
    workspace_->setWordWrap(true);
    make_controls();
    connect(picker_, qOverload<int>(&QComboBox::currentIndexChanged), this,
            &DeviceControls::choose);
    connect(&effect_, &Effect::observed, this, [this](const Snapshot& now) {
        show_status(now.session.device.status);
        // A number that is being typed is left alone.
        if (!findChild<NumberBox*>("scale")->hasFocus()) refresh();
    });
    for (const auto changed : {&Content::device_changed, &Content::hand_changed}) {
        connect(&content_, changed, this, [this] { list(findings_); });
    }
    // Where a device could not be had, the one in use is listed again.
    connect(&connector_.task(), &BackgroundTask::ended, this, [this] { list(findings_); });
    connect(&content_, &Content::run_changed, this, &DeviceControls::show_buttons);
    list({});
    show_buttons();
}

void DeviceControls::make_controls() {
    const auto connect_it = [this] { ask_for_device(&Connector::use_device); };
    connect(options_, &QLineEdit::returnPressed, this, connect_it);
    auto* look = button(
        {"refresh_devices", tr("Look again"), tr("Look for devices again; takes about a second")},
        [this] { find_devices(); });
    auto* use =
        button({"connect_device", tr("Connect"), tr("Go on with this device; forces ramp up anew")},
               connect_it);
    auto* add = button({"add_hand", tr("Add as second hand"),
                        tr("One more hand with the device above. Each feels what the other edits")},
                       [this] { ask_for_device(&Connector::add_hand); });
    auto* remove = button(
        {"remove_hand", tr("Remove this hand"), tr("Its force ends; the other hand goes on")},
        [this] { content_.remove_hand(); });
    each_time(add, [this](QWidget& one) { one.setVisible(content_.hands() < most_hands); });
    each_time(remove, [this](QWidget& one) { one.setVisible(content_.hands() > 1); });
    auto* scale = number({"scale", "",
                          tr("Scale of the hand: mm in the volume for each mm of the hand. Changes "
                             "about the proxy, so that neither it nor the force moves")},
                         {[this] { return effect_.settings().transform.scale; },
                          [this](double to) { effect_.request(command::Scale{to}); }});
    scale->setSuffix(" mm/mm");
    scale->setSingleStep(0.1);
    scale->set_digits(4);
    scale->setMinimumWidth(fontMetrics().horizontalAdvance("00.000 mm/mm") +
                           2 * fontMetrics().height());
    auto* state = row_of({dot_, state_}, 1);
    state->layout()->setSpacing(6);
    auto* form = form_in();
    form->addRow(tr("State"), state);
    form->addRow(tr("Model"), model_);
    form->addRow(tr("Reach"), workspace_);
    form->addRow(tr("Scale of the hand"), scale);
    clutch_ = make_button(
        {"clutch_button", "", tr("While this button is held, the volume hangs on the hand"),
         tr("Clutch button")},
        &run::Buttons::clutch);
    deadman_ =
        make_button({"deadman_button", "", tr("There is a force only while this button is held"),
                     tr("Dead-man button")},
                    &run::Buttons::deadman);
    form->addRow(tr("Clutch button"), clutch_);
    form->addRow(tr("Dead-man button"), deadman_);
    column_in(this, {row_of({picker_, look}, 0), row_of({options_, use}, 0), row_of({add, remove})})
        ->addLayout(form);
}

QComboBox* DeviceControls::make_button(const Words& words,
                                       run::ButtonSetup run::Buttons::*purpose) {
    auto* box = choice(
        words, std::vector<std::string>(),
        {[this, purpose] {
             const auto* live = content_.live();
             return run::text_of(live ? live->setup().buttons.*purpose : run::Buttons{}.*purpose);
         },
         [this, purpose](const std::string& text) {
             run::Buttons wanted = content_.live()->setup().buttons;
             wanted.*purpose = run::button_from("", text);
             messages_.guarded([&] { content_.use_buttons(wanted); });
         }});
    // Its longest words must not make the panel wider.
    box->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    box->setMinimumContentsLength(8);
    box->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
    return box;
}

/// Lists the buttons of the device.
void DeviceControls::show_buttons() {
    const int count = effect_.there() ? effect_.device().buttons : 0;
    for (QComboBox* box : {clutch_, deadman_}) {
        box->clear();
        box->addItem(tr("none"), "none");
        // A dead-man switch is one by choice only.
        if (box == clutch_) box->addItem(tr("the second, or the only one"), "auto");
        for (int number = 1; number <= count; ++number) {
            box->addItem(tr("button %1").arg(number), QString::number(number));
        }
        allow(*box, count > 0 ? QString() : tr("The device has no buttons"));
    }
    refresh();
}

void DeviceControls::find_devices() {
    if (search_.busy()) return;
    const auto found = std::make_shared<std::vector<devices::DeviceFinding>>();
    search_.start(
        tr("Looking for devices"),
        [found](const io::Progress& progress) { *found = devices::find_devices(progress); },
        [this, found] {
            list(*found);
            Q_EMIT devices_found(device_words());
        });
}

QString DeviceControls::device_words() const {
    QStringList names;
    for (const devices::DeviceFinding& finding : findings_) {
        const bool made =
            finding.name == "mouse" || finding.name == "simulated" || finding.name == "recorded";
        if (finding.found && !made) names << QString::fromStdString(finding.name);
    }
    if (names.isEmpty()) return tr("No haptic device was found: the mouse is the hand.");
    return tr("Found: %1. Choose it under Device.").arg(names.join(", "));
}

void DeviceControls::list(const std::vector<devices::DeviceFinding>& findings) {
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
    const devices::DeviceChoice& device =
        content_.live() ? content_.live()->setup().device : content_.request().setup.device;
    const QString current = QString::fromStdString(run::text_of(device));
    const int colon = current.indexOf(':');
    picker_->setCurrentIndex(std::max(0, picker_->findData(current.left(colon))));
    choose(picker_->currentIndex());
    options_->setText(colon < 0 ? QString() : current.mid(colon + 1));
    told_.reset();
    refresh();
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

void DeviceControls::ask_for_device(void (Connector::*use)(const devices::DeviceChoice&)) {
    const QString options = options_->text().trimmed();
    const QString option =
        picker_->currentData().toString() + (options.isEmpty() ? "" : ":" + options);
    try {
        (connector_.*use)(devices::parse_device(option.toStdString()));
        Q_EMIT nonsense({});
    } catch (const std::invalid_argument& error) {
        Q_EMIT nonsense(in_words(error.what()));
    }
}

void DeviceControls::observe(const Snapshot& now) {
    const run::Run* live = content_.live();
    if (!live) return;
    const DeviceStatus status = now.session.device.status;
    const QString problem = QString::fromStdString(live->device_problem());
    if (told_ == status && problem_->text() == problem) return;
    if (status == DeviceStatus::finished && told_ != status) {
        messages_.show_done(tr("The simulated or recorded hand has come to its end"));
    }
    told_ = status;
    show_device(live->device(), status, problem);
}

void DeviceControls::show_status(DeviceStatus status) {
    if (status == status_ && !state_->text().isEmpty()) return;
    status_ = status;
    const auto& [words, colour] = status_looks[static_cast<std::size_t>(status)];
    state_->setText(tr(words));
    dot_->setText(QString::fromUtf8("\u25CF"));
    QPalette colours = palette();
    colours.setColor(QPalette::WindowText, QColor::fromRgb(colour));
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

void DeviceControls::begin() {
    show_device(effect_.device(), DeviceStatus::starting, {});
}

void DeviceControls::clear() {
    for (QLabel* label : {dot_, state_, model_, workspace_}) label->clear();
    problem_->say({});
}

HandSwitch::HandSwitch(const Desk& desk, BrushControls& brush) : Desk(desk), brush_(brush) {
    setObjectName("hand_switch");
    auto* group = new QButtonGroup(this);
    auto* row = row_in(this);
    for (int hand = 1; hand <= most_hands; ++hand) {
        QPushButton* button = buttons_[hand] =
            named(new QPushButton, QString("hand_%1").arg(hand),
                  tr("The panel shows the settings of this hand (N: the next one). Commands, keys "
                     "and the mouse are for it"));
        const QColor colour = to_qt(colours_of(hand).hip);
        button->setStyleSheet(QString("QPushButton:checked { background-color: %1; color: %2; "
                                      "font-weight: bold; border: 1px solid %3; border-radius: "
                                      "4px; padding: 3px; } QPushButton:checked:focus { border: "
                                      "2px solid palette(text); }")
                                  .arg(colour.name(),
                                       colour.lightnessF() < 0.45 ? "white" : "black",
                                       colour.darker(150).name()));
        button->setText(QString::number(hand));
        button->setCheckable(true);
        group->addButton(button, hand);
        row->addWidget(button, 1);
    }
    connect(group, &QButtonGroup::idClicked, this, &HandSwitch::choose);
    for (const auto changed : {&Content::run_changed, &Content::playback_started,
                               &Content::hand_changed, &Content::closed}) {
        connect(&content_, changed, this, &HandSwitch::show_hands);
    }
    show_hands();
}

void HandSwitch::show_hands() {
    setVisible(content_.hands() > 1);
    if (isHidden()) return;
    for (int hand = 1; hand <= content_.hands(); ++hand) {
        const run::Run* live = content_.live(hand);
        const std::string whole =
            live ? live->device().name : content_.playback(hand)->head().device;
        const QString device = QString::fromStdString(whole.substr(0, whole.find(" (")));
        const QString problem = QString::fromStdString(live ? live->device_problem() : "");
        QPushButton& button = *buttons_[hand];
        const QString words = tr("Hand %1: %2").arg(hand).arg(device);
        const QString text = problem.isEmpty() ? words : QString::fromUtf8("⚠ ") + words;
        button.setChecked(hand == content_.hand());
        // Each change is told by screen readers.
        if (button.text() == text && button.accessibleDescription() == problem) continue;
        button.setText(text);
        button.setAccessibleName(tr("Settings of hand %1, %2").arg(hand).arg(device));
        button.setAccessibleDescription(problem);
    }
}

/// The brush is that of all hands: it stays as it is.
void HandSwitch::choose(int hand) {
    const BrushChoice choice = brush_.choice();
    content_.choose_hand(hand);
    if (choice.on) brush_.set_choice(choice);
}

void HandSwitch::choose_next() {
    if (content_.hands() < 2) return;
    choose(content_.hand() % content_.hands() + 1);
    messages_.show_done(tr("The panel shows the settings of hand %1").arg(content_.hand()));
}

}  // namespace palpate::viewer
