// Two hands in the window: each with its settings, its force and its device, in one recording.
#include <QAbstractButton>
#include <QComboBox>
#include <QLabel>

#include "apps/viewer/model/hands.hpp"
#include "apps/viewer/model/layer_set.hpp"
#include "run/run_support.hpp"
#include "viewer/window/window_fixture.hpp"

namespace palpate::viewer::test {
namespace {

constexpr const char* felt_by_two = "synthetic:sphere:48x48x48";
const std::string holds = "simulated:hand=hold,depth=4,seconds=3600";
const std::string circles = "simulated:omega6,hand=circle,depth=3,seconds=3600";

class TwoHands : public InWindow {
  protected:
    void feel_with_two(const std::string& first = holds, const std::string& second = circles) {
        feel_with_two(setup_with(first), second);
    }
    /// Not feel(): hands that move do not settle.
    void feel_with_two(const run::Setup& setup, const std::string& second) {
        open_window(RunRequest{setup, {}, {}, {devices::parse_device(second)}});
        window_->files().open_path(felt_by_two);
        wait_until([&] { return content().snapshot(1) && content().snapshot(2); });
    }
    Content& content() { return window_->content(); }
    const RendererSettings& settings_of(int hand) { return content().live(hand)->settings(); }
    double force_of(int hand) { return content().snapshot(hand)->session.tick.force.norm(); }
    QPushButton& button_of(int hand) {
        return part<QPushButton>(("hand_" + std::to_string(hand)).c_str());
    }
    bool fails_ = false;  // the second device
};
using DrawnTwoHands = TwoHands;

TEST_F(TwoHands, each_has_settings_of_its_own_and_the_panel_says_whose_it_shows) {
    feel_with_two();
    ASSERT_EQ(content().hands(), 2);
    wait_until([&] { return force_of(1) > 0.05; });
    wait_until([&] { return force_of(2) > 0.05; });
    EXPECT_EQ(content().hand(), 1);
    EXPECT_TRUE(button_of(1).isVisible());
    EXPECT_TRUE(button_of(1).isChecked());
    press(Qt::Key_N);
    EXPECT_EQ(content().hand(), 2);
    EXPECT_TRUE(button_of(2).isChecked());
    EXPECT_EQ(button_of(2).text(), "Hand 2: simulated");
    EXPECT_EQ(button_of(2).accessibleName(), "Settings of hand 2, simulated");
    ForceSettings force = settings_of(2).force;
    force.stiffness = 0.111;
    EXPECT_TRUE(content().effect().request(force));
    const double level = content().effect().isovalue();
    EXPECT_TRUE(content().effect().request(command::Isovalue{level + 20}));
    EXPECT_EQ(settings_of(2).force.stiffness, 0.111);
    EXPECT_NE(settings_of(1).force.stiffness, 0.111);
    wait_until([&] { return window_->views().shown().isovalue == level + 20; });
    button_of(2).setFocus();
    const bool below = button_of(2).y() > button_of(1).y();  // where one line is too short for both
    QTest::keyClick(&button_of(2), below ? Qt::Key_Up : Qt::Key_Left);
    EXPECT_EQ(content().hand(), 1);
    press(Qt::Key_N);
    QTest::mouseClick(&button_of(1), Qt::LeftButton);
    EXPECT_EQ(content().effect().settings().force.stiffness, settings_of(1).force.stiffness);
    EXPECT_EQ(content().effect().isovalue(), level);
    wait_until([&] { return window_->views().shown().isovalue == level; });
    // The space bar is for the hand that the panel shows.
    press(Qt::Key_Space);
    wait_until([&] { return !content().snapshot(1)->forces_on; });
    EXPECT_TRUE(content().snapshot(2)->forces_on);
}

TEST_F(TwoHands, feel_what_the_other_carves_and_the_brush_stays_on_with_the_other_hand) {
    feel_with_two();
    window_->panel().brush_controls().toggle();
    ASSERT_TRUE(window_->panel().brush_controls().choice().on);
    wait_until([&] { return content().editor()->state().version > 3; });
    press(Qt::Key_N);
    EXPECT_TRUE(window_->panel().brush_controls().choice().on);
    const auto version = content().editor()->state().version;
    wait_until([&] { return content().editor()->state().version > version + 3; });
    for (const int hand : {1, 2}) {
        wait_until([&] { return content().snapshot(hand)->session.version > version; });
    }
    press(Qt::Key_B);
    EXPECT_FALSE(window_->panel().brush_controls().choice().on);
}

TEST_F(TwoHands, one_whose_device_fails_ends_alone_and_the_window_says_which) {
    run::Setup setup = setup_with(holds);
    setup.open_device = [this](const auto& choice, const auto& scene) -> std::unique_ptr<Device> {
        auto device = devices::open_device(choice, scene);
        if (choice != devices::parse_device(circles)) return device;
        return std::make_unique<run::test::Failing>(std::move(device), fails_);
    };
    feel_with_two(setup, circles);
    wait_until([&] { return force_of(2) > 0.05; });
    fails_ = true;
    wait_until([&] { return force_of(2) == 0; });
    wait_until([&] { return part<QLabel>("hint").text().startsWith("Hand 2: "); });
    EXPECT_TRUE(part<QLabel>("hint").isVisible());
    wait_until([&] { return button_of(2).text().startsWith(QString::fromUtf8("\u26A0")); });
    EXPECT_FALSE(button_of(2).accessibleDescription().isEmpty());
    EXPECT_EQ(content().live(1)->device_problem(), "");
    wait_for_ticks(20);
    wait_until([&] { return force_of(1) > 0.05; });
    // Once it is there again it goes on.
    fails_ = false;
    press(Qt::Key_N);
    use_device(circles);
    wait_until([&] { return content().snapshot(2) && force_of(2) > 0.05; });
    wait_until([&] { return !button_of(2).text().startsWith(QString::fromUtf8("\u26A0")); });
}

TEST_F(TwoHands, one_recording_has_both_and_is_played_with_both) {
    feel_with_two();
    record("both.csv");
    ASSERT_TRUE(window_->recordings().recording());
    for (const int hand : {1, 2}) {
        wait_until([&] { return content().live(hand)->recording()->ticks(hand) > 600; });
    }
    stop_recording();
    EXPECT_FALSE(window_->recordings().recording());
    EXPECT_EQ(window_->recordings().exit_status(), 0);
    window_->files().open_path(scratch("both.csv"));
    wait_until([&] { return window_->playback() != nullptr; });
    ASSERT_EQ(content().hands(), 2);
    for (const int hand : {1, 2}) EXPECT_EQ(content().playback(hand)->different(), 0U);
    wait_until_settled();
    EXPECT_TRUE(part<QLabel>("hand_number_2").isVisible());
    EXPECT_EQ(button_of(1).text(), "Hand 1: simulated") << "a model has no room";
    EXPECT_TRUE(button_of(1).isVisible());
    // The same moment by the clock of each. The second hand began after the first.
    const double later = content().playback(2)->clock() - content().playback(1)->clock();
    EXPECT_GT(later, 0);
    const double moment = content().playback(1)->begin() + 0.3;
    window_->playing().show_time(moment);
    const auto shown = content().snapshots();
    EXPECT_EQ(shown[1]->number, content().playback(1)->at(moment).number);
    EXPECT_EQ(shown[2]->number, content().playback(2)->at(moment - later).number);
    EXPECT_NE(shown[1]->session.device.position, shown[2]->session.device.position);
    press(Qt::Key_N);
    EXPECT_EQ(content().hand(), 2);
    EXPECT_EQ(content().effect().device().name, content().playback(2)->head().device);
    EXPECT_EQ(content().snapshot(1)->number, shown[1]->number);
    EXPECT_EQ(content().snapshot(2)->number, shown[2]->number);
    EXPECT_NEAR(content().time(), moment - later, 1e-9);
    press(Qt::Key_Escape);
    wait_until([&] { return window_->live() != nullptr; });
    EXPECT_EQ(content().hands(), 2);
}

TEST_F(TwoHands, feel_their_own_layers_again_after_a_recording) {
    feel_with_two();
    const double level = content().effect().isovalue();
    for (const int hand : {2, 1}) {
        content().choose_hand(hand);
        Layers layers = first_layer(level + 5 * hand, "of hand " + std::to_string(hand));
        content().effect().request(
            command::UseLayers{std::make_shared<const Layers>(std::move(layers))});
    }
    record("layers.csv");
    for (const int hand : {1, 2}) {
        wait_until([&] { return content().live(hand)->recording()->ticks(hand) > 100; });
    }
    stop_recording();
    window_->files().open_path(scratch("layers.csv"));
    wait_until([&] { return window_->playback() != nullptr; });
    press(Qt::Key_N);
    press(Qt::Key_Escape);
    wait_until([&] { return window_->live() != nullptr; });
    for (const int hand : {1, 2}) {
        ASSERT_NE(settings_of(hand).layers, nullptr) << hand;
        EXPECT_EQ(settings_of(hand).layers->layers[0].level, level + 5 * hand);
        EXPECT_EQ(settings_of(hand).layers->layers[0].name,
                  "of hand " + std::to_string(hand) + " 1");
    }
}

TEST_F(TwoHands, a_hand_is_added_and_removed_at_any_time) {
    feel(felt_by_two);
    EXPECT_FALSE(button_of(1).isVisible());
    EXPECT_TRUE(window_->probe().possible());
    add_hand(circles);
    ASSERT_EQ(content().hands(), 2);
    EXPECT_EQ(content().hand(), 2);
    EXPECT_FALSE(window_->probe().possible()) << "the mouse moves the hand that is chosen";
    wait_until([&] { return content().snapshot(2) && force_of(2) > 0.05; });
    press(Qt::Key_N);
    EXPECT_TRUE(window_->probe().pointing());
    press_until_force();
    press(Qt::Key_N);
    EXPECT_GT(force_of(1), 0.3) << "it stays where it is";
    QPushButton& remove = part<QPushButton>("remove_hand");
    remove.click();
    EXPECT_EQ(content().hands(), 1);
    EXPECT_TRUE(window_->probe().pointing());
    EXPECT_GT(force_of(1), 0.3);
    EXPECT_FALSE(button_of(1).isVisible());
    wait_until_settled();
    EXPECT_FALSE(part<QLabel>("hand_number_1").isVisible());
    add_hand("haply:host=127.0.0.1,port=1");
    EXPECT_EQ(content().hands(), 1) << "it cannot be had";
}

TEST_F(TwoHands, both_come_back_when_the_volume_is_read_again_and_from_a_session) {
    feel_with_two();
    press(Qt::Key_N);
    ForceSettings force = settings_of(2).force;
    force.stiffness = 0.111;
    content().effect().request(force);
    window_->files().save_session(scratch("two.json"));
    const auto expect_both = [&] {
        ASSERT_EQ(content().hands(), 2);
        EXPECT_EQ(content().hand(), 1);
        EXPECT_EQ(content().live(1)->setup().device, devices::parse_device(holds));
        EXPECT_EQ(content().live(2)->setup().device, devices::parse_device(circles));
        EXPECT_EQ(settings_of(2).force.stiffness, 0.111);
        EXPECT_NE(settings_of(1).force.stiffness, 0.111);
    };
    const auto volume = content().volume();
    window_->files().dequantize(true);
    wait_until([&] { return content().volume() && content().volume() != volume; });
    expect_both();
    open_window("mouse");
    window_->files().open_path(scratch("two.json"));
    wait_until([&] { return window_->live() && content().hands() == 2; });
    expect_both();
}

TEST_F(TwoHands, what_is_read_again_keeps_the_device_that_was_chosen_after_the_start) {
    RunRequest request{setup_with(holds), devices::parse_device(holds), {}};
    open_window(request);
    window_->files().open_path(felt_by_two);
    wait_until([&] { return window_->live() != nullptr; });
    use_device("mouse");
    ASSERT_NE(window_->live()->mouse(), nullptr);
    const auto volume = content().volume();
    window_->files().dequantize(true);
    wait_until([&] { return content().volume() && content().volume() != volume; });
    EXPECT_NE(window_->live()->mouse(), nullptr);
}

TEST_F(DrawnTwoHands, are_seen_in_scene_and_slices_with_their_numbers) {
    feel_with_two();
    wait_until([&] { return force_of(1) > 0.05 && force_of(2) > 0.05; });
    window_->display().hold();
    wait_until_settled();
    for (int i = 0; i < 8; ++i) window_->tick();
    wait_until_settled();
    save("two");
    // At the hand there are colours that bone has not, even where it is seen through the bone.
    Scene& scene = window_->views().scene();
    const QImage picture = scene.picture().convertToFormat(QImage::Format_RGB32);
    const int line = scene.fontMetrics().height();
    for (const int hand : {1, 2}) {
        const auto& number = part<QLabel>(QString("hand_number_%1").arg(hand).toUtf8());
        EXPECT_TRUE(number.isVisible());
        const QPoint at = number.geometry().center() + QPoint(-line, line);
        int other = 0;
        for (int y = -6; y <= 6; ++y) {
            for (int x = -6; x <= 6; ++x) {
                const QColor c = picture.pixel(at + QPoint(x, y));
                const bool bone =
                    c.red() >= c.green() && c.green() >= c.blue() && c.red() <= 2 * c.blue() + 40;
                other += !bone;
            }
        }
        EXPECT_GT(other, 60) << hand;
    }
}

}  // namespace
}  // namespace palpate::viewer::test
