// The words of the window while forces are switched on and the hand feels none.
#include <QPushButton>

#include "viewer/window/window_fixture.hpp"

namespace palpate::viewer::test {
namespace {

class WaitingForces : public InWindow {
  protected:
    /// Once the panel has seen the newest snapshot.
    QString words() {
        for (int i = 0; i < 8; ++i) window_->tick();
        return part<QPushButton>("forces").text();
    }
    bool are_amber() { return part<QPushButton>("forces").property("waiting").toBool(); }
};

TEST_F(WaitingForces, are_not_called_on_while_the_hand_is_frozen_or_carries_the_volume) {
    feel("synthetic:sphere:24x24x24");
    EXPECT_EQ(words(), "Forces are ON");
    press(Qt::Key_F);
    wait_until([&] { return now().session.frozen; });
    EXPECT_EQ(words(), "Forces WAIT\nfrozen");
    EXPECT_TRUE(are_amber());
    press(Qt::Key_F);
    press(Qt::Key_C);
    wait_until([&] { return !now().session.frozen && now().session.clutched; });
    EXPECT_EQ(words(), "Forces WAIT\nclutched");
    press(Qt::Key_C);
    wait_until([&] { return !now().session.clutched; });
    EXPECT_EQ(words(), "Forces are ON");
    EXPECT_FALSE(are_amber());
}

}  // namespace
}  // namespace palpate::viewer::test
