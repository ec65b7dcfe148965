// Shared by the programs that time the scene: waiting with the event loop, and quantiles.
#pragma once

#include <QElapsedTimer>
#include <QEventLoop>
#include <QTimer>
#include <algorithm>
#include <functional>
#include <vector>

namespace palpate::viewer::test {

inline double seconds(const QElapsedTimer& timer) {
    return 1e-9 * double(timer.nsecsElapsed());
}

/// Runs the event loop, which sleeps between events, until `done`, looked at every so many
/// milliseconds, or `limit` [s]. Whether it is done.
inline bool run_until(const std::function<bool()>& done, double limit, int every_ms = 1) {
    QEventLoop loop;
    QElapsedTimer since;
    since.start();
    QTimer look;
    QObject::connect(&look, &QTimer::timeout, [&] {
        if (done() || seconds(since) > limit) loop.quit();
    });
    look.start(every_ms);
    loop.exec();
    return done();
}

inline double quantile(std::vector<double> values, double part) {
    if (values.empty()) return 0;
    std::ranges::sort(values);
    return values[std::min(values.size() - 1, std::size_t(part * double(values.size())))];
}

}  // namespace palpate::viewer::test
