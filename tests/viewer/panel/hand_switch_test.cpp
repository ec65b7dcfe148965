// The switch that says which hand's settings the panel shows.

#include "apps/viewer/panel/hand_switch.hpp"
#include "apps/viewer/panel/device_controls.hpp"
#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/panel/layout.hpp"
#include "tests/viewer/panel/panel_fixture.hpp"

namespace palpate::viewer {
namespace {

class HandsOfPanel : public PanelFixture {
  protected:
    HandsOfPanel() {
        QObject::connect(&hands(), &HandSwitch::wanted,
                         [this](int hand) { wanted.push_back(hand); });
    }
    HandSwitch& hands() { return panel.hand_switch(); }
    std::vector<int> wanted;
};

TEST_F(HandsOfPanel, one_hand_needs_no_switch_and_two_are_told_apart_by_words_and_colour) {
    set();
    hands().show_hands({{"mouse", {}}}, 1);
    EXPECT_FALSE(hands().isVisible());
    hands().show_hands({{"mouse", {}}, {"haply", {}}}, 2);
    EXPECT_TRUE(hands().isVisible());
    auto *one = find<QPushButton>("hand_1"), *two = find<QPushButton>("hand_2");
    EXPECT_FALSE(one->isChecked());
    EXPECT_TRUE(two->isChecked());
    EXPECT_EQ(two->text(), "Hand 2: haply");
    EXPECT_EQ(two->accessibleName(), "Settings of hand 2, haply");
    const auto colour_of = [](QPushButton* button) {
        return QColor(button->grab().toImage().pixel(6, button->height() / 2));
    };
    const QColor second = colour_of(two);
    hands().show_hands({{"mouse", {}}, {"haply", "lost: check the cable"}}, 1);
    EXPECT_NE(colour_of(two), second);
    EXPECT_NE(colour_of(one), second);
    EXPECT_TRUE(two->text().startsWith(QString::fromUtf8("\u26A0")));
    EXPECT_EQ(two->accessibleDescription(), "lost: check the cable");
    EXPECT_TRUE(wanted.empty());
}

TEST_F(HandsOfPanel, the_other_hand_is_chosen_by_mouse_and_keys) {
    set();
    hands().show_hands({{"mouse", {}}, {"haply", {}}}, 1);
    press("hand_2");
    EXPECT_EQ(wanted, std::vector{2});
    find<QPushButton>("hand_2")->setFocus();
    QTest::keyClick(find<QPushButton>("hand_2"), Qt::Key_Left);
    EXPECT_EQ(wanted, (std::vector{2, 1}));
}

TEST_F(HandsOfPanel, a_hand_is_added_with_the_device_that_is_chosen_and_removed) {
    set();
    QSignalSpy added(&panel.device_controls(), &DeviceControls::added);
    QSignalSpy removed(&panel.device_controls(), &DeviceControls::removed);
    panel.device_controls().set_devices({}, "simulated:seed=3");
    EXPECT_FALSE(find<QPushButton>("remove_hand")->isVisible());
    press("add_hand");
    ASSERT_EQ(added.count(), 1);
    EXPECT_EQ(added.front().front().toString(), "simulated:seed=3");
    panel.device_controls().set_hands(2);
    EXPECT_FALSE(find<QPushButton>("add_hand")->isVisible());
    press("remove_hand");
    EXPECT_EQ(removed.count(), 1);
}

}  // namespace
}  // namespace palpate::viewer
