// The switch between two hands, in the panel.
#include "apps/viewer/model/hands.hpp"
#include "apps/viewer/panel/colours.hpp"
#include "apps/viewer/window/device_controls.hpp"
#include "tests/viewer/panel/panel_fixture.hpp"

namespace palpate::viewer {
namespace {

class HandsOfPanel : public PanelFixture {
  protected:
    void feel_with_two() {
        feel(std::vector<std::string>{"mouse", "simulated:hand=hold,seconds=3600"});
    }
    QColor colour_of(int hand) {
        const QImage button = find<QPushButton>(hand == 1 ? "hand_1" : "hand_2")->grab().toImage();
        const int at = static_cast<int>(4 * button.devicePixelRatio());  // above its words
        return {button.pixel(2 * at, at)};
    }
    static QColor own_colour(int hand) { return {to_qt(colours_of(hand).hip).rgb()}; }
};

TEST_F(HandsOfPanel, one_needs_no_switch) {
    feel("mouse");
    EXPECT_FALSE(panel.hand_switch().isVisible());
    feel_with_two();
    EXPECT_TRUE(panel.hand_switch().isVisible());
}

TEST_F(HandsOfPanel, the_chosen_one_has_its_button_in_the_colour_that_it_has_in_the_scene) {
    feel_with_two();
    EXPECT_EQ(colour_of(1), own_colour(1));
    EXPECT_NE(colour_of(2), own_colour(2));
    press("hand_2");
    EXPECT_EQ(content.hand(), 2);
    EXPECT_NE(colour_of(1), own_colour(1));
    EXPECT_EQ(colour_of(2), own_colour(2));
    panel.hand_switch().choose_next();  // by a key of the window
    EXPECT_EQ(colour_of(1), own_colour(1));
    EXPECT_NE(own_colour(1), own_colour(2));
}

}  // namespace
}  // namespace palpate::viewer
