// palpate_viewer_benchmark: the cost of the window. It runs the servo loop in turns with and
// without a window that draws. It also measures how long a start and an open take, for how long the
// window did not answer, and the frames per second while the view turns. How to run and read it:
// docs/viewer_internals.md.
#include <QVTKOpenGLNativeWidget.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <QApplication>
#include <QElapsedTimer>
#include <QSettings>
#include <QSurfaceFormat>
#include <QTimer>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>
#include <vector>

#include "apps/viewer/scene/scene.hpp"
#include "apps/viewer/window/look_controls.hpp"
#include "apps/viewer/window/main_window.hpp"
#include "apps/viewer/window/panel.hpp"
#include "apps/viewer/window/views.hpp"
#include "pictures/view.hpp"

namespace palpate::viewer {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
}

struct Options {
    std::string volume = "synthetic:shepp-logan:256x256x256";
    double seconds = 10;
    int rounds = 3;
    bool volume_rendering = false;
    bool normal_priority = false;
};

run::Setup setup_of(const Options& options) {
    run::Setup setup;
    setup.device = devices::parse_device("simulated:loop=yes");
    setup.real_time = !options.normal_priority;
    return setup;
}

/// Longest time between two rounds of the event loop: for how long the window did not answer.
class Stall {
  public:
    Stall() {
        QObject::connect(&timer_, &QTimer::timeout, [this] {
            if (last_.isValid()) longest_ = std::max(longest_, 1e-9 * double(last_.nsecsElapsed()));
            last_.start();
        });
        timer_.start(1);
    }
    double longest() const { return longest_; }

  private:
    QTimer timer_;
    QElapsedTimer last_;
    double longest_ = 0;
};

void run_until(const std::function<bool()>& done) {
    while (!done()) QCoreApplication::processEvents(QEventLoop::AllEvents, 5);
}

void print(const char* what, const ServoReport& report) {
    const auto line = [](const char* name, const LatencySummary& s) {
        return fmt::format("{} p50 {:.1f} p99 {:.1f} p99.9 {:.1f} max {:.1f}", name, 1e-3 * s.p50,
                           1e-3 * s.p99, 1e-3 * s.p999, 1e-3 * s.max);
    };
    fmt::print("{:<8} [us] {}; {}; {}; missed {} of {}\n", what, line("period", report.period),
               line("compute", report.compute), line("lateness", report.lateness), report.missed,
               report.ticks);
    std::fflush(stdout);
}

ServoReport alone(const Options& options) {
    run::Run live(std::make_shared<run::Data>(run::load(run::source_named(options.volume))),
                  setup_of(options));
    live.start();
    std::this_thread::sleep_for(std::chrono::duration<double>(options.seconds));
    return live.report();
}

/// Turns the view without a pause and counts pictures.
ServoReport drawing(const Options& options, double& frame) {
    MainWindow window({setup_of(options), {}, {}});
    window.resize(1280, 800);
    window.show();
    window.files().open_volume(run::source_named(options.volume));
    run_until([&] { return window.live() && window.settled(); });
    Look look = window.panel().look_controls().look();
    look.volume = options.volume_rendering;
    look.surface = !options.volume_rendering;
    set(window.views(), &Shown::look, look);
    run_until([&] { return window.settled(); });
    // Compares the same stretch of the session, from its beginning.
    window.files().open_volume(run::source_named(options.volume));
    run_until([&] { return window.live() && window.settled(); });
    set(window.views(), &Shown::look, look);
    double azimuth = 0;
    QTimer turn;
    QObject::connect(&turn, &QTimer::timeout, [&] {
        window.views().scene().look_from(
            pictures::view_from(azimuth = std::fmod(azimuth + 2, 360), 15));
    });
    turn.start(16);
    const auto begin = Clock::now();
    run_until([&] { return seconds_since(begin) > options.seconds; });
    frame = window.views().scene().frame_seconds();
    return window.live()->report();
}

void start_and_open(const Options& options) {
    const auto begin = Clock::now();
    MainWindow window({setup_of(options), {}, {}});
    window.resize(1280, 800);
    window.show();
    QCoreApplication::processEvents();
    fmt::print("window shown after {:.2f} s\n", seconds_since(begin));
    const Stall stall;
    window.files().open_volume(run::source_named(options.volume));
    run_until([&] { return window.live() != nullptr || !window.messages().problem().isEmpty(); });
    fmt::print("felt after {:.2f} s\n", seconds_since(begin));
    run_until([&] { return window.settled(); });
    fmt::print("all drawn after {:.2f} s; the window never waited for more than {:.0f} ms\n",
               seconds_since(begin), 1e3 * stall.longest());
    std::fflush(stdout);
}

int run(const Options& options) {
    start_and_open(options);
    std::vector<double> ratios, compute;
    for (int round = 0; round < options.rounds; ++round) {
        const ServoReport without = alone(options);
        double frame = 0;
        const ServoReport with = drawing(options, frame);
        print("alone", without);
        print("drawing", with);
        fmt::print("         a picture takes {:.1f} ms\n", 1e3 * frame);
        ratios.push_back(double(with.period.p999) / double(without.period.p999));
        compute.push_back(double(with.compute.p999) / double(without.compute.p999));
    }
    std::sort(ratios.begin(), ratios.end());
    std::sort(compute.begin(), compute.end());
    fmt::print(
        "p99.9 with the window drawing to p99.9 without, medians of {} rounds: period {:.2f}, "
        "compute {:.2f}\n",
        options.rounds, ratios[ratios.size() / 2], compute[compute.size() / 2]);
    return 0;
}

}  // namespace
}  // namespace palpate::viewer

int main(int argc, char** argv) {
    palpate::viewer::Options options;
    CLI::App app("What the viewer's window costs.");
    app.add_option("VOLUME", options.volume)->capture_default_str();
    app.add_option("--seconds", options.seconds)->capture_default_str();
    app.add_option("--rounds", options.rounds)->check(CLI::PositiveNumber)->capture_default_str();
    app.add_flag("--volume-rendering", options.volume_rendering);
    app.add_flag("--normal-priority", options.normal_priority);
    CLI11_PARSE(app, argc, argv);
    QSurfaceFormat::setDefaultFormat(QVTKOpenGLNativeWidget::defaultFormat());
    int qt_arguments = 1;
    QApplication application(qt_arguments, argv);
    QCoreApplication::setOrganizationName("palpate-benchmark");
    return palpate::viewer::run(options);
}
