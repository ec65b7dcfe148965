// Sessions in files: what is shown and felt now, and going on with it another day.
#include <fmt/format.h>

#include "apps/viewer/panel/panel.hpp"
#include "apps/viewer/scene/scene.hpp"
#include "apps/viewer/window/main_window.hpp"
#include "apps/viewer/window/views.hpp"

namespace palpate::viewer {

SessionFile MainWindow::session_now() const {
    SessionFile session;
    session.volume = opened_->options;
    if (live_) {
        const auto now = live_->snapshot();
        session.solid = live_->field().solid();
        session.background = live_->field().background();
        session.isovalue = live_->isovalue();
        session.device = live_->options().device;
        session.method = live_->options().render.method;
        session.settings = live_->settings();
        if (now) session.settings->transform = now->session.transform;
    } else {
        const io::RecordingHead& head = playback_->head();
        session.solid = head.solid;
        session.background = head.background;
        session.isovalue = head.isovalue;
        session.device = options_.device;
        session.method = head.method;
        session.settings = head.settings;
    }
    session.look = panel_->look();
    session.camera = views_->scene().camera();
    session.crosshair = views_->crosshair();
    session.follow = views_->follows();
    session.window_low = views_->window_low();
    session.window_high = views_->window_high();
    session.slices_shown = views_->slices_shown();
    return session;
}

void MainWindow::save_session(const QString& path) {
    if (!opened_) return;
    write_session(path.toStdString(), session_now());
    remember(path);
    show_done(tr("Saved %1").arg(path));
}

void MainWindow::open_session(const QString& path) {
    problem_.clear();
    guarded([&] {
        const SessionFile session = read_session(path.toStdString());
        load_or_reuse(session.volume, [this, session, path,
                                       options = options_once()](std::shared_ptr<Opened> opened) {
            resume(std::move(opened), session, options);
            remember(path);
        });
    });
}

/// What the device at hand cannot render stays as it is, and is told.
void MainWindow::restore(const RendererSettings& settings) {
    send(settings.force);
    send(settings.proxy.friction);
    send(settings.penetrability);
    send(settings.transform);
    send(command::Forces{settings.forces_on});
}

/// With the device that the options name; where that cannot be had, with the one of this window.
void MainWindow::begin_with(std::shared_ptr<Opened> opened, app::TouchOptions options) {
    try {
        begin(opened, options);
        options_.device = options.device;
    } catch (const std::exception& e) {
        if (options.device == options_.device) throw;
        const QString why = QString::fromStdString(app::failure_of(e).text);
        options.device = options_.device;
        begin(opened, options);
        show_done(
            tr("%1; felt through the device %2").arg(why, QString::fromStdString(options.device)));
    }
}

/// `options`: of the command line; a device that it names wins.
void MainWindow::resume(std::shared_ptr<Opened> opened, const SessionFile& session,
                        app::TouchOptions options) {
    options.volume = session.volume;
    options.field.solid = session.solid == Solid::above ? "above" : "below";
    options.field.background = session.background ? fmt::format("{}", *session.background) : "";
    options.field.isovalue = fmt::format("{}", session.isovalue);
    if (!options.device_given) options.device = session.device;
    options.render.method = session.method;
    begin_with(std::move(opened), options);
    use_usual_look();
    if (session.settings) restore(*session.settings);
    panel_->set_session(live_->field(), opened_->histogram, live_->isovalue(), live_->settings(),
                        live_->device());
    show_data();
    Look look = session.look;
    if (look.transfer.points.empty()) look.transfer = panel_->look().transfer;
    panel_->set_look(look);
    views_->set_look(look);
    if (session.window_low < session.window_high) {
        views_->set_window(session.window_low, session.window_high);
    }
    if (session.crosshair) views_->set_crosshair(*session.crosshair);
    views_->set_follow(session.follow);
    views_->show_slices(session.slices_shown);
    if (session.camera) views_->scene().set_camera(*session.camera);
    refresh_actions();
}

}  // namespace palpate::viewer
