// The tool in the panel: a choice becomes a command, with the size asked for.
#include <QComboBox>

#include <cmath>
#include <cstdint>

#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/window/device_controls.hpp"
#include "apps/viewer/window/tool_controls.hpp"
#include "viewer/panel/panel_fixture.hpp"

namespace palpate::viewer {
namespace {

class PanelTool : public PanelFixture {
  protected:
    PanelTool() {
        RendererSettings settings;
        set(settings);
    }
    /// As PanelFixture::set, on the smooth field, which tools need.
    void set_smooth(const RendererSettings& settings) {
        session_settings = settings;
        field.emplace(head_like(), Solid::above, std::nullopt, Interpolation::cubic);
        begin(*field, 300, settings);
    }
    void choose(int row) {
        auto* choice = find<QComboBox>("tool");
        choice->setCurrentIndex(row);
        Q_EMIT choice->activated(row);
        settle();
    }
    /// A ball of so many triangles that its points take a while.
    static io::ToolSpec large_mesh() {
        constexpr int rings = 400;
        auto shape = std::make_shared<ToolShape>();
        for (int ring = 0; ring <= rings; ++ring) {
            for (int i = 0; i < rings; ++i) {
                const double up = 3.14159265 * ring / rings, around = 2 * 3.14159265 * i / rings;
                shape->vertices.push_back(5 * Vec3(std::sin(up) * std::cos(around),
                                                   std::sin(up) * std::sin(around), std::cos(up)));
                if (ring == rings) continue;
                const auto at = [](int r, int k) { return std::uint32_t(r * rings + k % rings); };
                shape->triangles.push_back({at(ring, i), at(ring + 1, i), at(ring, i + 1)});
                shape->triangles.push_back({at(ring, i + 1), at(ring + 1, i), at(ring + 1, i + 1)});
            }
        }
        return io::MeshSpec{shape};
    }
    std::shared_ptr<const Tool> last_tool() const {
        const auto* use =
            commands.empty() ? nullptr : std::get_if<command::UseTool>(&commands.back());
        return use ? use->tool : nullptr;
    }
};

TEST_F(PanelTool, asks_for_the_tool_that_is_chosen_in_the_size_that_is_set) {
    set_smooth({});
    commands.clear();
    choose(1);
    ASSERT_TRUE(last_tool());
    const double radius = last_tool()->radius();
    EXPECT_GT(radius, 1);
    EXPECT_EQ(effect.settings().tool, last_tool());
    EXPECT_TRUE(find<QLabel>("tool_about")->text().contains("points"));
    find<NumberBox>("tool_scale_box")->setValue(2);
    settle();
    EXPECT_NEAR(last_tool()->radius(), 2 * radius, 1e-9);
    choose(0);
    ASSERT_FALSE(commands.empty());
    EXPECT_FALSE(std::get<command::UseTool>(commands.back()).tool);
    EXPECT_TRUE(find<QLabel>("tool_about")->text().isEmpty());
}

TEST_F(PanelTool, goes_back_where_the_session_refuses) {
    set_smooth({});
    choose(4);
    const auto burr = last_tool();
    refuse_with = "no";
    choose(1);
    EXPECT_EQ(effect.settings().tool, burr);
    EXPECT_EQ(find<QComboBox>("tool")->currentIndex(), 4);
    refuse_with.clear();
    // On the linear field tools are refused in words.
    set({});
    commands.clear();
    choose(2);
    EXPECT_TRUE(commands.empty());
    EXPECT_EQ(find<QComboBox>("tool")->currentIndex(), 0);
    EXPECT_FALSE(find<QLabel>("tool_part_message")->text().isEmpty());
}

TEST_F(PanelTool, that_a_session_brings_is_shown_and_keeps_its_points) {
    RendererSettings settings;
    const std::vector<Vec3> points{Vec3(0, 0, 0), Vec3(0, 0, 7)};
    const ToolShape shape{{{0, 0, 0}, {1, 0, 0}, {0, 0, 7}}, {{0, 1, 2}}};
    settings.tool = std::make_shared<const Tool>(points, 3, false, shape);
    set_smooth(settings);
    EXPECT_EQ(find<QComboBox>("tool")->currentText(), "This session's tool");
    EXPECT_TRUE(find<QLabel>("tool_about")->text().contains("2 points"));
    commands.clear();
    find<NumberBox>("tool_scale_box")->setValue(0.5);
    settle();
    ASSERT_TRUE(last_tool());
    EXPECT_EQ(last_tool()->points().size(), 2U);
    EXPECT_NEAR(last_tool()->radius(), 3.5, 1e-9);
    EXPECT_FALSE(last_tool()->turns());
    ASSERT_EQ(last_tool()->shape().triangles.size(), 1U);
    EXPECT_EQ(last_tool()->shape().vertices[2], Vec3(0, 0, 3.5));
    // Another session's takes its place in the list.
    const int choices = find<QComboBox>("tool")->count();
    settings.tool = std::make_shared<const Tool>(rod_tool(7, 1));
    set_smooth(settings);
    EXPECT_EQ(find<QComboBox>("tool")->count(), choices);
    EXPECT_TRUE(find<QLabel>("tool_about")->text().contains("8 points"));
}

TEST_F(PanelTool, is_made_while_the_panel_goes_on_and_can_be_given_up) {
    set_smooth({});
    commands.clear();
    BackgroundTask& maker = panel.tool_controls().maker();
    auto* choice = find<QComboBox>("tool");
    panel.tool_controls().add("large.stl", large_mesh());
    EXPECT_TRUE(maker.busy());
    EXPECT_TRUE(commands.empty()) << "it is in the making";
    EXPECT_EQ(choice->currentText(), "large.stl") << "what was asked for";
    maker.cancel();
    settle();
    EXPECT_TRUE(commands.empty());
    EXPECT_EQ(choice->currentText(), "Point") << "what is in effect";
    // Another choice takes its place, and so does another session.
    panel.tool_controls().add("again.stl", large_mesh());
    choose(1);
    ASSERT_EQ(commands.size(), 1U);
    EXPECT_FALSE(last_tool()->turns()) << "the ball";
    panel.tool_controls().add("once more.stl", large_mesh());
    set_smooth({});
    settle();
    EXPECT_EQ(commands.size(), 1U);
    EXPECT_EQ(choice->currentText(), "Point");
}

TEST_F(PanelTool, of_a_large_mesh_is_felt_once_it_is_made) {
    set_smooth({});
    QSignalSpy progress(&panel.tool_controls().maker(), &BackgroundTask::progressed);
    panel.tool_controls().add("large.stl", large_mesh());
    settle();
    EXPECT_GT(progress.count(), 10);
    ASSERT_TRUE(last_tool());
    EXPECT_NEAR(last_tool()->radius(), 5, 0.01);
    EXPECT_EQ(find<QComboBox>("tool")->currentText(), "large.stl");
    EXPECT_TRUE(find<QWidget>("tool_scale")->isEnabled());
}

TEST_F(PanelTool, that_cannot_be_made_says_why_and_the_one_before_stays) {
    set_smooth({});
    choose(4);
    const auto burr = last_tool();
    panel.tool_controls().add("empty.stl", io::MeshSpec{std::make_shared<ToolShape>()});
    settle();
    EXPECT_EQ(effect.settings().tool, burr);
    EXPECT_EQ(find<QComboBox>("tool")->currentIndex(), 4);
    EXPECT_TRUE(message("tool_part").startsWith("a tool's mesh"))
        << message("tool_part").toStdString();
}

TEST_F(PanelTool, of_a_file_is_one_more_choice) {
    set_smooth({});
    commands.clear();
    panel.tool_controls().add("hook.csv", io::PointsSpec{{Vec3::Zero(), Vec3(1, 0, 2)}});
    settle();
    ASSERT_TRUE(last_tool());
    EXPECT_EQ(last_tool()->points().size(), 2U);
    EXPECT_EQ(find<QComboBox>("tool")->currentText(), "hook.csv");
}

}  // namespace
}  // namespace palpate::viewer
