// Failures: what is told, and what stays as it was.
#include <sys/stat.h>
#include <QAction>
#include <QMenu>
#include <QMessageBox>
#include <QPalette>
#include <QPushButton>
#include <QToolBar>
#include <QToolButton>
#include <algorithm>
#include <fstream>
#include <iterator>
#include <thread>

#include "apps/viewer/window/preferences.hpp"
#include "devices/claim.hpp"
#include "viewer/window/window_fixture.hpp"

namespace palpate::viewer::test {
namespace {

using Failures = InWindow;

constexpr const char* sphere = "synthetic:sphere:40x40x40";

TEST_F(Failures, an_unavailable_device_is_reported_wherever_it_is_requested) {
    feel(sphere);
    record("a.csv");
    wait_until([&] { return window_->live()->recording()->ticks() > 50; });
    stop_recording();
    window_.reset();
    open_window("recorded:file=missing.csv");
    window_->files().open_path(scratch("a.csv"));
    wait_until([&] { return window_->playback() != nullptr; });
    // The volume that is open already: nothing is loaded in between.
    window_->files().open_path(sphere);
    wait_until([&] { return !window_->messages().problem().isEmpty(); });
    EXPECT_TRUE(window_->messages().problem().contains("missing.csv"));
    EXPECT_EQ(window_->live(), nullptr);
}

/// The one device of a test, which only one hand can have.
class Claimed final : public Device {
  public:
    explicit Claimed(const devices::DeviceScene& scene)
        : claim_("the one device"),
          device_(devices::open_device(devices::parse_device("simulated:hand=hold"), scene)) {}
    DeviceInfo info() const override { return device_->info(); }
    DeviceReading read(double time) override { return device_->read(time); }
    void write(const Wrench& wrench, double time) override { device_->write(wrench, time); }
    void stop() noexcept override { device_->stop(); }

  private:
    const devices::Claim claim_;
    std::unique_ptr<Device> device_;
};

TEST_F(Failures, a_hand_stays_frozen_when_its_device_is_chosen_again_and_refused) {
    run::Setup setup = setup_with("simulated");
    setup.open_device = [](const auto& choice, const auto& scene) -> std::unique_ptr<Device> {
        auto device = std::make_unique<Claimed>(scene);
        if (choice.options.empty()) return device;
        throw std::runtime_error("no such option");
    };
    open_window(setup);
    feel(sphere);
    press(Qt::Key_F);
    wait_until([&] { return now().session.frozen; });
    const std::int64_t before = now().number;
    use_device("simulated:hand=hold");
    EXPECT_EQ(window_->messages().problem(), "no such option");
    window_->messages().forget();
    wait_until([&] { return now().number != before && now().session.frozen; });
    wait_for_ticks(50);
    window_->tick();
    window_->tick();
    EXPECT_TRUE(now().session.frozen);
    EXPECT_TRUE(part<QPushButton>("freeze").isChecked());
    window_->content().effect().request(command::Freeze{false});
    wait_until([&] { return !now().session.frozen; });
    EXPECT_FALSE(part<QPushButton>("freeze").isChecked());
}

TEST_F(Failures, leaving_a_recording_keeps_level_and_view) {
    feel(sphere);
    window_->content().effect().request(command::Isovalue{110});
    wait_until([&] { return now().session.tick.proxy.isovalue == 110; });
    record("a.csv");
    wait_until([&] { return window_->live()->recording()->ticks() > 50; });
    stop_recording();
    window_->files().open_path(scratch("a.csv"));
    wait_until([&] { return window_->playback() != nullptr; });
    wait_until_settled();
    window_->views().scene().look_from(pictures::view_named("top"));
    press(Qt::Key_Escape);
    wait_until([&] { return window_->live() != nullptr; });
    EXPECT_EQ(window_->live()->isovalue(), 110);
    EXPECT_NE(window_->live()->mouse(), nullptr);
    EXPECT_GT(window_->views().scene().camera().towards_viewer.normalized()[2], 0.99);
}

TEST_F(Failures, a_session_of_another_persons_device_is_felt_with_the_one_at_hand) {
    std::ofstream(scratch_.path() / "s.json")
        << R"({"format": "palpate-session", "version": 1, "isovalue": 90,
               "volume": {"volume": "synthetic:sphere:40x40x40"}, "device": "recorded:none.csv"})";
    window_->files().open_path(scratch("s.json"));
    wait_until([&] { return window_->live() != nullptr; });
    EXPECT_EQ(window_->live()->isovalue(), 90);
    EXPECT_NE(window_->live()->mouse(), nullptr);
    EXPECT_TRUE(window_->messages().problem().isEmpty())
        << window_->messages().problem().toStdString();
}

