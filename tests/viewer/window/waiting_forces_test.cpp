// The words of the window while forces are switched on and the hand feels none.
#include <QLabel>
#include <QPushButton>
#include <QStatusBar>

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
    QString hint() {
        const auto& label = part<QLabel>("hint");
        return label.isVisible() ? label.text() : QString();
    }
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

TEST_F(WaitingForces, of_a_simulated_hand_that_has_ended_are_explained_everywhere) {
    open_window("simulated:hand=hold,seconds=0.5");
    feel("synthetic:sphere:24x24x24");
    wait_until([&] { return now().session.device.status == DeviceStatus::finished; });
    EXPECT_EQ(words(), "Forces WAIT\nthe motion has ended");
    EXPECT_TRUE(hint().contains("the hand has come to its end", Qt::CaseInsensitive));
    EXPECT_TRUE(hint().contains("Device"));
    EXPECT_TRUE(window_->statusBar()->currentMessage().contains("come to its end"))
        << window_->statusBar()->currentMessage().toStdString();
}

}  // namespace
}  // namespace palpate::viewer::test
