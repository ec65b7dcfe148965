// A fixture: the window, used by keys and mouse.
#pragma once

#include <gtest/gtest.h>

#include <QApplication>
#include <QDialog>
#include <QDir>
#include <QDragEnterEvent>
#include <QDropEvent>
#include <QLineEdit>
#include <QMessageBox>
#include <QMimeData>
#include <QPushButton>
#include <QSettings>
#include <QTabWidget>
#include <QTimer>
#include <QUrl>
#include <QWheelEvent>
#include <QtTest>
#include <fstream>
#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>

#include "apps/viewer/panel/timeline.hpp"
#include "apps/viewer/scene/scene.hpp"
#include "apps/viewer/slices/slice_pane.hpp"
#include "apps/viewer/window/brush_controls.hpp"
#include "apps/viewer/window/device_controls.hpp"
#include "apps/viewer/window/look_controls.hpp"
#include "apps/viewer/window/main_window.hpp"
#include "apps/viewer/window/overlay_controls.hpp"
#include "apps/viewer/window/panel.hpp"
#include "apps/viewer/window/views.hpp"
#include "support/scratch_folder.hpp"
#include "viewer/kept_picture.hpp"
#include "viewer/undrawn.hpp"
#include "viewer/waiting.hpp"

namespace palpate::viewer::test {

/// Two labels, half of a ball each, on a coarser grid than the ball's, as 3D Slicer writes them.
inline void write_segmentation(const std::filesystem::path& path) {
    std::ofstream out(path, std::ios::binary);
    out << "NRRD0004\ntype: unsigned char\ndimension: 3\nspace: left-posterior-superior\n"
           "sizes: 24 24 24\nspace directions: (2,0,0) (0,2,0) (0,0,2)\n"
           "kinds: domain domain domain\nencoding: raw\nspace origin: (-23,-23,-23)\n"
           "Segment0_ID:=Segment_1\nSegment0_LabelValue:=1\nSegment0_Name:=left half\n"
           "Segment0_Color:=0.9 0.1 0.1\nSegment1_ID:=Segment_2\nSegment1_LabelValue:=7\n"
           "Segment1_Name:=right half\nSegment1_Color:=0.1 0.2 0.9\n\n";
    for (int i = 0; i < 24 * 24 * 24; ++i) {
        const Vec3 at = Vec3(i % 24, i / 24 % 24, i / 576) - Vec3::Constant(11.5);
        out.put(at.norm() > 8 ? '\0' : at[0] < 0 ? '\1' : '\7');
    }
}

/// A window that draws only in suites whose names begin with Drawn.
class InWindow : public testing::Test {
  protected:
    void SetUp() override {
        QSettings::setPath(QSettings::NativeFormat, QSettings::UserScope,
                           QString::fromStdString(scratch_.path().string()));
        QSettings().clear();
        // A window of another test that was closed told the application to quit, and no dialog runs
        // an event loop until one of the application's own has ended.
        QTimer::singleShot(0, [] { QApplication::exit(0); });
        QApplication::exec();
        open_window("mouse");
    }

    void TearDown() override {
        if (window_) save("at-the-end");
        window_.reset();
    }

    /// Forces begin at once and go on however long the machine stalls.
    static run::Setup setup_with(const std::string& device) {
        run::Setup setup;
        setup.device = devices::parse_device(device);
        setup.real_time = false;
        setup.render.force.ramp = 0;
        setup.render.force.stale_after = std::numeric_limits<double>::infinity();
        setup.session.overrun = std::numeric_limits<double>::infinity();
        return setup;
    }
    void open_window(const std::string& device) { open_window(setup_with(device)); }
    void open_window(const run::Setup& setup) { open_window(RunRequest{setup, {}, {}}); }
    void open_window(const RunRequest& request) {
        window_ = std::make_unique<MainWindow>(request, painter_of_test());
        window_->resize(1060, 720);  // small: frames are drawn in software
        window_->show();
        activate(*window_);
    }

    /// As viewer::wait_until(), but a problem that the window tells meanwhile ends the test.
    void wait_until(const std::function<bool()>& so,
                    const std::source_location& here = std::source_location::current()) const {
        const auto problem = [this] { return window_ ? window_->messages().problem() : QString(); };
        const QString before = problem();
        viewer::wait_until([&] { return so() || problem() != before; }, here);
        if (!so()) throw std::runtime_error(problem().toStdString());
    }
    /// Until the servo has done so many ticks more, of this run or the next.
    void wait_for_ticks(std::int64_t ticks) const {
        std::int64_t last = now().number;
        wait_until([&] {
            const std::int64_t number = window_->live() ? now().number : last + ticks;
            ticks -= number >= last ? number - last : number;
            last = number;
            return ticks <= 0;
        });
    }
    /// Until what was asked for is felt and shown.
    void wait_until_settled() const {
        const auto is_settled = [this] { return window_->settled(); };
        wait_until(is_settled);
        if (window_->live()) wait_for_ticks(2);
        window_->tick();
        wait_until_quiet(*window_);
        wait_until(is_settled);
    }

