// A scene in a window, its pictures, and snapshots to show in it.
#pragma once

#include <gtest/gtest.h>

#include <QCoreApplication>
#include <QImage>
#include <QTest>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <string>

#include "apps/viewer/scene/scene.hpp"
#include "viewer/kept_picture.hpp"
#include "viewer/references.hpp"
#include "viewer/undrawn.hpp"
#include "viewer/waiting.hpp"

namespace palpate::viewer {

/// Draws in suites whose names begin with Drawn.
struct ShownScene {
    Scene scene{nullptr, painter_of_test()};
    int frames = 0;

    explicit ShownScene(int width = 400, int height = 320) {
        scene.resize(width, height);
        scene.show();
        wait_until_exposed(scene);
        QObject::connect(&scene, &Scene::frameSwapped, [this] { ++frames; });
    }
    /// Until another picture has come, or all have.
    void next_frame() {
        const int before = frames;
        wait_until([&] { return frames > before || scene.settled(); });
    }
    /// What is shown once nothing is under way, null where nothing is drawn; left in the folder of
    /// pictures as well.
    QImage settled(const std::string& name = {}) {
        wait_until([this] { return scene.settled(); });
        if (!draws()) return {};
        const QImage image = scene.picture().convertToFormat(QImage::Format_RGB32);
        if (!name.empty()) {
            std::filesystem::create_directories(PALPATE_PICTURES);
            EXPECT_TRUE(
                keep(image, QString::fromStdString(PALPATE_PICTURES + ("/" + name + ".png"))));
        }
        return image;
    }
    /// Where a physical point is in the picture.
    Pixel at(const Vec3& physical) {
        return pixel_of(scene.camera(), {double(scene.width()), double(scene.height())}, physical);
    }
};

/// Nothing but what a test is about.
inline Look bare() {
    Look look;
    look.box = look.orientation = look.scale_bar = false;
    return look;
}

/// A hand at `hip`, the proxy at `scp`, a force in device axes that are the physical ones.
inline Snapshot snapshot_at(const Vec3& hip, const Vec3& scp, const Vec3& force = Vec3::Zero()) {
    static std::int64_t number = 0;
    Snapshot snapshot;
    snapshot.number = ++number;
    snapshot.session.device.status = DeviceStatus::ready;
    snapshot.session.tick.proxy.hip = hip;
    snapshot.session.tick.proxy.scp = scp;
    snapshot.session.tick.proxy.mode = hip == scp ? Mode::free : Mode::constrained;
    snapshot.session.tick.force = force;
    return snapshot;
}

inline bool is_blue(QRgb p) {
    return qBlue(p) > qRed(p) + 60 && qBlue(p) > qGreen(p) + 30;
}
inline bool is_vermilion(QRgb p) {
    return qRed(p) > 2 * qBlue(p) + 40 && qRed(p) > qGreen(p) + 40;
}
inline bool is_green(QRgb p) {
    return qGreen(p) > qRed(p) + 40 && qGreen(p) > qBlue(p) + 15;
}
inline bool is_bone(QRgb p) {
    return qRed(p) > qGreen(p) && qGreen(p) > qBlue(p) && qRed(p) > qBlue(p) + 10;
}

/// What the pixels for which `is` holds are like.
struct Blob {
    int count = 0;
    double x = 0, y = 0;  ///< their middle
    int left = 1 << 20, right = -1, top = 1 << 20, bottom = -1;
};
template <class Is>
Blob blob(const QImage& image, Is is) {
    Blob b;
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            if (!is(image.pixel(x, y))) continue;
            ++b.count;
            b.x += x + 0.5;
            b.y += y + 0.5;
            b.left = std::min(b.left, x);
            b.right = std::max(b.right, x);
            b.top = std::min(b.top, y);
            b.bottom = std::max(b.bottom, y);
        }
    }
    if (b.count > 0) {
        b.x /= b.count;
        b.y /= b.count;
    }
    return b;
}

}  // namespace palpate::viewer
