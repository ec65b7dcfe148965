// The program palpate-viewer: a window in which you see and touch a volume.
#include <QVTKOpenGLNativeWidget.h>
#include <vtkObject.h>

#include <QApplication>
#include <QSurfaceFormat>
#include <QTimer>
#include <clocale>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "apps/options/exit_status.hpp"
#include "apps/options/values.hpp"
#include "apps/options/view_options.hpp"
#include "apps/viewer/model/hands.hpp"
#include "apps/viewer/model/opening.hpp"
#include "apps/viewer/panel/application.hpp"
#include "apps/viewer/window/file_dialogs.hpp"
#include "apps/viewer/window/main_window.hpp"
#include "apps/viewer/window/preferences.hpp"
#include "apps/viewer/window/screenshot.hpp"

namespace {

using namespace palpate;

volatile std::sig_atomic_t stop_signal = 0;

void on_signal(int number) {
    stop_signal = number;
}

void open(viewer::MainWindow& window, const app::ViewOptions& options) {
    // Dialogs begin where the file lies, also those that save.
    for (const std::string& name : {options.session, options.play, options.run.source.name()}) {
        if (!name.empty()) viewer::remember_folder(QString::fromStdString(name));
    }
    if (!options.session.empty()) {
        window.files().open_session(QString::fromStdString(options.session));
    } else if (!options.play.empty()) {
        window.files().open_recording(QString::fromStdString(options.play));
    } else if (options.has_volume()) {
        const run::Source source = options.run.source.source();
        options.run.source.warn_of_no_effect(source);
        const bool ask = options.screenshot.empty() && viewer::lacks_layout(source);
        ask ? window.files().ask_layout(source) : window.files().open_volume(source);
    }
}

int show(QApplication& application, const app::ViewOptions& options) {
    const std::vector<devices::DeviceChoice>& devices = options.run.devices;
    viewer::RunRequest request{options.run.setups().front(), {}, options.run.record};
    if (!devices.empty()) {
        request.device = devices.front();
        request.others.assign(devices.begin() + 1, devices.end());
    }
    for (const auto button : options.run.named_buttons) {
        request.buttons.emplace_back(button, request.setup.buttons.*button);
    }
    request.named_settings = [use = options.run.render.named(), &options,
                              told = false](RendererSettings& of_session) mutable {
        use(of_session);
        if (!std::exchange(told, true)) options.warn_beside_settings();
    };
    viewer::MainWindow window(request);
    if (const auto size = options.window_size()) window.resize((*size)[0], (*size)[1]);
    if (!options.size.empty() || !options.screenshot.empty()) window.forget_layout();
    viewer::remember_nothing(!options.screenshot.empty());
    if (!options.screenshot.empty()) window.messages().set_unattended();
    window.show();
    open(window, options);
    // A signal ends the window at once: forces go to zero, without a question.
    QTimer signals;
    QObject::connect(&signals, &QTimer::timeout, [&] {
        if (stop_signal != 0) window.end();
    });
    signals.start(50);
    std::unique_ptr<viewer::Screenshot> screenshot;
    if (!options.screenshot.empty()) {
        screenshot = std::make_unique<viewer::Screenshot>(
            window, QString::fromStdString(options.screenshot), options.after);
    }
    int status = application.exec();
    const int finished = window.finish([] {
        // The force is zero: from now on a signal ends the wait for a slow reader, too.
        for (const int s : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) std::signal(s, SIG_DFL);
    });
    if (status == 0) status = finished;
    if (screenshot && screenshot->status() != 0) status = screenshot->status();
    if (stop_signal != 0) status = app::fail("interrupted", app::status_of_signal(stop_signal));
    if (!window.has_closed_devices()) {  // a driver hangs, for which the window would wait
        std::fflush(nullptr);
        std::_Exit(status);
    }
    return status;
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App command("Look at a volume while feeling it, in a window.", "palpate-viewer");
    command.set_version_flag("--version", "palpate " PALPATE_VERSION);
    app::ViewOptions options;
    options.add_to(command);
    try {
        app::refuse_impossible_values(command, argc, argv);
        command.parse(argc, argv);
        options.settle();
        if (options.run.devices.size() > viewer::most_hands) {
            throw std::invalid_argument(
                "--device: the window has two hands at most; palpate touch --headless takes more");
        }
        options.warn();
    } catch (const CLI::Success& e) {
        return command.exit(e);
    } catch (const CLI::ParseError& e) {
        return app::fail(app::complaint(command, e), app::wrong_use);
    } catch (const std::exception& e) {
        return app::fail(e.what(), app::wrong_use);
    }
    for (const int s : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) std::signal(s, on_signal);
    for (const int s : {SIGXFSZ, SIGPIPE}) std::signal(s, SIG_IGN);
    // A program that is suspended could not end the force.
    for (const int s : {SIGTSTP, SIGTTIN, SIGTTOU}) std::signal(s, SIG_IGN);
    // A window of its own for VTK's warnings would come between.
    vtkObject::GlobalWarningDisplayOff();
    QCoreApplication::setAttribute(Qt::AA_EnableHighDpiScaling);
    QCoreApplication::setAttribute(Qt::AA_UseHighDpiPixmaps);
    // Qt would make 150 % of it 200 %, for which a laptop's screen is too small.
    QGuiApplication::setHighDpiScaleFactorRoundingPolicy(
        Qt::HighDpiScaleFactorRoundingPolicy::PassThrough);
    QSurfaceFormat::setDefaultFormat(QVTKOpenGLNativeWidget::defaultFormat());
    QApplication::setStyle("fusion");
    int qt_arguments = 1;
    viewer::Application application(qt_arguments, argv);
    QCoreApplication::setOrganizationName("palpate");
    QCoreApplication::setApplicationName("palpate");
    // Qt has taken the system's; files are read with strtod, whose point must stay a point.
    std::setlocale(LC_NUMERIC, "C");
    const viewer::Preferences preferences = viewer::saved_preferences();
    const viewer::Translation translation(preferences.language);
    viewer::set_appearance(preferences.appearance);
    try {
        return show(application, options);
    } catch (const std::exception& e) {
        const app::Failure failure = app::failure_of(e);
        return app::fail(failure.text, failure.status);
    }
}