    /// Goes on with another device, or adds a hand, until that is done or refused.
    void use_device(const std::string& device) {
        connector().use_device(devices::parse_device(device));
        wait_until_connected();
    }
    void add_hand(const std::string& device) {
        connector().add_hand(devices::parse_device(device));
        wait_until_connected();
    }
    Connector& connector() const { return window_->panel().device_controls().connector(); }
    void wait_until_connected() const {
        viewer::wait_until([this] { return !connector().task().busy(); });
    }

    /// Records from now on.
    void record(const char* name) {
        window_->recordings().start(scratch(name));
        viewer::wait_until([this] { return window_->recordings().settled(); });
    }
    /// Until the recording is complete.
    void stop_recording() {
        window_->recordings().stop();
        viewer::wait_until([this] { return window_->recordings().settled(); });
    }
    /// Opens a volume and waits until it is felt.
    void feel(const std::string& name) {
        window_->files().open_path(QString::fromStdString(name));
        wait_until([&] { return window_->live() && window_->live()->snapshot(); });
        wait_until_settled();
        if (window_->live()->mouse()) wait_for_hand();
    }

    /// What is felt; right after a start, once there is something.
    Snapshot now() const {
        wait_until([&] { return window_->live()->snapshot().has_value(); });
        return window_->live()->snapshot().value();
    }
    double force() const { return now().session.tick.force.norm(); }

    /// Until the hand is where the mouse aims, and turned as it is to be. `within` [device mm].
    void wait_for_hand(double within = 1e-3) const {
        wait_until([&] {
            const devices::Mouse& mouse = *window_->live()->mouse();
            const DeviceReading hand = now().session.device;
            return (hand.position - mouse.aimed()).norm() < within &&
                   Quaternion(hand.orientation).angularDistance(mouse.turned_to()) < 1e-3;
        });
    }

    /// A key that goes to whatever of the window has it as a shortcut.
    void press(Qt::Key key, Qt::KeyboardModifiers with = {}) {
        activate(*window_);
        QTest::keyClick(window_.get(), key, with);
    }

    /// A length between two points of a pane.
    void measure(SlicePane& pane) {
        press(Qt::Key_M);
        handle_events();
        for (const int x : {0, 20}) {
            QTest::mouseClick(&pane, Qt::LeftButton, {}, pane.rect().center() + QPoint(x, 5));
        }
    }

    /// In the middle of a widget, a notch forward for each step.
    /// `notch`: of each step; 120 is that of a common wheel.
    void turn_wheel(QWidget& widget, int steps, int notch = 120) {
        const QPointF at = QRectF(widget.rect()).center();
        for (int i = 0; i < std::abs(steps); ++i) {
            QWheelEvent event(at, widget.mapToGlobal(at.toPoint()), {},
                              {0, steps > 0 ? notch : -notch}, Qt::NoButton, Qt::NoModifier,
                              Qt::NoScrollPhase, false);
            QApplication::sendEvent(&widget, &event);
        }
    }
    void drag(QWidget& widget, const QPoint& from, const QPoint& to,
              Qt::MouseButton button = Qt::LeftButton, Qt::KeyboardModifiers keys = {}) {
        QTest::mousePress(&widget, button, keys, from);
        constexpr int steps = 8;
        for (int i = 1; i <= steps; ++i) {
            const QPoint at = from + (to - from) * i / steps;
            // QTest's own move has no button: the event is made as the window system would.
            QMouseEvent event(QEvent::MouseMove, at, widget.mapToGlobal(at), Qt::NoButton, button,
                              keys);
            QApplication::sendEvent(&widget, &event);
            QApplication::processEvents();
        }
        QTest::mouseRelease(&widget, button, keys, to);
    }
    /// Turns the wheel over the scene, a step each time the hand has arrived, until it is so or the
    /// hand has gone through everything.
    bool press_until(const std::function<bool()>& so, int notch = 120) {
        for (int i = 0; i < 300 && !so(); ++i) {
            turn_wheel(window_->views().scene(), 1, notch);
            wait_for_hand(0.1);
        }
        return so();
    }
    /// Pushes the probe into the depth of the view until there is force.
    void press_until_force() {
        ASSERT_TRUE(press_until([&] { return force() > 0.3; }));
    }

