// Measures the 3-D view on this machine: how long a picture takes while the camera turns, how soon
// the fine one is there, how long the window was busy at a stretch. For docs/performance.md:
//   scripts/with_display.sh build/dev/benchmarks/viewer_frames synthetic:sphere:256x256x256
#include <sys/resource.h>
#include <QApplication>
#include <QElapsedTimer>
#include <QEventLoop>
#include <QSurfaceFormat>
#include <QTimer>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <string>
#include <vector>

#include "apps/viewer/scene/scene.hpp"
#include "benchmarks/viewer/timing.hpp"
#include "palpate/run/source.hpp"

namespace {

using namespace palpate;
using viewer::Scene;
using viewer::test::quantile;
using viewer::test::run_until;
using viewer::test::seconds;

/// Time of all threads of this program [s]. On a busy machine it tells more than the clock.
double processor_seconds() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto of = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
    return of(usage.ru_utime) + of(usage.ru_stime);
}

void print(const char* what, const std::vector<double>& frames, double processor) {
    std::printf(
        "%-28s %4zu pictures  p50 %6.1f ms  p99 %6.1f ms  longest %6.1f ms  processor %.1f ms "
        "each\n",
        what, frames.size(), 1e3 * quantile(frames, 0.5), 1e3 * quantile(frames, 0.99),
        1e3 * quantile(frames, 1),
        1e3 * processor / double(std::max<std::size_t>(1, frames.size())));
    std::fflush(stdout);
}

/// The longest times that the event loop did not come round.
class Pulse {
  public:
    Pulse() {
        since_.start();
        QObject::connect(&timer_, &QTimer::timeout, [this] { gaps_.push_back(lap()); });
        timer_.start(4);
    }
    void report(const char* what) {
        std::printf("%-28s window busy at a stretch: p99 %.1f ms, longest %.1f ms\n", what,
                    1e3 * quantile(gaps_, 0.99), 1e3 * quantile(gaps_, 1));
        gaps_.clear();
    }

  private:
    double lap() {
        const double elapsed = seconds(since_);
        since_.restart();
        return elapsed;
    }
    QElapsedTimer since_;
    QTimer timer_;
    std::vector<double> gaps_;
};

struct Meter {
    Scene& scene;
    Pulse pulse{};

    /// The pictures while a hand moves something every 8 ms for so long [s].
    void draw(const char* what, double time, const std::function<void()>& move) {
        std::vector<double> frames;
        QElapsedTimer since;
        since.start();
        const auto swapped = QObject::connect(&scene, &Scene::frameSwapped, [&] {
            frames.push_back(seconds(since));
            since.restart();
        });
        QTimer hand;
        QObject::connect(&hand, &QTimer::timeout, move);
        const double processor = processor_seconds();
        hand.start(8);
        run_until([] { return false; }, time);
        hand.stop();
        QObject::disconnect(swapped);
        if (!frames.empty()) frames.erase(frames.begin());
        print(what, frames, processor_seconds() - processor);
        pulse.report(what);
    }
    void turn(const char* what) {
        draw(what, 5, [&] { scene.set_camera(viewer::turned(scene.camera(), {1280, 800}, 3, 1)); });
        rest(what);
    }
    /// The probe goes round, as snapshots of a session would show it.
    void probe(const Field& field) {
        Snapshot snapshot;
        snapshot.session.device.status = DeviceStatus::ready;
        const Vec3 middle = physical_centre(field.geometry());
        const double radius =
            0.2 *
            field.geometry().size.cast<double>().cwiseProduct(field.geometry().spacing).norm();
        draw("probe", 4, [&] {
            const double angle = 0.02 * double(++snapshot.number);
            Tick& tick = snapshot.session.tick;
            tick.proxy.scp = middle + radius * Vec3(std::cos(angle), std::sin(angle), 0.5);
            tick.proxy.hip = middle + 0.8 * (tick.proxy.scp - middle);
            tick.force = (tick.proxy.scp - tick.proxy.hip).normalized();
            scene.show_snapshot(snapshot);
        });
        scene.show_snapshot({});
    }
    void rest(const char* what) {
        QElapsedTimer timer;
        timer.start();
        run_until([&] { return scene.settled(); }, 120);
        std::printf("%-28s at full quality %.0f ms after the last move\n", what,
                    1e3 * seconds(timer));
        pulse.report("  meanwhile");
    }
};

void measure(const std::string& name, std::optional<double> level) {
    const run::LoadedVolume loaded = run::load(run::source_named(name));
    const Field field = linear_field(loaded.volume);
    const double isovalue = level ? *level : loaded.isovalue.value_or(loaded.volume.minimum());
    Scene scene;
    scene.resize(1280, 800);
    scene.show();
    QObject::connect(&scene, &Scene::surface_ready, [](double, double taken) {
        std::printf("surface at full detail after %.2f s\n", taken);
    });
    QObject::connect(&scene, &Scene::problem, [](const QString& what) {
        std::fprintf(stderr, "problem: %s\n", qPrintable(what));
    });
    Meter meter{scene};
    scene.set_field(field, isovalue);
    meter.rest("opening");
    if (const char* folder = std::getenv("PALPATE_FRAMES_PICTURES")) {
        scene.picture().save(QString(folder) + "/surface.png");
    }
    meter.probe(field);
    meter.turn("surface");
    viewer::Look look;
    look.surface = false;
    look.volume = true;
    const double low = loaded.volume.minimum(), range = loaded.volume.range();
    look.transfer.points = {{isovalue - 0.05 * range, {0.5, 0.3, 0.2}, 0},
                            {isovalue + 0.05 * range, {0.9, 0.75, 0.6}, 0.3},
                            {low + 1.01 * range, {1, 1, 0.95}, 0.8}};
    set(scene, &viewer::Shown::look, look);
    meter.rest("volume, first");
    meter.turn("volume");
    if (const char* folder = std::getenv("PALPATE_FRAMES_PICTURES")) {
        scene.picture().save(QString(folder) + "/volume.png");
    }
    std::printf("%s\n", scene.on_hardware() ? "graphics hardware" : "software OpenGL");
}

}  // namespace

int main(int argc, char** argv) {
    QSurfaceFormat::setDefaultFormat(QVTKOpenGLNativeWidget::defaultFormat());
    QApplication application(argc, argv);
    try {
        const std::string name = argc > 1 ? argv[1] : "synthetic:sphere:256x256x256";
        measure(name, argc > 2 ? std::optional(std::stod(argv[2])) : std::nullopt);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "viewer_frames: %s\n", error.what());
        return 1;
    }
    return 0;
}
