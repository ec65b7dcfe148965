// Tools in the window: choosing one, pressing and turning it with the mouse, files, sessions.
#include <QCheckBox>
#include <QComboBox>
#include <QLabel>
#include <algorithm>
#include <fstream>

#include "apps/viewer/window/tool_controls.hpp"
#include "palpate/io/mesh_file.hpp"
#include "palpate/surface.hpp"
#include "viewer/window/window_fixture.hpp"

namespace palpate::viewer::test {
namespace {

constexpr const char* ball = "synthetic:sphere:48x48x48";

class ToolInWindow : public InWindow {
  protected:
    std::shared_ptr<const Tool> tool() { return window_->live()->settings().tool; }
    void choose(const char* name) {
        auto& box = part<QComboBox>("tool");
        const int row = box.findText(name);
        ASSERT_GE(row, 0) << name;
        box.setCurrentIndex(row);
        Q_EMIT box.activated(row);
        wait_until([&] {
            return !window_->panel().tool_controls().maker().busy() &&
                   window_->live()->waiting() == 0;
        });
    }
    void turn(const QPoint& from, const QPoint& to) {
        drag(window_->views().scene(), from, to, Qt::LeftButton, Qt::ControlModifier);
        wait_for_hand();
    }
};

TEST_F(ToolInWindow, a_click_brings_the_tool_and_not_its_middle_to_the_surface) {
    feel(ball);
    for (const char* name : {"Burr", "Ball", "Point"}) {
        choose(name);
        Scene& scene = window_->views().scene();
        QTest::mouseClick(&scene, Qt::LeftButton, {}, scene.rect().center() + QPoint(50, 20));
        wait_until([&] { return !window_->probe().travelling(); });
        wait_for_hand();
        wait_for_ticks(4);
        EXPECT_EQ(now().session.tick.proxy.mode, Mode::constrained) << name;
        EXPECT_GT(force(), 0.1) << name;
        EXPECT_LT(force(), 0.6) << name;
    }
}

TEST_F(ToolInWindow, is_pressed_and_turned_with_the_mouse) {
    feel(ball);
    choose("Box");
    ASSERT_TRUE(tool());
    press_until_force();  // also while the proxy still lags in free space
    wait_until([&] { return now().session.tick.tool.contacts > 0; });
    save("tool-pressed");
    const QPoint middle = window_->views().scene().rect().center();
    turn(middle, middle + QPoint(90, 40));
    const Tick tick = now().session.tick;
    const double turned = tick.tool.hand.angularDistance(Quaternion::Identity());
    EXPECT_GT(turned, 0.3);
    // A flat face that is turned on a ball pushes back.
    wait_until([&] { return now().session.tick.torque.norm() > 1; });
    save("tool-turned");
    QTest::keyClick(&window_->views().scene(), Qt::Key_Left, Qt::ControlModifier);
    wait_until([&] { return now().session.tick.tool.hand.angularDistance(tick.tool.hand) > 0.05; });
    choose("Point");
    EXPECT_FALSE(tool());
    wait_until([&] { return now().session.tick.tool.contacts == 0; });
}

TEST_F(ToolInWindow, comes_from_a_mesh_that_is_dropped_and_goes_with_the_session) {
    feel(ball);
    ToolShape hook{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 9}},
                   {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
    SurfaceMesh mesh;
    mesh.vertices = hook.vertices;
    mesh.triangles = hook.triangles;
    const QString path = QString::fromStdString((scratch_.path() / "hook.stl").string());
    io::write_mesh(mesh, path.toStdString());
    drop(path);
    wait_until([&] { return tool() != nullptr; });
    EXPECT_EQ(tool()->shape().triangles.size(), 4U);
    EXPECT_EQ(part<QComboBox>("tool").currentText(), "hook.stl");
    const std::size_t points = tool()->points().size();
    press_until_force();
    EXPECT_GT(now().session.tick.tool.contacts, 0);
    save("tool-of-a-mesh");
    const QString session = QString::fromStdString((scratch_.path() / "hook.json").string());
    window_->files().save_session(session);
    choose("Point");
    ASSERT_FALSE(tool());
    window_->files().open_path(session);
    wait_until([&] { return window_->live() && tool() != nullptr; });
    EXPECT_EQ(tool()->points().size(), points);
    EXPECT_EQ(tool()->shape().triangles.size(), 4U);
    EXPECT_EQ(part<QComboBox>("tool").currentText(), "This session's tool");
}

TEST_F(ToolInWindow, of_the_command_line_is_made_with_the_volume_and_not_by_the_run) {
    const ToolShape pyramid{{{0, 0, 0}, {9, 0, 0}, {0, 9, 0}, {0, 0, 9}},
                            {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
    run::Setup setup = setup_with("mouse");
    setup.render.tool = io::MeshSpec{std::make_shared<ToolShape>(pyramid)};
    open_window(setup);
    for (const char* volume : {ball, "synthetic:sphere:32x32x32"}) {
        feel(volume);
        EXPECT_TRUE(std::holds_alternative<io::PointsSpec>(window_->live()->setup().render.tool));
        const Geometry& grid = window_->live()->field().geometry();
        const Tool same = mesh_tool(pyramid, io::usual_spacing(grid));
        ASSERT_TRUE(tool());
        EXPECT_TRUE(std::ranges::equal(tool()->points(), same.points()));
        EXPECT_EQ(tool()->gyration(), same.gyration());
        EXPECT_EQ(tool()->shape().triangles, pyramid.triangles);
    }
    setup.render.tool = io::MeshSpec{std::make_shared<ToolShape>()};
    open_window(setup);
    window_->files().open_path(ball);
    viewer::wait_until([&] { return !window_->messages().problem().isEmpty(); });
    EXPECT_TRUE(window_->messages().problem().startsWith("--tool: "));
}

TEST_F(ToolInWindow, drills_with_its_own_shape) {
    feel(ball);
    auto& shape = part<QCheckBox>("brush_as_tool");
    EXPECT_FALSE(shape.isEnabled());
    choose("Burr");
    press_until_force();
    ASSERT_TRUE(shape.isEnabled());
    shape.click();
    press(Qt::Key_B);
    const auto edits = [&] { return window_->live()->data().editor().state(); };
    wait_until([&] { return edits().version > 0; });
    for (int i = 0; i < 10; ++i) {
        turn_wheel(window_->views().scene(), 1);
        wait_for_hand();
    }
    // The room that the tool has made for itself: nothing is solid where it is.
    press(Qt::Key_B);
    wait_until_settled();
    const Tick tick = now().session.tick;
    const Field field = linear_field(edits().samples, Solid::above);
    EXPECT_LT(value_at(field, tick.proxy.scp), tick.proxy.isovalue);
    EXPECT_GT(value_at(linear_field(edits().samples->volume()), tick.proxy.scp),
              tick.proxy.isovalue);
    save("tool-drilled");
    choose("Point");
    EXPECT_FALSE(window_->panel().brush_controls().choice().as_tool);
}

TEST_F(ToolInWindow, that_cannot_be_read_is_said_and_changes_nothing) {
    feel(ball);
    choose("Ball");
    const auto before = tool();
    const auto path = scratch_.path() / "bad.stl";
    std::ofstream(path) << "no mesh";
    window_->panel().tool_controls().open(QString::fromStdString(path.string()));
    wait_until([&] { return !window_->messages().problem().isEmpty(); });
    EXPECT_TRUE(window_->messages().problem().contains("bad.stl"));
    EXPECT_EQ(tool(), before);
}

}  // namespace
}  // namespace palpate::viewer::test
