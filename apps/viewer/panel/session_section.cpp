// The section of the session: switches, the force against its limit, and the contact.
#include <QBoxLayout>
#include <QCoreApplication>
#include <QEvent>
#include <QLabel>
#include <QProgressBar>
#include <QPushButton>
#include <QVariant>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "apps/options/words.hpp"
#include "apps/viewer/model/hands.hpp"
#include "apps/viewer/model/measurement.hpp"
#include "apps/viewer/panel/form.hpp"

namespace palpate::viewer {
namespace {

constexpr Colour near_limit{0.835, 0.369, 0};
constexpr int places = 1000;  // of the bar

/// Words of app::force_words(), as a person reads them, and what they mean.
struct ForceWords {
    Q_DECLARE_TR_FUNCTIONS(palpate::viewer::ForceGauge)
  public:
    struct Row {
        const char *words, *meaning;
    };
    static constexpr Row all[] = {
        {QT_TR_NOOP("off"), QT_TR_NOOP("Off: forces are switched off")},
        {QT_TR_NOOP("recovering"), QT_TR_NOOP("Recovering: the proxy is leaving the solid")},
        {QT_TR_NOOP("not finite"), ""},
        {QT_TR_NOOP("no input"), QT_TR_NOOP("No input: the device gives no reliable position")},
        {QT_TR_NOOP("too late"),
         QT_TR_NOOP("Too late: a tick took too long, its force was cancelled")},
        {QT_TR_NOOP("waiting"),
         QT_TR_NOOP("Waiting: forces begin when the hand is where they are small")},
        {QT_TR_NOOP("ramp"), QT_TR_NOOP("Ramp: from zero to full force after a start or pause")},
        {QT_TR_NOOP("limit"), QT_TR_NOOP("Limit: the computed force is larger than the limit")},
        {QT_TR_NOOP("motors warm"),
         QT_TR_NOOP("Motors warm: the force is limited until they have cooled")},
        {QT_TR_NOOP("rate limit"), QT_TR_NOOP("Rate limit: the force may not change faster")}};
};

/// A bar, a number, and a text while the force is reduced.
class ForceGauge : public QWidget {
    Q_DECLARE_TR_FUNCTIONS(palpate::viewer::ForceGauge)

  public:
    ForceGauge() {
        make_bold(*number_);
        why_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Fixed);
        bar_->setRange(0, places);
        bar_->setTextVisible(false);
        bar_->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Expanding);
        setFixedHeight(static_cast<int>(2.4 * fontMetrics().height()));
        column_in(this, {row_of({number_, why_, most_}, 1), bar_})->setSpacing(1);
    }

    /// [N]; `words`, as app::force_words() has them. Called thirty times a second: changes only
    /// what can be seen.
    void show_force(double force, double limit, const QString& words = {}) {
        const auto* const known = std::ranges::find_if(
            ForceWords::all, [&](const ForceWords::Row& one) { return words == one.words; });
        const bool is_known = known != std::end(ForceWords::all);
        const QString why = is_known ? ForceWords::tr(known->words) : words;
        const QString spoken =
            tr("Force %1 N of %2 N %3").arg(force, 0, 'f', 2).arg(limit).arg(why);
        if (spoken == accessibleName()) return;
        setAccessibleName(spoken);
        QString tip = tr("Force on the hand [N] against the limit in use");
        if (is_known && *known->meaning != '\0') tip += "\n" + ForceWords::tr(known->meaning);
        setToolTip(tip);
        number_->setText(QString("%1 N").arg(force, 0, 'f', 2));
        why_->setText(why);
        most_->setText(limit > 0 ? tr("of %1 N").arg(QString::number(limit, 'g', 3)) : QString());
        const double filled = limit > 0 ? std::clamp(force / limit, 0.0, 1.0) : 0;
        bar_->setValue(static_cast<int>(std::lround(places * filled)));
        QPalette palette = this->palette();
        palette.setColor(
            QPalette::Highlight,
            readable(to_qt(filled > 0.9 ? near_limit : pictures::force_colour), palette));
        bar_->setPalette(palette);
    }

  private:
    QLabel* number_ = named(new QLabel, "force_number");
    QLabel* why_ = named(new QLabel, "force_reduced");
    QLabel* most_ = named(new QLabel, "force_most");
    QProgressBar* bar_ = named(new QProgressBar, "force_bar");
};

/// Switches show the session's state, whatever was clicked.
class SessionBar : public EffectForm {
    Q_DECLARE_TR_FUNCTIONS(palpate::viewer::SessionBar)

