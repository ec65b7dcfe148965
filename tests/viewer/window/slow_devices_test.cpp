// Drivers that do not answer and readers that are slow: the window goes on.
#include <sys/stat.h>
#include <QComboBox>
#include <QLabel>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "devices/claim.hpp"
#include "viewer/window/window_fixture.hpp"

namespace palpate::viewer::test {
namespace {

constexpr const char* felt_slowly = "synthetic:sphere:40x40x40";

/// A call that does not return until it may. For long only, so that a window that waits fails and
/// does not hang.
class Gate {
  public:
    void close() { set(false); }
    void open() { set(true); }
    /// `progress` is called meanwhile, and may throw.
    void pass(const OnProgress& progress = {}) {
        std::unique_lock lock(mutex_);
        if (!is_open_) ++waiting_;
        for (int looks = 0; !is_open_ && looks < 10'000; ++looks) {
            changed_.wait_for(lock, std::chrono::milliseconds(2));
            if (progress) progress(0);
        }
    }
    /// Calls that have been held up.
    int waiting() const { return waiting_; }

  private:
    void set(bool open) {
        const std::lock_guard lock(mutex_);
        is_open_ = open;
        changed_.notify_all();
    }
    std::mutex mutex_;
    std::condition_variable changed_;
    bool is_open_ = true;
    std::atomic<int> waiting_{0};
};

/// Where a driver can hang.
struct Driver {
    Gate opens, reads, stops, closes;
    std::atomic<bool> keeps_force{false};
    std::atomic<int> open{0}, opened{0};  // now; ever
    std::atomic<int> sessions{0};         // whose clocks began
};

/// The one device that this driver has.
class Driven final : public Device {
  public:
    Driven(Driver& driver, const devices::DeviceScene& scene)
        : driver_(driver),
          claim_("the one device"),
          device_(devices::open_device(devices::parse_device("simulated:hand=hold"), scene)) {
        driver_.opens.pass(scene.progress);
        ++driver_.open;
        ++driver_.opened;
    }
    ~Driven() override {
        driver_.closes.pass();
        --driver_.open;
    }
    DeviceInfo info() const override {
        DeviceInfo info = device_->info();
        info.buttons = 2;
        return info;
    }
    DeviceReading read(double time) override {
        if (time <= std::exchange(last_, time)) ++driver_.sessions;
        driver_.reads.pass();
        return device_->read(time);
    }
    void write(const Wrench& wrench, double time) override { device_->write(wrench, time); }
    void stop() noexcept override {
        driver_.stops.pass();
        device_->stop();
    }
    bool is_stopping() const noexcept override { return driver_.keeps_force; }

  private:
    Driver& driver_;
    const devices::Claim claim_;
    const std::unique_ptr<Device> device_;
    double last_ = std::numeric_limits<double>::infinity();
};

class SlowDevices : public InWindow {
  protected:
    void TearDown() override {
        for (Gate* gate : {&driver_.opens, &driver_.reads, &driver_.stops, &driver_.closes}) {
            gate->open();
        }
        InWindow::TearDown();
    }
    /// The device "haply" is the driver's.
    run::Setup setup(const std::string& device) {
        run::Setup made = setup_with(device);
        made.open_device = [this](const auto& choice,
                                  const auto& scene) -> std::unique_ptr<Device> {
            if (choice.name != "haply") return devices::open_device(choice, scene);
            if (choice.options.contains("wrong")) {
                const Driven closed(driver_, scene);
                throw devices::DeviceError("wrong options");
            }
            return std::make_unique<Driven>(driver_, scene);
        };
        return made;
    }
    void feel_with(const std::string& device) {
        open_window(setup(device));
        feel(felt_slowly);
    }
    std::string used() const { return run::text_of(window_->live()->setup().device); }
    /// The window has handled what was to come later.
    void expect_it_answers() {
        bool answers = false;
        QTimer::singleShot(0, window_.get(), [&] { answers = true; });
        viewer::wait_until([&] { return answers; });
        press(Qt::Key_F);
        if (window_->live()) wait_until([&] { return now().session.frozen; });
        press(Qt::Key_F);
    }
    void connect(const char* device) { connector().use_device(devices::parse_device(device)); }
    /// The device answers late: until then it is being connected.
    void begin_to(void (Connector::*open)(const devices::DeviceChoice&), const char* device) {
        driver_.opens.close();
        const int before = driver_.opens.waiting();
        (connector().*open)(devices::parse_device(device));
        wait_until([&] { return driver_.opens.waiting() > before; });
    }
    void choose(const char* box, Qt::Key key) { QTest::keyClick(&on_page<QComboBox>(box), key); }

