// A slice pane in a window, with mouse input and pictures of it.
#pragma once

#include <QApplication>
#include <QDir>
#include <QImage>
#include <QTest>
#include <QWheelEvent>

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "apps/viewer/slices/slice_pane.hpp"
#include "palpate/scenes/volumes.hpp"
#include "viewer/kept_picture.hpp"
#include "viewer/waiting.hpp"

namespace palpate::viewer {

/// A ball of 20 mm round the origin (0.5 is its surface) on a grid of 48 x 40 x 33 samples.
inline Field ball_on(const Mat3& direction, const Vec3& spacing = {1, 1.25, 1.5}) {
    const Geometry geometry = scenes::centred({48, 40, 33}, spacing, direction);
    return linear_field(scenes::make_volume("sphere", geometry, SampleType::float32).volume);
}

/// A pane that is shown, and what it has told.
struct ShownPane {
    explicit ShownPane(int axis, const std::optional<Field>& field = {}, double isovalue = 0.5)
        : pane(axis) {
        pane.resize(400, 360);
        if (field) pane.set_field(*field, isovalue);
        pane.show();
        wait_until_exposed(pane);
        QObject::connect(&pane, &SlicePane::crosshair_chosen, &pane,
                         [this](const Vec3& p) { chosen.push_back(p); });
        QObject::connect(&pane, &SlicePane::probe_aimed, &pane,
                         [this](const Vec3& p) { aimed.push_back(p); });
        QObject::connect(&pane, &SlicePane::probe_dragged, &pane,
                         [this](const Vec3& by) { dragged.push_back(by); });
        QObject::connect(&pane, &SlicePane::window_chosen, &pane,
                         [this](const GreyWindow& window) { windows.push_back(window); });
    }

    void wheel(const QPoint& at, int turned, Qt::KeyboardModifiers keys = Qt::NoModifier) {
        QWheelEvent event(at, pane.mapToGlobal(at), {}, {0, turned}, Qt::NoButton, keys,
                          Qt::NoScrollPhase, false);
        QApplication::sendEvent(&pane, &event);
    }
    void drag(Qt::MouseButton button, const QPoint& from, const QPoint& to,
              Qt::KeyboardModifiers keys = Qt::NoModifier) {
        QTest::mousePress(&pane, button, keys, from);
        QMouseEvent move(QEvent::MouseMove, to, pane.mapToGlobal(to), Qt::NoButton, button, keys);
        QApplication::sendEvent(&pane, &move);
        QTest::mouseRelease(&pane, button, keys, to);
    }
    /// Once the pane has caught up: one whose slice takes long leaves time to others first.
    QImage picture() {
        do {
            pane.grab();
            wait_until_quiet(pane);
            pane.grab();
        } while (holds_back(pane));
        return pane.grab().toImage();
    }

    SlicePane pane;
    std::vector<Vec3> chosen, aimed, dragged;
    std::vector<GreyWindow> windows;
};

/// For people to look at.
inline void keep_picture(QWidget& widget, const QString& name) {
    QDir().mkpath(PALPATE_PICTURES);
    const QString scale = widget.devicePixelRatioF() > 1 ? "_fine" : "";
    EXPECT_TRUE(
        keep(widget.grab().toImage(), QString(PALPATE_PICTURES) + "/" + name + scale + ".png"));
}

inline Snapshot contact_at(const Vec3& hip, const Vec3& scp, const Vec3& force) {
    Snapshot snapshot;
    Tick& tick = snapshot.session.tick;
    tick.proxy.hip = hip;
    tick.proxy.scp = scp;
    tick.proxy.mode = Mode::constrained;
    tick.force = force;
    snapshot.session.device.status = DeviceStatus::ready;
    return snapshot;
}

}  // namespace palpate::viewer