  public:
    explicit SessionBar(Effect& effect)
        : EffectForm(effect),
          gauge_(new ForceGauge),
          contact_(
              named(new QLabel, "contact",
                    tr("Whether the proxy is on a surface, and how far it is from the hand (of "
                       "the hand, and in the volume)"))) {
        forces_ = make_switch(
            "forces", tr("Forces on or off (space bar). Off: zero at once; on: they ramp up"),
            [this] { return effect_.there() && effect_.settings().forces_on; },
            [](bool on) { return command::Forces{on}; },
            [this](bool on) {
                return !on                ? tr("Forces are OFF")
                       : waits_.isEmpty() ? tr("Forces are ON")
                                          : tr("Forces WAIT") + '\n' + waits_;
            });
        auto* freeze = make_switch(
            "freeze", tr("Hand and proxy stand still for the session, forces are let go"),
            [this] { return effect_.there() && effect_.session().frozen; },
            [](bool on) { return command::Freeze{on}; },
            [](bool on) { return on ? tr("Frozen") : tr("Freeze"); });
        auto* clutch = make_switch(
            "clutch", tr("The volume hangs on the hand, to put it elsewhere; forces are let go"),
            [this] { return effect_.there() && effect_.session().clutched; },
            [](bool on) { return command::Clutch{on}; },
            [](bool on) { return on ? tr("Clutched") : tr("Clutch"); });
        QFont big = forces_->font();
        big.setBold(true);
        big.setPointSizeF(1.25 * big.pointSizeF());
        forces_->setFont(big);
        forces_->setMinimumHeight(static_cast<int>(2.6 * fontMetrics().height()));
        contact_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Fixed);
        contact_->setWordWrap(true);
        contact_->setFixedHeight(2 * fontMetrics().lineSpacing());  // of a tool in contact
        contact_->setAlignment(Qt::AlignTop);
        auto* switches = column_of({freeze, clutch});
        switches->layout()->setSpacing(2);
        column_in(this, {row_of({forces_, switches}, 0), gauge_, contact_});
        connect(&effect_, &Effect::observed, this, &SessionBar::show_snapshot);
        clear();
        refresh();
    }

  protected:
    void changeEvent(QEvent* event) override {
        if (event->type() == QEvent::PaletteChange && forces_) colour_forces();
        QWidget::changeEvent(event);
    }

  private:
    QPushButton* make_switch(const char* name, const QString& tip, std::function<bool()> state,
                             std::function<Command(bool)> command,
                             std::function<QString(bool)> text) {
        auto* one =
            button({name, "", tip}, [this, state, command] { effect_.request(command(!state())); });
        one->setCheckable(true);
        return each_time(one, [state, text](QPushButton& shown) {
            shown.setChecked(state());
            shown.setText(text(state()));
        });
    }

    /// On: green, waiting: amber, off: as any button. The text says it, too.
    void colour_forces() {
        forces_->setProperty("waiting", !waits_.isEmpty());
        forces_->setStyleSheet({});  // rules by property and palette are looked up only once
        forces_->setStyleSheet(
            "QPushButton:checked:enabled { background-color: #00855f; color: white; border: 1px "
            "solid #00553c; border-radius: 4px; }"
            "QPushButton:checked:enabled[waiting=true] { background-color: #ffb000; color: black; "
            "border-color: #8a5f00; }"
            "QPushButton:checked:enabled:focus { border: 2px solid palette(highlight); }");
    }

    double limit() const {
        return std::min(effect_.settings().force.limit, effect_.settings().device.maximum_force);
    }

    void begin() override {
        contact_->setText(tr("no tick yet"));
        gauge_->show_force(0, limit());
    }

    void clear() override {
        waits_.clear();
        colour_forces();
        gauge_->show_force(0, 0);
        contact_->clear();
    }

    /// Why there is no force although forces are on; empty: nothing holds them back.
    static QString reason_of(const Snapshot& now, const std::string& words) {
        if (now.session.frozen) return tr("frozen");
        if (now.session.clutched) return tr("clutched");
        if (now.session.device.status == DeviceStatus::finished) return tr("the motion has ended");
        if (words == "no input") return tr("no input from the device");
        if (words == "waiting for data") return tr("data is being read");
        return waits_for_hand(now) ? tr("withdraw a little") : QString();
    }

    void show_snapshot(const Snapshot& now) {
        const std::string words = app::force_words(now.session.tick);
        const QString why = reason_of(now, words);
        if (why != std::exchange(waits_, why)) colour_forces();
        refresh();
        const Tick& tick = now.session.tick;
        gauge_->show_force(tick.force.norm(), limit(), QString::fromStdString(words));
        const Ruler ruler = ruler_of(effect_.field().geometry());
        const double apart = (tick.proxy.scp - tick.proxy.hip).norm();
        const bool touching = tick.proxy.mode == palpate::Mode::constrained;
        const QString state = (touching ? tr("In contact, pull %1 mm") : tr("Free, pull %1 mm"))
                                  .arg(apart / now.session.transform.scale, 0, 'f', 2);
        QString text = state + ' ' +
                       tr("(%1 %2 in the volume)")
                           .arg(QString::fromStdString(ruler.number(apart, 2)),
                                QCoreApplication::translate("Units", ruler.unit));
        if (tick.tool.contacts > 0) {
            if (fontMetrics().horizontalAdvance(text) > contact_->width()) text = state;
            text +=
                '\n' + tr("%n points of the tool hold, torque %1 N mm", nullptr, tick.tool.contacts)
                           .arg(tick.torque.norm(), 0, 'f', 1);
        }
        contact_->setText(text);
    }

    QString waits_;  // why forces that are on are not there; empty: nothing holds them back
    QPushButton* forces_ = nullptr;
    ForceGauge* gauge_;
    QLabel* contact_;
};

}  // namespace

Form* session_section(Effect& effect) {
    return new SessionBar(effect);
}

}  // namespace palpate::viewer
