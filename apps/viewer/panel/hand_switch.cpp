// A button for each hand, in its colour.
#include "apps/viewer/panel/hand_switch.hpp"

#include <QBoxLayout>
#include <QButtonGroup>
#include <QLabel>

#include "apps/viewer/panel/colours.hpp"
#include "apps/viewer/panel/layout.hpp"

namespace palpate::viewer {

HandSwitch::HandSwitch() {
    setObjectName("hand_switch");
    auto* group = new QButtonGroup(this);
    auto* row = row_in(this, {new QLabel(tr("Settings of"))});
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
    connect(group, &QButtonGroup::idClicked, this, &HandSwitch::wanted);
    show_hands({}, 1);
}

void HandSwitch::show_hands(const std::vector<Hand>& hands, int chosen) {
    setVisible(hands.size() > 1);
    if (hands.size() < 2) return;
    for (int hand = 1; hand <= static_cast<int>(hands.size()); ++hand) {
        const Hand& its = hands[static_cast<std::size_t>(hand - 1)];
        QPushButton& button = *buttons_[hand];
        const QString words = tr("Hand %1: %2").arg(hand).arg(its.device);
        const QString text = its.problem.isEmpty() ? words : QString::fromUtf8("⚠ ") + words;
        button.setChecked(hand == chosen);
        // Each change is told by screen readers.
        if (button.text() == text && button.accessibleDescription() == its.problem) continue;
        button.setText(text);
        button.setAccessibleName(tr("Settings of hand %1, %2").arg(hand).arg(its.device));
        button.setAccessibleDescription(its.problem);
    }
}

}  // namespace palpate::viewer
