// viewer_redraws: how soon the 3-D view shows what has changed. A carved ball of 20 voxels, from
// the new version to the picture; a stroke of 33 versions a second; sequences that play. How to run
// and read it: docs/viewer_internals.md.
#include <QApplication>
#include <QElapsedTimer>
#include <QEventLoop>
#include <QSurfaceFormat>
#include <QTimer>

#include <Eigen/Geometry>
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
#include "palpate/edit.hpp"
#include "palpate/scenes/volumes.hpp"

namespace {

using namespace palpate;
using viewer::Scene;
using viewer::test::quantile;
using viewer::test::run_until;
using viewer::test::seconds;

constexpr double level = 128;

void print(const std::string& what, const std::vector<double>& times) {
    std::printf("%-44s %4zu  p50 %6.1f ms  p99 %6.1f ms\n", what.c_str(), times.size(),
                1e3 * quantile(times, 0.5), 1e3 * quantile(times, 0.99));
    std::fflush(stdout);
}

/// When pictures came, and for how long the window did not answer.
struct Watch {
    QElapsedTimer since;
    QTimer pulse;
    std::vector<double> pictures, pulses;

    explicit Watch(Scene& scene) {
        since.start();
        QObject::connect(&scene, &Scene::frameSwapped, &pulse,
                         [this] { pictures.push_back(seconds(since)); });
        QObject::connect(&pulse, &QTimer::timeout, [this] { pulses.push_back(seconds(since)); });
        pulse.start(2);
    }
    static std::vector<double> gaps(const std::vector<double>& at) {
        std::vector<double> gaps;
        for (std::size_t i = 1; i < at.size(); ++i) gaps.push_back(at[i] - at[i - 1]);
        return gaps;
    }
};

Volume ball(int edge) {
    return scenes::ball(Index3::Constant(edge));
}

/// On the side of the ball that is seen, 20 voxels across.
Edited dab(const Field& field, const Vec3& towards_viewer, double angle) {
    const Geometry& g = field.geometry();
    const Vec3 side = towards_viewer.unitOrthogonal();
    const Vec3 up = towards_viewer.cross(side);
    const Vec3 out = towards_viewer + 0.5 * (std::cos(angle) * side + std::sin(angle) * up);
    edit::Stroke stroke;
    stroke.brush = brush_for(BrushKind::carve, field, level, 10 * g.spacing[0]);
    stroke.from = stroke.to =
        physical_centre(g) + 0.35 * g.size[0] * g.spacing[0] * out.normalized();
    return edited(field.shared_samples(), stroke);
}

void open(Scene& scene, const Field& field) {
    scene.resize(1280, 800);
    scene.show();
    QObject::connect(&scene, &Scene::problem, [](const QString& what) {
        std::fprintf(stderr, "problem: %s\n", qPrintable(what));
    });
    scene.set_field(field, level);
    run_until([&] { return scene.settled(); }, 120);
}

void edits(int edge) {
    const std::string name = std::to_string(edge) + "^3";
    Field field = linear_field(ball(edge));
    Scene scene;
    open(scene, field);
    std::vector<double> shown, fine;
    const Vec3 towards = scene.camera().towards_viewer;
    for (int i = 0; i < 40; ++i) {
        const Edited after = dab(field, towards, 0.7 * i);
        field.use(after.samples);
        // Nothing else changes: the next picture is the one with the edit.
        Watch watch(scene);
        scene.update_field(field);
        run_until([&] { return !watch.pictures.empty(); }, 10);
        if (!watch.pictures.empty()) shown.push_back(watch.pictures.front());
        run_until([&] { return scene.settled(); }, 60);
        fine.push_back(seconds(watch.since));
    }
    print(name + ": an edit is seen after", shown);
    print(name + ": finely", fine);

    Watch watch(scene);
    int versions = 0;
    QTimer hand;
    QObject::connect(&hand, &QTimer::timeout, [&] {
        const Edited after = dab(field, towards, 0.02 * ++versions);
        field.use(after.samples);
        scene.update_field(field);
    });
    hand.start(30);
    run_until([] { return false; }, 6);
    hand.stop();
    print(name + ": a stroke, between pictures", Watch::gaps(watch.pictures));
    print("    the window, between two looks", Watch::gaps(watch.pulses));
    run_until([&] { return scene.settled(); }, 60);
    if (const char* folder = std::getenv("PALPATE_FRAMES_PICTURES")) {
        scene.picture().save(QString(folder) + "/edited_" + QString::number(edge) + ".png");
    }
}

/// Eight frames of a ball that beats.
Field beating(int edge) {
    std::vector<Frame> frames;
    for (int f = 0; f < 8; ++f) {
        const double radius = 0.3 + 0.08 * std::sin(0.785398 * f);
        frames.push_back({0.1 * f, scenes::ball(Index3::Constant(edge), radius, 1.4), f});
    }
    return linear_field(std::make_shared<const Samples>(std::move(frames), 0.8));
}

void plays(int edge) {
    const std::string name = std::to_string(edge) + "^3";
    Field field = beating(edge);
    Scene scene;
    open(scene, field);
    {
        Watch watch(scene);
        QTimer clock;
        QObject::connect(&clock, &QTimer::timeout, [&] {
            field.set_time(seconds(watch.since));
            scene.update_field(field);
        });
        clock.start(16);
        run_until([] { return false; }, 6);
        clock.stop();
        print(name + ": playing, between pictures", Watch::gaps(watch.pictures));
        print("    the window, between two looks", Watch::gaps(watch.pulses));
    }
    QElapsedTimer since;
    since.start();
    run_until([&] { return scene.settled(); }, 60);
    std::printf("%s: finely %.0f ms after it stands still\n", name.c_str(), 1e3 * seconds(since));
    if (const char* folder = std::getenv("PALPATE_FRAMES_PICTURES")) {
        scene.picture().save(QString(folder) + "/played_" + QString::number(edge) + ".png");
    }
}

}  // namespace

int main(int argc, char** argv) {
    QSurfaceFormat::setDefaultFormat(QVTKOpenGLNativeWidget::defaultFormat());
    QApplication application(argc, argv);
    try {
        std::vector<int> edges;
        for (int i = 1; i < argc; ++i) edges.push_back(std::stoi(argv[i]));
        if (edges.empty()) edges = {64, 256, 512};
        for (const int edge : edges) edits(edge);
        for (const int edge : {64, 128}) plays(edge);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "viewer_redraws: %s\n", error.what());
        return 1;
    }
    return 0;
}