    /// A widget of the panel, with its page in front and its section open.
    template <class Widget>
    Widget& on_page(const char* name) {
        auto& widget = part<Widget>(name);
        window_->panel().show_section(widget);
        QApplication::processEvents();
        return widget;
    }
    /// Does what opens a file dialog, and `act` in the line for its name. The dialog has an event
    /// loop of its own: it is done from within, again where that came before it was ready.
    static void in_file_dialog(const std::function<void()>& open,
                               const std::function<void(QLineEdit&)>& act) {
        QTimer person;
        int done = 0;
        QObject::connect(&person, &QTimer::timeout, [&] {
            QWidget* dialog = QApplication::activeModalWidget();
            auto* line = dialog ? dialog->findChild<QLineEdit*>("fileNameEdit") : nullptr;
            if (!line || !line->isVisible()) return;
            ++done;
            act(*line);
        });
        person.start(10);
        open();
        EXPECT_GT(done, 0);
    }
    /// Gives a name there, at once, because after each key Qt looks for completions in the whole
    /// folder.
    static void typing(const QString& name, const std::function<void()>& open) {
        in_file_dialog(open, [&](QLineEdit& line) {
            line.setText(name);
            QTest::keyClick(&line, Qt::Key_Return);
        });
    }
    /// The same, of a dialog that a key opens, with Ctrl.
    void type_in_dialog(Qt::Key key, const QString& name, Qt::KeyboardModifiers with = {}) {
        typing(name, [&] { press(key, Qt::ControlModifier | with); });
        activate(*window_);
    }
    /// Drops files or addresses on the window.
    void drop(const QList<QUrl>& urls) {
        QMimeData data;
        data.setUrls(urls);
        QDragEnterEvent enter({10, 10}, Qt::CopyAction, &data, Qt::LeftButton, Qt::NoModifier);
        QApplication::sendEvent(window_.get(), &enter);
        ASSERT_TRUE(enter.isAccepted());
        QDropEvent event({10, 10}, Qt::CopyAction, &data, Qt::LeftButton, Qt::NoModifier);
        QApplication::sendEvent(window_.get(), &event);
    }
    void drop(const QString& path) { drop({QUrl::fromLocalFile(path)}); }
    /// The strip of a task that is in progress; null: there is none.
    QWidget* strip() {
        for (auto* one : window_->findChildren<QWidget*>("progress")) {
            if (one->isVisible()) return one;
        }
        return nullptr;
    }
    /// The same when a task has taken so long that its strip is due.
    QWidget* late_strip() {
        for (auto* one : window_->findChildren<QWidget*>("progress")) {
            for (auto* late : one->findChildren<QTimer*>()) {
                QTimerEvent due(late->timerId());
                if (late->isActive()) QApplication::sendEvent(late, &due);
            }
        }
        return strip();
    }
    /// Presses the button that cancels a task, once it is there.
    void cancel_task() {
        wait_until([&] { return strip() != nullptr; });
        QTest::mouseClick(strip()->findChild<QPushButton*>("cancel"), Qt::LeftButton);
    }
    /// Presses a button of the question that comes.
    void answer(QMessageBox::StandardButton button) {
        auto* finger = new QTimer(window_.get());
        QObject::connect(finger, &QTimer::timeout, [finger, button] {
            auto* box = qobject_cast<QMessageBox*>(QApplication::activeModalWidget());
            if (!box || !box->isVisible()) return;
            finger->deleteLater();
            finger->stop();
            QTest::mouseClick(box->button(button), Qt::LeftButton);
        });
        finger->start(10);
    }

    template <class Widget>
    Widget& part(const char* name) {
        auto* widget = window_->findChild<Widget*>(name);
        if (!widget) throw std::runtime_error(std::string("no widget ") + name);
        return *widget;
    }
    QString scratch(const char* name) const {
        return QString::fromStdString((scratch_.path() / name).string());
    }
    /// A picture for people to look at, in a suite that draws.
    void save(const std::string& name) {
        if (!draws()) return;
        QDir().mkpath(PALPATE_PICTURES);
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        EXPECT_TRUE(keep(window_->grab().toImage(),
                         QString("%1/%2-%3.png")
                             .arg(PALPATE_PICTURES, test->name(), QString::fromStdString(name))));
    }

    support::ScratchFolder scratch_;
    std::unique_ptr<MainWindow> window_;
};

}  // namespace palpate::viewer::test
