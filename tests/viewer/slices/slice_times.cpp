// How long a slice pane takes to be drawn, on a large volume: run by hand, never by ctest.
#include <QApplication>
#include <QElapsedTimer>
#include <QImage>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <vector>

#include "apps/viewer/slices/slice_pane.hpp"

namespace {

using namespace palpate;

/// [ms] the median of 21 times.
double milliseconds(const std::function<void(int)>& work) {
    std::vector<double> times;
    for (int i = 0; i < 21; ++i) {
        QElapsedTimer timer;
        timer.start();
        work(i);
        times.push_back(1e-6 * static_cast<double>(timer.nsecsElapsed()));
    }
    std::ranges::nth_element(times, times.begin() + 10);
    return times[10];
}

/// Blobs of some 30 samples with a little noise.
Volume blobs(const Index3& size) {
    const Geometry geometry{.size = size};
    std::vector<std::int16_t> samples(static_cast<std::size_t>(sample_count(geometry)));
    std::size_t at = 0;
    std::uint32_t noise = 1;
    for (int z = 0; z < size[2]; ++z) {
        for (int y = 0; y < size[1]; ++y) {
            const double yz = std::sin(0.1 * y) + std::sin(0.11 * z);
            for (int x = 0; x < size[0]; ++x) {
                noise = noise * 1664525 + 1013904223;
                samples[at++] = static_cast<std::int16_t>(400 * (yz + std::sin(0.09 * x)) +
                                                          static_cast<double>(noise >> 25));
            }
        }
    }
    return {geometry, std::move(samples)};
}

void measure(const Field& field, int axis, int edge) {
    viewer::SlicePane pane(axis);
    pane.resize(edge, edge);
    pane.set_field(field, 500);
    QImage image(edge, edge, QImage::Format_RGB32);
    const auto draw = [&] { pane.render(&image); };
    Vec3 at = physical_centre(field.geometry());
    draw();
    const double layer = milliseconds([&](int) {
        at[axis] += 3.3;
        pane.set_crosshair(at);
        draw();
    });
    const double between = milliseconds([&](int i) {
        at[axis] = std::floor(at[axis]) + 0.01 + 0.03 * i;
        pane.set_crosshair(at);
        draw();
    });
    Snapshot snapshot;
    const double probe = milliseconds([&](int i) {
        snapshot.session.tick.proxy.hip = at + Vec3(i, i, i);
        pane.show_snapshot(snapshot);
        draw();
    });
    std::printf(
        "axis %d, %4d pixels: another layer %5.1f ms, between the same two %5.1f ms, "
        "probe only %5.2f ms\n",
        axis, edge, layer, between, probe);
}

}  // namespace

int main(int argc, char** argv) {
    const QApplication application(argc, argv);
    const Field field(blobs({512, 512, 640}));
    for (const int edge : {300, 512, 1000}) {
        for (int axis = 0; axis < 3; ++axis) measure(field, axis, edge);
    }
}