TEST_F(Failures, a_recording_that_cannot_be_begun_leaves_the_session_as_it_was) {
    feel(sphere);
    std::ofstream(scratch_.path() / "there.csv") << "mine";
    const std::int64_t before = now().number;
    record("there.csv");
    EXPECT_TRUE(window_->messages().problem().contains("there.csv"));
    EXPECT_EQ(window_->messages().problem_status(), 5);
    EXPECT_EQ(window_->live()->recording(), nullptr);
    EXPECT_GE(now().number, before);
    std::ifstream file(scratch_.path() / "there.csv");
    std::string text;
    file >> text;
    EXPECT_EQ(text, "mine");
}

TEST_F(Failures, a_pipe_without_a_reader_holds_up_neither_the_window_nor_the_recording_to_come) {
    feel(sphere);
    const std::string pipe = scratch("pipe.csv").toStdString();
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    window_->recordings().start(scratch("pipe.csv"));
    wait_for_ticks(50);
    EXPECT_FALSE(window_->settled());
    QWidget* shown = late_strip();
    ASSERT_NE(shown, nullptr);
    QTest::mouseClick(shown->findChild<QPushButton*>("cancel"), Qt::LeftButton);
    wait_until([&] { return window_->recordings().settled(); });
    EXPECT_FALSE(window_->recordings().recording());
    window_->recordings().start(scratch("pipe.csv"));
    std::string text;
    std::jthread reader([&] {
        std::ifstream in(pipe);
        text.assign(std::istreambuf_iterator<char>(in), {});
    });
    wait_until([&] { return window_->recordings().recording(); });
    wait_until([&] { return window_->live()->recording()->ticks() > 50; });
    stop_recording();
    reader.join();
    EXPECT_GT(std::ranges::count(text, '\n'), 50);
    EXPECT_EQ(window_->messages().problem(), "");
}

TEST_F(Failures, opening_what_is_open_gives_up_what_is_being_loaded) {
    feel(sphere);
    record("a.csv");
    wait_until([&] { return window_->live()->recording()->ticks() > 50; });
    stop_recording();
    window_->files().open_volume(run::source_named("synthetic:noise:200x200x200"));
    window_->files().open_path(scratch("a.csv"));
    wait_until([&] { return window_->playback() != nullptr; });
    EXPECT_FALSE(window_->files().loading()) << "the other volume may come after all";
    QApplication::processEvents();
    ASSERT_NE(window_->playback(), nullptr);
    EXPECT_EQ(window_->live(), nullptr);
}

TEST_F(Failures, looking_for_devices_again_changes_neither_pointer_nor_device) {
    feel(sphere);
    auto* pointer = window_->findChild<QAction*>("pointer");
    ASSERT_TRUE(pointer->isChecked());
    press(Qt::Key_H);
    ASSERT_FALSE(pointer->isChecked());
    wait_until_settled();
    QSignalSpy found(&window_->panel().device_controls(), &DeviceControls::devices_found);
    QTest::mouseClick(&on_page<QPushButton>("refresh_devices"), Qt::LeftButton);
    wait_until([&] { return !found.isEmpty(); });
    window_->tick();
    EXPECT_FALSE(pointer->isChecked());
    EXPECT_NE(window_->live()->mouse(), nullptr);
}