    Driver driver_;
};

TEST_F(SlowDevices, that_are_opened_with_a_volume_leave_the_window_free) {
    open_window(setup("haply"));
    driver_.opens.close();
    window_->files().open_path(felt_slowly);
    wait_until([&] { return driver_.opens.waiting() == 1; });
    expect_it_answers();
    ASSERT_TRUE(late_strip());
    EXPECT_EQ(late_strip()->findChild<QLabel*>()->text(), "Connecting to haply");
    EXPECT_FALSE(window_->settled());
    driver_.opens.open();
    wait_until([&] { return window_->live() && window_->live()->snapshot(); });
    EXPECT_EQ(used(), "haply");
    EXPECT_EQ(strip(), nullptr);
}

TEST_F(SlowDevices, that_are_chosen_leave_the_hand_with_its_own_until_they_answer) {
    feel_with("mouse");
    begin_to(&Connector::use_device, "haply");
    expect_it_answers();
    EXPECT_EQ(used(), "mouse");
    driver_.opens.open();
    wait_until([&] { return used() == "haply"; });
    wait_for_ticks(5);
}

TEST_F(SlowDevices, can_be_given_up) {
    feel_with("mouse");
    begin_to(&Connector::use_device, "haply");
    late_strip();
    cancel_task();
    driver_.opens.open();
    wait_until_connected();
    EXPECT_EQ(used(), "mouse");
    EXPECT_EQ(window_->messages().problem(), "");
}

TEST_F(SlowDevices, that_are_closed_leave_the_window_free) {
    feel_with("haply");
    driver_.closes.close();
    connect("mouse");
    wait_until([&] { return used() == "mouse" && driver_.closes.waiting() == 1; });
    expect_it_answers();
    EXPECT_EQ(driver_.open, 1);
    driver_.closes.open();
    wait_until([&] { return driver_.open == 0; });
}

TEST_F(SlowDevices, that_hang_while_they_are_read_can_be_left) {
    feel_with("haply");
    driver_.reads.close();
    wait_until([&] { return window_->live()->device_failure() == DeviceFailure::hung; });
    EXPECT_THROW(window_->content().use_buttons({}), std::invalid_argument);
    EXPECT_THROW(window_->content().use_field(Solid::below, Interpolation::linear),
                 std::invalid_argument);
    connect("mouse");
    wait_until([&] { return used() == "mouse"; });
    wait_for_ticks(5);
    expect_it_answers();
    EXPECT_EQ(driver_.open, 1);
    driver_.reads.open();
    wait_until([&] { return driver_.open == 0; });
}

TEST_F(SlowDevices, that_may_still_have_a_force_are_named) {
    feel_with("haply");
    driver_.keeps_force = true;
    connect("mouse");
    viewer::wait_until([&] { return !window_->messages().problem().isEmpty(); });
    EXPECT_TRUE(window_->messages().problem().contains("its force may still be on"));
    EXPECT_EQ(used(), "mouse");
}

TEST_F(SlowDevices, are_closed_before_they_are_opened_again) {
    feel_with("haply");
    window_->content().effect().request(command::Isovalue{90});
    driver_.closes.close();
    connect("haply:port=2");
    wait_until([&] { return driver_.closes.waiting() == 1; });
    expect_it_answers();
    EXPECT_EQ(now().session.device.status, DeviceStatus::lost);
    EXPECT_EQ(force(), 0);
    driver_.closes.open();
    wait_until([&] { return used() == "haply:port=2"; });
    EXPECT_EQ(window_->live()->isovalue(), 90);
    EXPECT_EQ(driver_.open, 1);
    wait_until([&] { return now().session.device.status == DeviceStatus::ready; });
}

TEST_F(SlowDevices, go_on_as_they_were_if_their_options_are_refused) {
    feel_with("haply:port=2");
    use_device("haply:wrong=1");
    EXPECT_EQ(window_->messages().problem(), "wrong options");
    EXPECT_EQ(used(), "haply:port=2");
    EXPECT_EQ(driver_.opened, 3);
    wait_until([&] { return now().session.device.status == DeviceStatus::ready; });
}

TEST_F(SlowDevices, have_the_buttons_that_were_chosen_while_they_were_connected) {
    feel_with("haply");
    begin_to(&Connector::use_device, "haply:port=2");
    choose("deadman_button", Qt::Key_Down);
    const run::Buttons chosen{run::UsualButton{}, run::Button{1}};
    EXPECT_EQ(window_->live()->setup().buttons, chosen);
    driver_.opens.open();
    wait_until([&] { return used() == "haply:port=2"; });
    EXPECT_EQ(window_->live()->setup().buttons, chosen);
    record("with-button.csv");
    wait_for_ticks(5);
    stop_recording();
    std::ifstream file(scratch("with-button.csv").toStdString());
    const std::string text(std::istreambuf_iterator<char>(file), {});
    EXPECT_NE(text.find("\"deadman_buttons\": 1,"), std::string::npos);
    // Also where it goes on as it was.
    use_device("haply:wrong=1");
    EXPECT_EQ(window_->live()->setup().buttons, chosen);
}

TEST_F(SlowDevices, that_are_added_feel_as_the_first_hand_does_by_then) {
    feel_with("simulated:hand=hold");
    begin_to(&Connector::add_hand, "haply");
    const Solid side =
        window_->live()->field().solid() == Solid::above ? Solid::below : Solid::above;
    window_->content().use_field(side, Interpolation::linear);
    window_->content().use_buttons({{}, {}});
    driver_.opens.open();
    wait_until([&] { return window_->content().hands() == 2; });
    const run::Run& added = *window_->content().live(2);
    EXPECT_EQ(added.field().solid(), side);
    EXPECT_EQ(added.field().interpolation(), Interpolation::linear);
    EXPECT_EQ(added.field().background(), window_->content().live(1)->field().background());
    EXPECT_EQ(added.setup().buttons, (run::Buttons{{}, {}}));
    wait_for_ticks(5);
    EXPECT_EQ(driver_.sessions, 1) << "no force of the side that was solid before";
}

TEST_F(SlowDevices, are_not_waited_for_by_what_is_opened_instead) {
    feel_with("simulated:hand=hold");
    record("a.csv");
    wait_for_ticks(50);
    stop_recording();
    for (const auto open : {&Connector::use_device, &Connector::add_hand}) {
        begin_to(open, "haply");
        window_->files().open_recording(scratch("a.csv"));
        wait_until([&] { return window_->playback() != nullptr; });
        EXPECT_FALSE(connector().task().busy());
        driver_.opens.open();
        handle_events();
        EXPECT_NE(window_->playback(), nullptr);
        feel(felt_slowly);
    }
}

TEST_F(SlowDevices, that_nobody_wants_any_more_are_closed_beside_the_window) {
    feel_with("mouse");
    add_hand("simulated:hand=hold");
    driver_.closes.close();
    begin_to(&Connector::use_device, "haply");
    window_->content().remove_hand();
    driver_.opens.open();
    wait_until([&] { return driver_.closes.waiting() == 1; });
    wait_until_connected();
    expect_it_answers();
    EXPECT_EQ(driver_.open, 1);
    EXPECT_EQ(used(), "mouse");
    driver_.closes.open();
    wait_until([&] { return driver_.open == 0; });
}

TEST_F(SlowDevices, that_are_given_up_after_they_were_closed_are_named) {
    feel_with("haply");
    begin_to(&Connector::use_device, "haply:port=2");
    connector().task().cancel();
    viewer::wait_until([&] { return !window_->messages().problem().isEmpty(); });
    EXPECT_TRUE(window_->messages().problem().contains("choose it once more"));
    driver_.opens.open();
    use_device("haply");
    wait_until([&] { return now().session.device.status == DeviceStatus::ready; });
}

TEST_F(SlowDevices, keep_signals_handled_until_their_forces_have_ended) {
    feel_with("haply");
    driver_.stops.close();
    window_->end();
    viewer::wait_until([&] { return driver_.stops.waiting() > 0; });
    EXPECT_FALSE(window_->content().closer().forces_end_within({}));
    driver_.stops.open();
    bool has_told = false;
    EXPECT_EQ(window_->finish([&] {
        EXPECT_TRUE(window_->content().closer().forces_end_within({}));
        has_told = true;
    }),
              0);
    EXPECT_TRUE(has_told);
}

TEST_F(SlowDevices, that_hang_when_they_are_closed_are_told_by_the_exit_status) {
    feel_with("haply");
    driver_.closes.close();
    window_->close();
    EXPECT_EQ(window_->finish(), app::no_device);
    EXPECT_FALSE(window_->has_closed_devices());
}

TEST_F(SlowDevices, do_not_begin_again_in_a_window_that_was_closed) {
    feel_with("mouse");
    begin_to(&Connector::use_device, "haply");
    window_->close();
    EXPECT_FALSE(connector().task().busy());
    EXPECT_EQ(window_->finish(), 0);
    EXPECT_EQ(window_->live(), nullptr);
}

/// Reads a pipe slowly: only its first line, until it may read on.
class SlowReader {
  public:
    explicit SlowReader(const std::string& path)
        : thread_([this, path] {
              std::ifstream in(path);
              std::getline(in, text);
              gate.pass();
              text += '\n' + std::string(std::istreambuf_iterator<char>(in), {});
          }) {
        gate.close();
    }
    void join() { thread_.join(); }

