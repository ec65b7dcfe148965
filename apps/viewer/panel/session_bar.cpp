// Connects the switches, and shows force and contact.
#include "apps/viewer/panel/session_bar.hpp"

#include <QBoxLayout>
#include <QEvent>
#include <QVariant>

#include <algorithm>

#include "apps/options/words.hpp"
#include "apps/viewer/model/hand_state.hpp"
#include "apps/viewer/model/measurement.hpp"
#include "apps/viewer/panel/layout.hpp"

namespace palpate::viewer {

SessionSwitch::SessionSwitch(const QString& on, const QString& off) : on_(on), off_(off) {
    setCheckable(true);
    setText(off_);
}

bool SessionSwitch::set_on_text(const QString& text) {
    if (text == on_) return false;
    on_ = text;
    if (isChecked()) setText(on_);
    return true;
}

void SessionSwitch::set_state(bool on) {
    setChecked(on);
    setText(on ? on_ : off_);
}

SessionBar::SessionBar(Effect& effect)
    : effect_(effect),
      forces_(named(new SessionSwitch(tr("Forces are ON"), tr("Forces are OFF")), "forces",
                    tr("Forces on or off (space bar). Off: zero at once; on: they ramp up"))),
      freeze_(named(new SessionSwitch(tr("Frozen"), tr("Freeze")), "freeze",
                    tr("Hand and proxy stand still for the session, forces are let go"))),
      clutch_(named(new SessionSwitch(tr("Clutched"), tr("Clutch")), "clutch",
                    tr("The volume hangs on the hand, to put it elsewhere; forces are let go"))),
      gauge_(new ForceGauge),
      contact_(named(new QLabel, "contact",
                     tr("Whether the proxy is on a surface, and how far it is from the hand (of "
                        "the hand, and in the volume)"))) {
    setObjectName("session_bar");
    QFont big = forces_->font();
    big.setBold(true);
    big.setPointSizeF(1.25 * big.pointSizeF());
    forces_->setFont(big);
    forces_->setMinimumHeight(static_cast<int>(2.6 * fontMetrics().height()));
    contact_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Fixed);
    contact_->setFixedHeight(2 * fontMetrics().lineSpacing());  // a tool in contact has two lines
    contact_->setAlignment(Qt::AlignTop);
    auto* switches = column_of({freeze_, clutch_});
    switches->layout()->setSpacing(2);
    column_in(this, {row_of({forces_, switches}, 0), gauge_, contact_});
    connect_effect();
    colour_forces();
    clear();
}

void SessionBar::connect_effect() {
    connect(forces_, &QPushButton::clicked, this,
            [this](bool on) { effect_.request(command::Forces{on}); });
    connect(freeze_, &QPushButton::clicked, this,
            [this](bool on) { effect_.request(command::Freeze{on}); });
    connect(clutch_, &QPushButton::clicked, this,
            [this](bool on) { effect_.request(command::Clutch{on}); });
    connect(&effect_, &Effect::begun, this, &SessionBar::begin);
    connect(&effect_, &Effect::ended, this, &SessionBar::clear);
    connect(&effect_, &Effect::changed, this, &SessionBar::show_switches);
    connect(&effect_, &Effect::observed, this, &SessionBar::show_snapshot);
}

/// On: green, waiting: amber, off: as any button. The text says it, too.
void SessionBar::colour_forces() {
    const QString sheet =
        "QPushButton:checked:enabled { background-color: #00855f; color: white; border: 1px solid "
        "#00553c; border-radius: 4px; }"
        "QPushButton:checked:enabled[waiting=true] { background-color: #ffb000; color: black; "
        "border-color: #8a5f00; }"
        "QPushButton:checked:enabled:focus { border: 2px solid palette(highlight); }";
    if (forces_->styleSheet() != sheet) forces_->setStyleSheet(sheet);
}

void SessionBar::changeEvent(QEvent* event) {
    // A style sheet keeps the palette it was polished with.
    if (event->type() == QEvent::PaletteChange) {
        forces_->setStyleSheet({});
        colour_forces();
    }
    QWidget::changeEvent(event);
}

/// `why`: they are on, but there are none; empty: nothing holds them back.
void SessionBar::show_waiting(const QString& why) {
    const QString text = why.isEmpty() ? tr("Forces are ON") : tr("Forces WAIT") + '\n' + why;
    if (!forces_->set_on_text(text)) return;
    forces_->setProperty("waiting", !why.isEmpty());
    forces_->setStyleSheet({});  // a rule by property is looked up only once
    colour_forces();
}

void SessionBar::show_switches() {
    const Session& session = effect_.session();
    forces_->set_state(effect_.settings().forces_on);
    freeze_->set_state(session.frozen);
    clutch_->set_state(session.clutched);
}

double SessionBar::limit() const {
    return std::min(effect_.settings().force.limit, effect_.settings().device.maximum_force);
}

void SessionBar::begin() {
    contact_->setText(tr("no tick yet"));
    gauge_->set_force(0, limit(), {});
}

void SessionBar::clear() {
    for (SessionSwitch* one : {forces_, freeze_, clutch_}) one->set_state(false);
    show_waiting({});
    gauge_->clear();
    contact_->clear();
}

void SessionBar::show_snapshot(const Snapshot& now) {
    show_switches();
    const std::string words = app::force_words(now.session.tick);
    show_waiting(words == "no input"   ? tr("no input from the device")
                 : waits_for_hand(now) ? tr("withdraw a little")
                                       : QString());
    const Tick& tick = now.session.tick;
    gauge_->set_force(tick.force.norm(), limit(), QString::fromStdString(words));
    const double apart = (tick.proxy.scp - tick.proxy.hip).norm();
    const bool touching = tick.proxy.mode == palpate::Mode::constrained;
    QString text = (touching ? tr("In contact, pull %1 mm (%2 %3 in the volume)")
                             : tr("Free, pull %1 mm (%2 %3 in the volume)"))
                       .arg(apart / now.session.transform.scale, 0, 'f', 2)
                       .arg(apart, 0, 'f', 2)
                       .arg(unit_word(effect_.field().geometry()));
    if (tick.tool.contacts > 0) {
        text += '\n' + tr("%n points of the tool hold, torque %1 N mm", nullptr, tick.tool.contacts)
                           .arg(tick.torque.norm(), 0, 'f', 1);
    }
    contact_->setText(text);
}

}  // namespace palpate::viewer