TEST_F(Failures, in_a_slot_are_shown_once_and_the_session_goes_on) {
    feel("synthetic:sphere:24x24x24");
    QPushButton bad(window_.get());
    bad.show();
    const auto fail = [] { throw std::out_of_range("there is no such thing"); };
    QObject::connect(&bad, &QPushButton::clicked, window_.get(), fail);
    const auto boxes = [&] { return window_->findChildren<QMessageBox*>("problem").size(); };
    QTest::mouseClick(&bad, Qt::LeftButton);
    EXPECT_EQ(window_->messages().problem(), "there is no such thing");
    EXPECT_EQ(boxes(), 1);
    QTimer::singleShot(0, window_.get(), fail);  // as one that comes again and again
    window_->messages().forget();
    viewer::wait_until([&] { return !window_->messages().problem().isEmpty(); });
    EXPECT_EQ(boxes(), 1);
    EXPECT_TRUE(window_->live());
}

TEST_F(Failures, a_level_typed_for_a_surface_that_goes_with_its_volume_is_dropped) {
    feel("synthetic:sphere:24x24x24");
    on_page<QPushButton>("add_surface").click();
    auto& level = on_page<QAbstractSpinBox>("surface_1_level");
    level.setFocus();
    QTest::keyClick(&level, Qt::Key_A, Qt::ControlModifier);
    QTest::keyClicks(&level, "77");
    feel("synthetic:sphere:20x20x20");
    EXPECT_FALSE(level.isVisible());
    QTest::keyClick(&level, Qt::Key_Return);
    EXPECT_TRUE(window_->panel().look_controls().look().surfaces.empty());
    EXPECT_EQ(window_->messages().problem(), "");
}

TEST_F(Failures, a_key_that_is_held_switches_once) {
    for (const char* name : {"forces", "freeze", "clutch", "record", "open", "quit"}) {
        EXPECT_FALSE(window_->findChild<QAction*>(name)->autoRepeat()) << name;
    }
    EXPECT_TRUE(window_->findChild<QAction*>("level_up")->autoRepeat());
}

TEST_F(Failures, each_button_of_the_tool_bar_has_an_icon_and_says_what_it_does) {
    const auto* bar = window_->findChild<QToolBar*>("tools");
    int buttons = 0;
    for (QAction* action : bar->actions()) {
        if (action->isSeparator()) continue;
        ++buttons;
        const std::string name = action->text().toStdString();
        const auto* button = qobject_cast<QToolButton*>(bar->widgetForAction(action));
        EXPECT_FALSE(button->icon().isNull()) << name;
        EXPECT_EQ(button->toolButtonStyle(), Qt::ToolButtonIconOnly) << name;
        EXPECT_FALSE(button->toolTip().isEmpty());
        EXPECT_TRUE(button->toolTip().contains(action->shortcut().toString()));
        EXPECT_TRUE(!action->menu() || !action->menu()->isEmpty());
    }
    EXPECT_EQ(buttons, 13);
    EXPECT_EQ(window_->findChild<QAction*>("freeze")->toolTip(), "Freeze (F)");
}

TEST_F(Failures, text_is_readable_in_light_and_dark) {
    const auto contrast = [](QPalette::ColorRole text, QPalette::ColorRole ground) {
        const QPalette palette = QApplication::palette();
        return std::abs(palette.color(text).lightness() - palette.color(ground).lightness());
    };
    feel(sphere);
    for (const Appearance appearance : {Appearance::light, Appearance::dark, Appearance::system}) {
        set_appearance(appearance);
        EXPECT_EQ(saved_preferences().appearance, appearance);
        EXPECT_GT(contrast(QPalette::WindowText, QPalette::Window), 120);
        EXPECT_GT(contrast(QPalette::ButtonText, QPalette::Button), 120);
        EXPECT_GT(contrast(QPalette::Text, QPalette::Base), 120);
        wait_until_settled();
        save(appearance == Appearance::dark ? "dark" : "light");
    }
}

TEST_F(Failures, the_servo_ends_first_when_the_window_is_destroyed) {
    feel(sphere);
    window_->files().open_volume(run::source_named("synthetic:marschner-lobb:260x260x260"));
    QSignalSpy progress(&window_->files().loader(), &BackgroundTask::progressed);
    wait_until([&] { return !progress.isEmpty(); });
    window_.reset();  // neither hangs nor crashes
}

}  // namespace
}  // namespace palpate::viewer::test
