// Sections of the panel that are folded, from one start to the next.
#include <QToolButton>

#include "apps/viewer/panel/layout.hpp"
#include "viewer/window/window_fixture.hpp"

namespace palpate::viewer::test {
namespace {

using Folds = InWindow;

TEST_F(Folds, are_those_of_the_last_window_but_for_one_that_forgets_its_layout) {
    const auto is_open = [this](const char* name) { return part<Section>(name).is_open(); };
    const auto click = [this](const char* heading) {
        QTest::mouseClick(&on_page<QToolButton>(heading), Qt::LeftButton);
    };
    feel("synthetic:sphere:24x24x24");
    ASSERT_TRUE(is_open("session_part"));
    ASSERT_FALSE(is_open("loop_part"));
    click("session_part_heading");
    on_page<QToolButton>("loop_part_heading");  // which opens it
    EXPECT_FALSE(is_open("session_part"));
    window_->close();
    open_window("mouse");
    EXPECT_FALSE(is_open("session_part"));
    EXPECT_TRUE(is_open("loop_part"));
    EXPECT_TRUE(is_open("tool_part"));
    window_->forget_layout();  // for a picture
    EXPECT_TRUE(is_open("session_part"));
    EXPECT_FALSE(is_open("loop_part"));
    window_->close();
    open_window("mouse");
    EXPECT_FALSE(is_open("session_part")) << "that window changed nothing";
}

}  // namespace
}  // namespace palpate::viewer::test
