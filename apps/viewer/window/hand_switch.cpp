// A button for each hand, in its colour. It also shows problems of its device.
#include "apps/viewer/window/hand_switch.hpp"

#include <QBoxLayout>
#include <QButtonGroup>

#include <algorithm>
#include <string>

#include "apps/viewer/panel/colours.hpp"
#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/window/brush_controls.hpp"
#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/messages.hpp"

namespace palpate::viewer {

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
