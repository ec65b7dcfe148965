// A fixture: a panel that shows a session, and the commands that it asks for.
#pragma once

#include <gtest/gtest.h>

#include <QApplication>
#include <QLabel>
#include <QMouseEvent>
#include <QScrollArea>
#include <QSignalSpy>
#include <QTabWidget>
#include <QTest>

#include <memory>
#include <optional>
#include <random>
#include <stdexcept>
#include <vector>

#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/window/brush_controls.hpp"
#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/device_controls.hpp"
#include "apps/viewer/window/look_controls.hpp"
#include "apps/viewer/window/messages.hpp"
#include "apps/viewer/window/panel.hpp"
#include "apps/viewer/window/tool_controls.hpp"
#include "apps/viewer/window/views.hpp"
#include "viewer/undrawn.hpp"
#include "viewer/waiting.hpp"

namespace palpate::viewer {

/// Three clusters as in CT of a head: air, soft tissue, bone [HU].
inline Volume head_like() {
    std::mt19937 random(3);
    std::vector<std::int16_t> samples;
    const auto cluster = [&](int count, double centre, double width) {
        std::normal_distribution<double> normal(centre, width);
        for (int i = 0; i < count; ++i) {
            samples.push_back(
                static_cast<std::int16_t>(std::clamp(normal(random), -1000.0, 3000.0)));
        }
    };
    cluster(20000, -990, 15);
    cluster(9000, 40, 40);
    cluster(3766, 900, 350);
    samples.push_back(-1000);
    samples.push_back(3000);
    Geometry geometry;
    geometry.size = {32, 32, 32};
    return Volume(geometry, samples);
}

inline DeviceInfo desktop_device() {
    DeviceInfo info;
    info.name = "simulated";
    info.model = "desktop";
    return info;
}

/// Shown, active, with all that it emitted. `set` puts a session in.
class PanelFixture : public testing::Test {
  protected:
    PanelFixture() {
        for (Section* section : panel.findChildren<Section*>()) section->set_open(true);
        panel.resize(400, 1450);
        panel.show();
        activate(panel);
    }

    /// A session that carries out all commands that can be, unless they are refused.
    void begin(const Field& of, double isovalue, const RendererSettings& settings = {}) {
        histogram = run::histogram_of(of.volume(), 256);
        effect.begin(of, isovalue, settings, desktop_device(), histogram,
                     [this](const Command& command) {
                         commands.push_back(command);
                         if (refuse_with.isEmpty()) return;
                         throw std::invalid_argument(refuse_with.toStdString());
                     });
        QApplication::processEvents();
    }

    void set(const RendererSettings& settings = {}, double isovalue = 300,
             Solid solid = Solid::above) {
        session_settings = settings;
        field.emplace(linear_field(head_like(), solid));
        begin(*field, isovalue, settings);
    }

    /// A ball, or another volume, that is felt with these devices.
    void feel(const std::vector<std::string>& devices,
              const std::string& volume = "synthetic:sphere:24x24x24") {
        std::vector<run::Setup> hands;
        for (const std::string& device : devices) {
            run::Setup& setup = hands.emplace_back();
            setup.device = devices::parse_device(device);
            setup.real_time = false;
            setup.field.isovalue = 100.0;
        }
        const auto opened =
            std::make_shared<Opened>(open(run::source_named(volume), [](double) {}));
        content.start_run(opened, make_hands(*opened, hands));
        Q_EMIT content.device_changed();
    }
    void feel(const std::string& device, const std::string& volume = "synthetic:sphere:24x24x24") {
        feel(std::vector{device}, volume);
    }

    /// Until nothing is held back any more, and no tool is being made.
    void settle() {
        wait_until([this] { return !panel.tool_controls().maker().busy(); });
        wait_until_quiet(panel);
    }

    /// On the page that is shown from now on.
    template <class T>
    T* find(const char* name) {
        T* found = panel.findChild<T*>(name);
        if (!found) throw std::runtime_error(std::string("no widget ") + name);
        auto* tabs = panel.findChild<QTabWidget*>("tabs");
        for (int i = 0; i < tabs->count(); ++i) {
            if (!tabs->widget(i)->isAncestorOf(found)) continue;
            tabs->setCurrentIndex(i);
            QApplication::processEvents();
            qobject_cast<QScrollArea*>(tabs->widget(i))->ensureWidgetVisible(found);
        }
        return found;
    }

    /// All commands of a kind so far, and none that wait.
    template <class T>
    std::vector<T> of() {
        settle();
        std::vector<T> found;
        for (const Command& command : commands) {
            if (const auto* one = std::get_if<T>(&command)) found.push_back(*one);
        }
        return found;
    }

    /// Types a number over what is there.
    void type(const char* name, const QString& text) {
        auto* box = find<QWidget>(name);
        box->setFocus();
        QTest::keyClick(box, Qt::Key_A, Qt::ControlModifier);
        QTest::keyClicks(box, text);
        QTest::keyClick(box, Qt::Key_Return);
    }

    void press(const char* name) { QTest::mouseClick(find<QWidget>(name), Qt::LeftButton); }

    /// A drag through places of a widget, in steps as a hand makes them.
    static void drag(QWidget* widget, QPointF from, QPointF to,
                     Qt::KeyboardModifiers keys = Qt::NoModifier, bool release = true) {
        QTest::mousePress(widget, Qt::LeftButton, keys, from.toPoint());
        for (int i = 1; i <= 8; ++i) {
            move(widget, from + (to - from) * (i / 8.0), keys);
        }
        if (release) QTest::mouseRelease(widget, Qt::LeftButton, keys, to.toPoint());
    }
    static void move(QWidget* widget, QPointF to, Qt::KeyboardModifiers keys = Qt::NoModifier) {
        QMouseEvent event(QEvent::MouseMove, to.toPoint(), widget->mapToGlobal(to.toPoint()),
                          Qt::NoButton, Qt::LeftButton, keys);
        QApplication::sendEvent(widget, &event);
    }

    QString message(const char* part) {
        settle();
        return find<QLabel>((std::string(part) + "_message").c_str())->text();
    }

    const BrushChoice& brush() { return panel.brush_controls().choice(); }

    // The order counts: what the panel asks for on its way out is still heard.
    std::vector<Command> commands;
    QString refuse_with;
    RendererSettings session_settings;
    std::optional<Field> field;
    run::Histogram histogram;
    Content content;
    Effect& effect = content.effect();
    Views views{painter_of_test()};
    QWidget window;  // of messages
    Messages messages{&window};
    Desk desk{content, messages, views};
    Panel panel{desk};
};

}  // namespace palpate::viewer