    Gate gate;
    std::string text;  // once it was joined

  private:
    std::jthread thread_;
};

/// Records to a pipe more than it holds.
class SlowReaders : public SlowDevices {
  protected:
    void SetUp() override {
        SlowDevices::SetUp();
        feel_with("simulated:hand=hold");
        const std::string pipe = scratch("pipe").toStdString();
        ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
        reader_.emplace(pipe);
        record("pipe");
        ASSERT_TRUE(window_->recordings().recording());
        wait_for_ticks(600);
    }
    /// Lets it read on. True if the recording is complete.
    bool has_end() {
        reader_->gate.open();
        reader_->join();
        return reader_->text.find("\n# end ") != std::string::npos;
    }

    std::optional<SlowReader> reader_;
};

TEST_F(SlowReaders, do_not_keep_the_window_open) {
    window_->close();
    EXPECT_FALSE(window_->isVisible());
    EXPECT_EQ(window_->live(), nullptr) << "its force has ended";
    EXPECT_EQ(reader_->gate.waiting(), 1) << "the window has waited for it";
    reader_->gate.open();
    EXPECT_EQ(window_->finish(), 0);
    EXPECT_TRUE(has_end());
}

TEST_F(SlowReaders, do_not_keep_a_recording_from_being_stopped) {
    press(Qt::Key_R, Qt::ControlModifier);
    EXPECT_FALSE(window_->recordings().recording());
    const std::int64_t stopped = now().number;
    wait_for_ticks(700);  // longer than the end of a program would wait for it
    EXPECT_GE(now().number, stopped + 700) << "the session goes on";
    EXPECT_NE(late_strip(), nullptr);
    reader_->gate.open();
    wait_until([&] { return window_->recordings().settled(); });
    EXPECT_TRUE(has_end());
    EXPECT_LT(std::ranges::count(reader_->text, '\n'), stopped + 300)
        << "and ended when it was asked";
    window_->close();
    EXPECT_EQ(window_->finish(), 0);
}

TEST_F(SlowReaders, of_a_stopped_recording_can_be_given_up) {
    press(Qt::Key_R, Qt::ControlModifier);
    late_strip();
    cancel_task();
    wait_until([&] { return window_->recordings().settled(); });
    EXPECT_FALSE(has_end());
    window_->close();
    EXPECT_EQ(window_->finish(), 5) << "the recording is not whole";
}

TEST_F(SlowReaders, that_are_given_up_do_not_keep_the_next_recording_from_its_ticks) {
    struct GivenUp {};
    const std::string next = scratch("next.csv").toStdString();
    run::Run& live = *window_->content().live();
    EXPECT_THROW(live.record(next,
                             [&](double) {
                                 if (std::filesystem::exists(next)) throw GivenUp{};
                             }),
                 GivenUp);
    wait_for_ticks(5);
    EXPECT_GT(live.stop_recording(), 0);
    has_end();
}

}  // namespace
}  // namespace palpate::viewer::test
