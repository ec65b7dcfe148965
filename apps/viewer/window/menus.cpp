// Menus, tool bar and the questions that they ask.
#include <QAction>
#include <QApplication>
#include <QDateTime>
#include <QDir>
#include <QDockWidget>
#include <QFileDialog>
#include <QMenu>
#include <QMenuBar>
#include <QSettings>
#include <QToolBar>

#include "apps/viewer/panel/panel.hpp"
#include "apps/viewer/scene/scene.hpp"
#include "apps/viewer/window/appearance.hpp"
#include "apps/viewer/window/main_window.hpp"
#include "apps/viewer/window/raw_dialog.hpp"
#include "apps/viewer/window/shortcuts.hpp"
#include "apps/viewer/window/views.hpp"

namespace palpate::viewer {
namespace {

/// Where files were opened or saved last.
QString last_folder() {
    return QSettings().value("folder", QDir::currentPath()).toString();
}

QString stamp() {
    return QDateTime::currentDateTime().toString("yyyyMMdd-hhmmss");
}

}  // namespace

QAction* MainWindow::add(QMenu* menu, const char* name, const QString& text,
                         const QKeySequence& key, std::function<void()> action) {
    auto* entry = new QAction(text, this);
    entry->setObjectName(name);
    entry->setShortcut(key);
    entry->setAutoRepeat(false);  // a key that is held is one wish
    connect(entry, &QAction::triggered, this,
            [this, action = std::move(action)] { guarded(action); });
    menu->addAction(entry);
    return entry;
}

QAction* MainWindow::add_switch(QMenu* menu, const char* name, const QString& text,
                                const QKeySequence& key, std::function<void(bool)> action) {
    auto* entry = new QAction(text, this);
    entry->setObjectName(name);
    entry->setShortcut(key);
    entry->setAutoRepeat(false);  // a key that is held is one wish
    entry->setCheckable(true);
    connect(entry, &QAction::triggered, this,
            [this, action = std::move(action)](bool on) { guarded([&] { action(on); }); });
    menu->addAction(entry);
    return entry;
}

void MainWindow::make_menus() {
    make_file_menu();
    make_session_menu();
    make_data_menu();
    make_view_menu();
    make_hand_actions();
    QMenu* help = menuBar()->addMenu(tr("&Help"));
    add(help, "shortcuts_action", tr("&Shortcuts"), QKeySequence("?"), [this] {
        make_shortcuts_dialog(this)->show();
    })->setShortcuts({QKeySequence("?"), QKeySequence("Shift+?"), QKeySequence::HelpContents});
    auto* bar = addToolBar(tr("Tools"));
    bar->setObjectName("tools");
    for (const char* name :
         {"open", "forces", "freeze", "record", "pointer", "whole", "from_hand"}) {
        bar->addAction(findChild<QAction*>(name));
    }
    refresh_actions();
}

void MainWindow::make_file_menu() {
    QMenu* file = menuBar()->addMenu(tr("&File"));
    add(file, "open", tr("&Open…"), QKeySequence::Open, [this] { ask_open(); });
    add(file, "open_folder", tr("Open a &folder (DICOM, TIFF)…"), QKeySequence("Ctrl+Shift+O"),
        [this] { ask_open_folder(); });
    add(file, "open_raw", tr("Open ra&w data…"), {}, [this] { ask_open_raw(); });
    recent_ = file->addMenu(tr("Open &recent"));
    recent_->setObjectName("recent");
    connect(recent_, &QMenu::aboutToShow, this, &MainWindow::fill_recent);
    file->addSeparator();
    add(file, "save_session", tr("&Save the session…"), QKeySequence::Save,
        [this] { ask_save_session(); });
    add(file, "picture", tr("&Picture of the scene…"), QKeySequence("Ctrl+P"),
        [this] { ask_save_picture(false); });
    add(file, "window_picture", tr("Picture of the &window…"), QKeySequence("Ctrl+Shift+P"),
        [this] { ask_save_picture(true); });
    file->addSeparator();
    add(file, "quit", tr("&Quit"), QKeySequence("Ctrl+Q"), [this] { close(); });
}

void MainWindow::make_session_menu() {
    QMenu* session = menuBar()->addMenu(tr("&Session"));
    add_switch(session, "forces", tr("&Forces on"), QKeySequence(Qt::Key_Space),
               [this](bool on) { send(command::Forces{on}); });
    add_switch(session, "freeze", tr("Free&ze"), QKeySequence("F"),
               [this](bool on) { send(command::Freeze{on}); });
    add_switch(session, "clutch", tr("&Clutch: the volume follows the hand"), QKeySequence("C"),
               [this](bool on) { send(command::Clutch{on}); });
    add_switch(session, "pointer", tr("&Mouse moves the probe"), QKeySequence("H"),
               [this](bool on) { use_pointer_for(on); });
    session->addSeparator();
    const auto level = [this](double percent) {
        if (!live_) return;
        const double step = 0.01 * percent * live_->field().volume().range();
        send(command::Isovalue{live_->isovalue() + step});
    };
    add(session, "level_up", tr("Isovalue &up by 1 %"), QKeySequence("+"), [level] {
        level(1);
    })->setAutoRepeat(true);
    add(session, "level_down", tr("Isovalue &down by 1 %"), QKeySequence("-"), [level] {
        level(-1);
    })->setAutoRepeat(true);
    const auto scale = [this](double factor) {
        if (live_) send(command::Scale{live_->settings().transform.scale * factor});
    };
    add(session, "coarser", tr("Hand &larger in the volume"), QKeySequence("]"),
        [scale] { scale(1.1); });
    add(session, "finer", tr("Hand &smaller in the volume"), QKeySequence("["),
        [scale] { scale(1 / 1.1); });
    session->addSeparator();
    add_switch(session, "record", tr("&Record…"), QKeySequence("Ctrl+R"),
               [this](bool on) { ask_record(on); });
    add(session, "leave_playback", tr("Leave the recording, &feel again"), QKeySequence("Esc"),
        [this] { leave_playback(); });
}

void MainWindow::make_view_menu() {
    QMenu* view = menuBar()->addMenu(tr("&View"));
    add(view, "whole", tr("&Whole volume"), QKeySequence("R"),
        [this] { views_->scene().reset_camera(); });
    add(view, "from_hand", tr("From the &hand"), QKeySequence("0"), [this] {
        const auto now = live_ ? live_->snapshot() : std::nullopt;
        if (!now) return;
        const Mat3& hand = now->session.transform.rotation;
        views_->scene().look_from({hand.col(2), hand.col(1)});
    });
    int number = 0;
    for (const std::string& name : pictures::view_names()) {
        const QString text = QString::fromStdString(name);
        add(view, ("view_" + name).c_str(), tr("From the %1").arg(text),
            QKeySequence(QString::number(++number)),
            [this, name] { views_->scene().look_from(pictures::view_named(name)); });
    }
    view->addSeparator();
    add_switch(view, "slices", tr("&Slices beside the scene"), QKeySequence("X"), [this](bool on) {
        views_->show_slices(on);
    })->setChecked(true);
    auto* follow = add_switch(view, "follow", tr("&Crosshair follows the probe"), QKeySequence("G"),
                              [this](bool on) { views_->set_follow(on); });
    follow->setChecked(true);
    connect(views_, &Views::follow_changed, follow, &QAction::setChecked);
    auto* dock = findChild<QDockWidget*>("dock");
    dock->toggleViewAction()->setShortcut(QKeySequence("F9"));
    view->addAction(dock->toggleViewAction());
    add_switch(view, "full", tr("&Full screen"), QKeySequence("F11"),
               [this](bool on) { on ? showFullScreen() : showNormal(); });
    QMenu* appearance = view->addMenu(tr("&Appearance"));
    add(appearance, "system", tr("As the &system"), {}, [] { set_appearance(Appearance::system); });
    add(appearance, "light", tr("&Light"), {}, [] { set_appearance(Appearance::light); });
    add(appearance, "dark", tr("&Dark"), {}, [] { set_appearance(Appearance::dark); });
}

/// Which actions make sense now, and which switches are on.
void MainWindow::refresh_actions() {
    const auto now = live_ ? live_->snapshot() : std::nullopt;
    const auto set = [this](const char* name, bool enabled, std::optional<bool> checked = {}) {
        auto* action = findChild<QAction*>(name);
        action->setEnabled(enabled);
        if (checked) action->setChecked(*checked);
    };
    const bool live = live_ != nullptr;
    set("forces", live, live && live_->settings().forces_on);
    set("freeze", live, live && live_->frozen());
    set("clutch", live, now && now->session.clutched);
    set("record", live, live && live_->recording());
    for (const char* name : {"level_up", "level_down", "coarser", "finer", "from_hand"}) {
        set(name, live);
    }
    set("leave_playback", playback_.has_value());
    const bool sequence = live && live_->data().is_sequence();
    for (const char* name : {"brush_action", "undo_action", "redo_action"}) {
        set(name, live && !sequence);
    }
    for (const char* name : {"play_sequence", "frame_back", "frame_on"}) set(name, sequence);
    set("save_volume", live);
    set("slices", true, views_->slices_shown());
    for (const char* name : {"save_session", "picture", "whole"}) set(name, opened_ != nullptr);
}

void MainWindow::fill_recent() {
    recent_->clear();
    for (const QString& path : QSettings().value("recent").toStringList()) {
        connect(recent_->addAction(path), &QAction::triggered, this, [this, path] {
            if (may_lose_edits()) open_path(path);
        });
    }
    if (recent_->isEmpty()) recent_->addAction(tr("nothing yet"))->setEnabled(false);
}

void MainWindow::ask_open() {
    if (!may_lose_edits()) return;
    const QString path = QFileDialog::getOpenFileName(
        this, tr("Open a volume, a session or a recording"), last_folder(),
        tr("All that can be opened (*.nrrd *.nhdr *.mha *.mhd *.nii *.nii.gz *.dcm *.tif *.tiff "
           "*.vti *.json *.csv);;All files (*)"));
    if (!path.isEmpty()) open_path(path);
}

void MainWindow::ask_open_folder() {
    if (!may_lose_edits()) return;
    const QString path =
        QFileDialog::getExistingDirectory(this, tr("Open a folder of slices"), last_folder());
    if (!path.isEmpty()) open_path(path);
}

void MainWindow::ask_open_raw() {
    if (!may_lose_edits()) return;
    const QString path =
        QFileDialog::getOpenFileName(this, tr("Open raw data"), last_folder(), tr("All files (*)"));
    if (path.isEmpty()) return;
    RawDialog dialog(path, this);
    if (dialog.exec() == QDialog::Accepted) open_volume(dialog.options());
}

/// Empty if the person thinks better of it. A name without an extension gets `suffix`.
QString MainWindow::ask_save(const QString& title, const QString& name, const QString& suffix,
                             bool replaces) {
    QFileDialog dialog(this, title, last_folder(), QString("*.%1 (*.%1)").arg(suffix));
    dialog.setAcceptMode(QFileDialog::AcceptSave);
    dialog.setDefaultSuffix(suffix);
    dialog.setOption(QFileDialog::DontConfirmOverwrite, !replaces);
    dialog.selectFile(name);
    if (dialog.exec() != QDialog::Accepted) return {};
    QSettings().setValue("folder", dialog.directory().absolutePath());
    return dialog.selectedFiles().value(0);
}

void MainWindow::ask_save_session() {
    const QString path = ask_save(tr("Save the session"), "session.json", "json", true);
    if (!path.isEmpty()) save_session(path);
}

void MainWindow::ask_save_picture(bool whole_window) {
    const QString path = ask_save(tr("Save a picture"), "palpate-" + stamp() + ".png", "png", true);
    if (!path.isEmpty()) save_picture(path, whole_window);
}

void MainWindow::ask_record(bool on) {
    refresh_actions();  // the switch shows what is, not what is wanted
    if (!on) return stop_recording();
    const QString path =
        ask_save(tr("Record the session"), "session-" + stamp() + ".csv", "csv", false);
    if (!path.isEmpty()) start_recording(path);
}

}  // namespace palpate::viewer
