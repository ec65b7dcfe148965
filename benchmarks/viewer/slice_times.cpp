// Times how long slices of a volume take to be drawn (a named one, or large noise): run by hand,
// not by ctest. The contour is that of 500.
#include <QApplication>
#include <QImage>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>
#include <vector>

#include "apps/viewer/slices/slice_pane.hpp"
#include "apps/viewer/slices/slice_picture.hpp"
#include "palpate/run/source.hpp"

namespace {

using namespace palpate;

double cpu_milliseconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// [ms of CPU] the median of 21 times.
double milliseconds(const std::function<void(int)>& work) {
    std::vector<double> times;
    for (int i = 0; i < 21; ++i) {
        const double before = cpu_milliseconds();
        work(i);
        times.push_back(cpu_milliseconds() - before);
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
    const Geometry& geometry = field.geometry();
    const viewer::SlicePlane plane = viewer::slice_plane(geometry, axis);
    const QSize size(edge, edge);
    const viewer::SliceMap map = viewer::slice_map(plane, {}, size, 16);
    viewer::SliceStyle style;
    style.window = {field.volume().minimum(), field.volume().maximum()};
    style.isovalue = 500;
    viewer::SliceSamples samples(field, plane);
    const auto draw = [&](double position) {
        samples.go_to(position);
        (void)viewer::slice_picture(samples, map, style, size, 1);
    };
    const double layer =
        milliseconds([&](int i) { draw((0.3 + 0.0117 * i) * geometry.size[axis]); });
    const double between =
        milliseconds([&](int i) { draw(geometry.size[axis] / 2 + 0.03 * (i + 1)); });
    viewer::SlicePane pane(axis);
    pane.resize(size);
    pane.set_field(field, 500);
    QImage image(size, QImage::Format_RGB32);
    pane.render(&image);
    Snapshot snapshot;
    const double probe = milliseconds([&](int i) {
        snapshot.session.tick.proxy.hip = physical_centre(geometry) + Vec3(i, i, i);
        pane.show_snapshot(snapshot);
        pane.render(&image);
    });
    std::printf(
        "axis %d, %4d pixels: another layer %5.1f ms, between the same two %5.1f ms, "
        "probe only %5.2f ms\n",
        axis, edge, layer, between, probe);
}

}  // namespace

int main(int argc, char** argv) {
    const QApplication application(argc, argv);
    const Field field = linear_field(argc > 1 ? run::load(run::source_named(argv[1])).volume
                                              : blobs({512, 512, 640}));
    for (const int edge : {300, 512, 1000}) {
        for (int axis = 0; axis < 3; ++axis) measure(field, axis, edge);
    }
}
