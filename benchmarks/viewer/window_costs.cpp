// viewer_costs: what the window costs: how soon a volume is seen, processor time at rest and
// turning, memory of volumes that were closed. How to run and read it: docs/viewer_internals.md.
//
//   viewer_costs VOLUME [OTHER...]    the others are opened in turn, ten times in all, before
//   VOLUME
#include <QVTKOpenGLNativeWidget.h>
#include <QApplication>
#include <QElapsedTimer>
#include <QEventLoop>
#include <QFileInfo>
#include <QImage>
#include <QSettings>
#include <QSurfaceFormat>
#include <QTemporaryDir>
#include <QTimer>

#include <Eigen/Geometry>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/viewer/scene/scene.hpp"
#include "apps/viewer/window/main_window.hpp"
#include "apps/viewer/window/views.hpp"

namespace {

using namespace palpate;
using viewer::MainWindow;

double seconds(const QElapsedTimer& timer) {
    return 1e-9 * static_cast<double>(timer.nsecsElapsed());
}

double processor_seconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Memory of this process [MB].
double resident() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);) {
        if (line.rfind("VmRSS:", 0) == 0) return std::stod(line.substr(6)) / 1024;
    }
    return 0;
}

void run_for(double time, const std::function<void()>& meanwhile = {}) {
    QEventLoop loop;
    QTimer::singleShot(static_cast<int>(1e3 * time), &loop, &QEventLoop::quit);
    QTimer often;
    QObject::connect(&often, &QTimer::timeout, [&] { meanwhile(); });
    if (meanwhile) often.start(33);
    loop.exec();
}

/// Pixels of the surface's colour in the middle of the scene.
int surface_pixels(MainWindow& window) {
    const QImage image = window.views().scene().picture();
    int count = 0;
    for (int y = 0; y < image.height(); y += 4) {
        for (int x = 0; x < image.width(); x += 4) {
            const QRgb p = image.pixel(x, y);
            count += qRed(p) > qGreen(p) && qGreen(p) > qBlue(p) && qRed(p) > qBlue(p) + 10;
        }
    }
    return count;
}

std::unique_ptr<MainWindow> open_window() {
    run::Setup setup;
    setup.device = devices::parse_device("mouse");
    setup.real_time = false;
    auto window = std::make_unique<MainWindow>(viewer::RunRequest{setup, {}, {}});
    window->resize(1400, 880);
    window->show();
    run_for(2);
    return window;
}

/// Until all is drawn, at most ten minutes.
void open(MainWindow& window, const QString& path) {
    bool started = false;
    const auto watch =
        QObject::connect(&window.content(), &viewer::Content::run_started, [&] { started = true; });
    window.files().open_path(path);
    QElapsedTimer timer;
    timer.start();
    while (seconds(timer) < 600 && !(started && window.settled())) run_for(0.05);
    QObject::disconnect(watch);
}

/// Its first surface is recognisable: a picture with half of the surface's pixels in the end.
void measure_opening(MainWindow& window, const QString& path) {
    struct Seen {
        double at;
        int pixels;
    };
    std::vector<Seen> seen;
    window.files().open_path(path);
    QElapsedTimer timer;
    timer.start();
    double cpu = -processor_seconds();
    while (seconds(timer) < 600 && !(window.live() && window.settled())) {
        run_for(0.1);
        if (window.live()) seen.push_back({seconds(timer), surface_pixels(window)});
    }
    cpu += processor_seconds();
    const double whole = seconds(timer);
    const int all = surface_pixels(window);
    double first = whole;
    for (auto one = seen.rbegin(); one != seen.rend(); ++one) {
        if (2 * one->pixels >= all) first = one->at;
    }
    std::printf(
        "opening: first surface %.1f s, complete %.1f s, processor %.1f s, memory %.0f MB\n", first,
        whole, cpu, resident());
}

void measure_share(const char* what, double time, const std::function<void()>& meanwhile = {}) {
    const double before = processor_seconds();
    QElapsedTimer timer;
    timer.start();
    run_for(time, meanwhile);
    std::printf("%s: %.1f %% of a core\n", what,
                100 * (processor_seconds() - before) / seconds(timer));
    std::fflush(stdout);
}

void turn(MainWindow& window) {
    auto camera = window.views().scene().camera();
    const Eigen::AngleAxisd by(0.02, camera.up.normalized());
    camera.towards_viewer = by * camera.towards_viewer;
    window.views().scene().set_camera(camera);
}

int measure(const QStringList& volumes) {
    auto window = open_window();
    measure_share("empty", 10);
    measure_opening(*window, volumes.front());
    run_for(3);
    measure_share("at rest", 10);
    measure_share("turning", 10, [&] { turn(*window); });
    run_for(3);
    const double fresh = resident();
    for (int i = 0; i < 10 && volumes.size() > 1; ++i) {
        open(*window, volumes[1 + i % (volumes.size() - 1)]);
    }
    open(*window, volumes.front());
    run_for(3);
    std::printf("memory: %.0f MB fresh, %.0f MB after ten other volumes (%.2f times)\n", fresh,
                resident(), resident() / fresh);
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    QSurfaceFormat::setDefaultFormat(QVTKOpenGLNativeWidget::defaultFormat());
    QApplication application(argc, argv);
    QApplication::setOrganizationName("palpate-benchmarks");
    const QTemporaryDir settings;
    QSettings::setPath(QSettings::NativeFormat, QSettings::UserScope, settings.path());
    QStringList volumes = QApplication::arguments();
    volumes.removeFirst();
    if (volumes.isEmpty()) {
        std::fprintf(stderr, "usage: viewer_costs VOLUME [OTHER...]\n");
        return 2;
    }
    for (const QString& path : volumes) {  // else the run would wait ten minutes for it
        if (QFileInfo::exists(path)) continue;
        std::fprintf(stderr, "viewer_costs: %s does not exist\n", qUtf8Printable(path));
        return 2;
    }
    return measure(volumes);
}
