// Every menu entry with its key, its action and the condition that enables it.
#include "apps/viewer/window/menus.hpp"

#include <QAction>
#include <QDialog>
#include <QDockWidget>
#include <QMenu>
#include <QMenuBar>
#include <QToolBar>
#include <QToolButton>

#include <map>
#include <utility>

#include "apps/viewer/panel/brush_controls.hpp"
#include "apps/viewer/panel/icons.hpp"
#include "apps/viewer/panel/panel.hpp"
#include "apps/viewer/panel/timeline.hpp"
#include "apps/viewer/scene/scene.hpp"
#include "apps/viewer/window/file_dialogs.hpp"
#include "apps/viewer/window/main_window.hpp"
#include "apps/viewer/window/messages.hpp"
#include "apps/viewer/window/preferences.hpp"
#include "apps/viewer/window/views.hpp"
#include "apps/viewer/window/welcome.hpp"

namespace palpate::viewer {

QAction* Actions::add_switch(QMenu* menu, const char* name, const QString& text, const QString& key,
                             std::function<void(bool)> action, Condition on, Condition possible) {
    auto* entry = new QAction(text, window_);
    entry->setObjectName(name);
    entry->setShortcut(QKeySequence(key));
    entry->setAutoRepeat(false);
    entry->setCheckable(on != nullptr);
    connect(entry, &QAction::triggered, this, [this, action = std::move(action)](bool checked) {
        messages_.guarded([&] { action(checked); });
    });
    menu->addAction(entry);
    entries_.push_back({entry, std::move(on), std::move(possible)});
    return entry;
}

QAction* Actions::add(QMenu* menu, const char* name, const QString& text, const QString& key,
                      std::function<void()> action, Condition possible) {
    return add_switch(
        menu, name, text, key, [action = std::move(action)](bool) { action(); }, {},
        std::move(possible));
}

QAction* Actions::find(const char* name) const {
    return window_->findChild<QAction*>(name);
}

void Actions::refresh() {
    for (const Entry& entry : entries_) {
        if (entry.possible) entry.action->setEnabled(entry.possible());
        if (entry.on) entry.action->setChecked(entry.on());
    }
}

namespace {

QString key_of(QKeySequence::StandardKey key) {
    return QKeySequence(key).toString();
}

/// Names of pictures::view_names(), and what they are where the sides of the body are not known.
QString view_text(const std::string& name, bool oriented) {
    static const std::map<std::string, QString> ends = {{"front", "-Y"}, {"back", "+Y"},
                                                        {"left", "+X"},  {"right", "-X"},
                                                        {"top", "+Z"},   {"bottom", "-Z"}};
    const auto end = ends.find(name);
    if (!oriented && end != ends.end()) return MainWindow::tr("From %1").arg(end->second);
    if (name == "front") return MainWindow::tr("From the front");
    if (name == "back") return MainWindow::tr("From the back");
    if (name == "left") return MainWindow::tr("From the left");
    if (name == "right") return MainWindow::tr("From the right");
    if (name == "top") return MainWindow::tr("From the top");
    if (name == "bottom") return MainWindow::tr("From the bottom");
    if (name == "oblique") return MainWindow::tr("From a corner");
    return QString::fromStdString(name);
}

/// Puts a menu behind a button of the bar.
void add_menu(QToolBar& bar, QMenu& menu, Shape shape) {
    QAction* action = menu.menuAction();
    action->setIcon(icon_of(shape));
    action->setIconVisibleInMenu(false);
    bar.addAction(action);
    qobject_cast<QToolButton*>(bar.widgetForAction(action))
        ->setPopupMode(QToolButton::InstantPopup);
}

}  // namespace

/// While a volume is open, or a live run.
Actions::Condition MainWindow::if_open() const {
    return [this] { return content_.volume() != nullptr; };
}

Actions::Condition MainWindow::if_live() const {
    return [this] { return live() != nullptr; };
}

void MainWindow::fill_recent(QMenu& menu) {
    menu.clear();
    for (const QString& path : recent_files()) {
        connect(menu.addAction(path), &QAction::triggered, this,
                [this, path] { settle_work([this, path] { files_.open_path(path); }); });
    }
    if (menu.isEmpty()) menu.addAction(tr("nothing yet"))->setEnabled(false);
}

void MainWindow::add_open_actions(QMenu* menu) {
    const auto open = [this](auto ask) {
        return [this, ask] {
            settle_work([this, ask] {
                const QString path = ask(this);
                if (!path.isEmpty()) files_.open_path(path);
            });
        };
    };
    actions_.add(menu, "open", tr("&Open…"), key_of(QKeySequence::Open), open(ask_open_name));
    actions_.add(menu, "open_folder", tr("Open a &folder (DICOM, TIFF, Zarr)…"), "Ctrl+Shift+O",
                 open(ask_open_folder));
    actions_.add(menu, "open_raw", tr("Open raw &data…"), {}, [this] {
        settle_work([this] {
            const QString path = ask_open_raw_name(this);
            if (!path.isEmpty()) files_.ask_layout(run::source_named(path.toStdString()));
        });
    });
    actions_.add(menu, "open_address", tr("Open a&n address…"), "Ctrl+L",
                 [this] { settle_work([this] { files_.ask_address(); }); });
    QMenu* recent = menu->addMenu(tr("Open &recent"));
    recent->setObjectName("recent");
    connect(recent, &QMenu::aboutToShow, this, [this, recent] { fill_recent(*recent); });
}

void MainWindow::add_save_actions(QMenu* menu) {
    actions_.add(
        menu, "save_session", tr("&Save the session"), key_of(QKeySequence::Save),
        [this] { save_session(content_.session()); }, if_open());
    actions_.add(
        menu, "save_session_as", tr("Save the session &as…"), {}, [this] { save_session({}); },
        if_open());
    const auto picture = [this](bool whole_window) {
        const QString path =
            ask_save_name(this, tr("Save a picture"), "palpate-" + time_stamp() + ".png", "png");
        if (!path.isEmpty()) save_picture(path, whole_window);
    };
    actions_.add(
        menu, "picture", tr("&Picture of the scene…"), "Ctrl+P", [picture] { picture(false); },
        if_open());
    actions_.add(menu, "window_picture", tr("Picture of the &window…"), "Ctrl+Shift+P",
                 [picture] { picture(true); });
}

void MainWindow::make_file_menu() {
    QMenu* file = menuBar()->addMenu(tr("&File"));
    add_open_actions(file);
    file->addSeparator();
    add_save_actions(file);
    file->addSeparator();
    actions_.add(file, "ask_preferences", tr("Pr&eferences…"), "Ctrl+,",
                 [this] { ask_preferences(); });
    actions_.add(file, "quit", tr("&Quit"), "Ctrl+Q", [this] { close(); });
}

void MainWindow::add_recording_actions(QMenu* menu) {
    const auto record = [this](bool on) {
        actions_.refresh();  // the switch shows the present state until a name is chosen
        if (!on) return recordings_.stop();
        const QString path = ask_save_name(this, tr("Record the session"),
                                           "session-" + time_stamp() + ".csv", "csv", false);
        if (!path.isEmpty()) recordings_.start(path);
    };
    actions_.add_switch(
        menu, "record", tr("&Record…"), "Ctrl+R", record,
        [this] { return recordings_.recording(); }, if_live());
    actions_.add(
        menu, "leave_playback", tr("Leave the recordin&g, feel again"), "Esc",
        [this] {
            if (!measuring_.cancel()) files_.leave_playback();
        },
        [this] { return playback() != nullptr; });
}

void MainWindow::make_session_menu() {
    QMenu* menu = menuBar()->addMenu(tr("&Session"));
    Effect& effect = content_.effect();
    const auto send = [&effect](const Command& command) { effect.request(command); };
    actions_.add_switch(
        menu, "forces", tr("&Forces on"), "Space", [send](bool on) { send(command::Forces{on}); },
        [&effect] { return effect.there() && effect.settings().forces_on; }, if_live());
    actions_.add_switch(
        menu, "freeze", tr("Free&ze"), "F", [send](bool on) { send(command::Freeze{on}); },
        [&effect] { return effect.there() && effect.session().frozen; }, if_live());
    actions_.add_switch(
        menu, "clutch", tr("&Clutch: the volume follows the hand"), "C",
        [send](bool on) { send(command::Clutch{on}); },
        [&effect] { return effect.there() && effect.session().clutched; }, if_live());
    actions_.add_switch(
        menu, "pointer", tr("&Mouse moves the probe"), "H",
        [this](bool on) { probe_.set_pointing(on); }, [this] { return probe_.pointing(); },
        [this] { return probe_.possible(); });
    actions_.add(
        menu, "next_hand", tr("Settings of the &next hand"), "N",
        [this] { run_.choose_next_hand(); }, [this] { return content_.hands() > 1; });
    menu->addSeparator();
    const auto raise = [&effect](double percent) {
        return [&effect, percent] {
            const double range = effect.field().volume().range();
            effect.request(command::Isovalue{effect.isovalue() + 0.01 * percent * range});
        };
    };
    const auto scale = [&effect](double factor) {
        return [&effect, factor] {
            effect.request(command::Scale{factor * effect.settings().transform.scale});
        };
    };
    actions_.add(menu, "level_up", tr("Isovalue &up by 1 %"), "+", raise(1), if_live());
    actions_.add(menu, "level_down", tr("Isovalue &down by 1 %"), "-", raise(-1), if_live());
    actions_.add(menu, "coarser", tr("Hand &larger in the volume"), "]", scale(1.1), if_live());
    actions_.add(menu, "finer", tr("Hand &smaller in the volume"), "[", scale(1 / 1.1), if_live());
    menu->addSeparator();
    add_recording_actions(menu);
}

void MainWindow::make_data_menu() {
    QMenu* menu = menuBar()->addMenu(tr("&Data"));
    const auto editable = [this] { return content_.editor() != nullptr; };
    const auto playable = [this] { return content_.player() || playback(); };
    actions_.add(
        menu, "brush_action", tr("&Brush at the probe"), "B",
        [this] {
            BrushControls& brush = panel_->brush_controls();
            brush.reason().isEmpty() ? brush.toggle() : messages_.show_done(brush.reason());
        },
        if_live());
    actions_.add(
        menu, "undo_action", tr("&Undo"), key_of(QKeySequence::Undo), [this] { editing_.undo(); },
        editable);
    actions_.add(
        menu, "redo_action", tr("&Redo"), "Ctrl+Shift+Z", [this] { editing_.redo(); }, editable);
    actions_.add(
        menu, "save_volume", tr("&Save the volume…"), "Ctrl+Shift+S",
        [this] { editing_.ask_save(); }, if_live());
    actions_.add(
        menu, "save_surface", tr("Save the surface as a &mesh…"), {},
        [this] { editing_.ask_save_surface(); }, if_live());
    actions_.add(
        menu, "open_overlay_action", tr("Open an o&verlay: labels or another image…"), {},
        [this] { overlays_.ask_open(); }, if_open());
    actions_.add(
        menu, "close_overlay_action", tr("&Close the overlay"), {}, [this] { overlays_.close(); },
        [this] { return overlays_.overlay() != nullptr; });
    actions_.add(
        menu, "choose_level", tr("&Level, channel and time…"), {},
        [this] { settle_work([this] { files_.ask_level(); }); },
        [this] {
            return live() && std::holds_alternative<run::StoreSource>(content_.source().from);
        });
    actions_.add(
        menu, "choose_grid", tr("Or&ientation and spacing…"), {},
        [this] { settle_work([this] { ask_grid(); }); },
        [this] { return live() && content_.from_file(); });
    menu->addSeparator();
    actions_.add(
        menu, "play_sequence", tr("&Play the sequence, or pause it"), "K",
        [this] { timeline_->toggle_playing(); }, playable);
    const auto step = [this](int frames) { return [this, frames] { timeline_->step(frames); }; };
    actions_.add(menu, "frame_back", tr("A frame bac&k"), ",", step(-1), playable);
    actions_.add(menu, "frame_on", tr("A frame &on"), ".", step(1), playable);
}

void MainWindow::add_camera_actions(QMenu* menu) {
    actions_.add(
        menu, "whole", tr("&Whole volume"), "R", [this] { views_->scene().show_whole(); },
        if_open());
    const auto from_hand = [this] {
        const auto now = live() ? live()->snapshot() : std::nullopt;
        if (now) display_.look_from_hand(now->session.transform);
    };
    actions_.add(menu, "from_hand", tr("From the &hand"), "0", from_hand, if_live());
    int number = 0;
    for (const std::string& name : pictures::view_names()) {
        actions_.add(menu, ("view_" + name).c_str(), view_text(name, true),
                     QString::number(++number),
                     [this, name] { views_->scene().look_from(pictures::view_named(name)); });
    }
}

void MainWindow::add_measure_actions(QMenu* view) {
    QMenu* measure = view->addMenu(tr("&Measure"));
    measure->setObjectName("measure");
    MeasureController& measuring = measuring_;
    actions_.add(
        measure, "measure_length", tr("A &length"), "M",
        [&measuring] { measuring.begin(Measure::length); }, if_open());
    actions_.add(
        measure, "measure_angle", tr("An &angle"), "Shift+M",
        [&measuring] { measuring.begin(Measure::angle); }, if_open());
    const auto measured = [&measuring] {
        return measuring.measuring() || !measuring.measurements().empty();
    };
    actions_.add(
        measure, "measure_remove_last", tr("&Remove the last"), "Shift+Backspace",
        [&measuring] { measuring.remove_last(); }, measured);
    actions_.add(
        measure, "measure_remove_all", tr("R&emove all"), {},
        [&measuring] { measuring.remove_all(); }, measured);
}

void MainWindow::add_cut_actions(QMenu* view) {
    QMenu* cut = view->addMenu(tr("Cut awa&y"));
    cut->setObjectName("cut");
    const auto add_cut = [&](const char* name, const QString& text, Cut kind, const QString& key) {
        actions_.add(
            cut, name, text, key, [this, kind] { display_.set_cut(kind); }, if_open());
    };
    add_cut("cut_nothing", tr("&Nothing"), Cut::nothing, {});
    add_cut("cut_plane", tr("By a &plane that faces you"), Cut::plane, "V");
    add_cut("cut_box", tr("To a &box"), Cut::box, "Shift+V");
}

void MainWindow::make_view_menu() {
    QMenu* view = menuBar()->addMenu(tr("&View"));
    add_camera_actions(view);
    view->addSeparator();
    Views& views = (*views_);
    actions_.add_switch(
        view, "slices", tr("&Slices beside the scene"), "X",
        [&views](bool on) { views.show_slices(on); }, [&views] { return views.slices_shown(); });
    actions_.add(
        view, "beside", tr("Scene with slices &beside it"), "F5",
        [&views] { views.arrange(Views::Arrangement::beside); }, if_open());
    actions_.add(
        view, "four", tr("Four &panes"), "F6",
        [&views] { views.arrange(Views::Arrangement::four); }, if_open());
    actions_.add(
        view, "scene_alone", tr("Scene a&lone, or all panes"), "F7",
        [&views] { views.toggle_alone(&views.scene()); }, if_open());
    actions_.add(
        view, "slice_alone", tr("A slice al&one, then the next"), "F8",
        [&views] { views.show_next_slice(); }, if_open());
    add_measure_actions(view);
    add_cut_actions(view);
    QAction* follow = actions_.add_switch(
        view, "follow", tr("&Crosshair follows the probe"), "G",
        [&views](bool on) { views.set_follow(on); }, [&views] { return views.follows(); });
    connect(&views, &Views::follow_changed, follow, &QAction::setChecked);
    auto* dock = findChild<QDockWidget*>("dock");
    dock->toggleViewAction()->setShortcut(QKeySequence("F9"));
    view->addAction(dock->toggleViewAction());
    actions_.add_switch(
        view, "full", tr("&Full screen"), "F11",
        [this](bool on) { on ? showFullScreen() : showNormal(); },
        [this] { return isFullScreen(); });
    QMenu* menu = view->addMenu(tr("&Appearance"));
    const auto add = [&](const char* name, const QString& text, Appearance appearance) {
        actions_.add(menu, name, text, {}, [appearance] { set_appearance(appearance); });
    };
    add("system", tr("As the &system"), Appearance::system);
    add("light", tr("&Light"), Appearance::light);
    add("dark", tr("&Dark"), Appearance::dark);
}

void MainWindow::make_help_menu() {
    QMenu* help = menuBar()->addMenu(tr("&Help"));
    actions_.add(help, "first_steps_action", tr("&First steps"), key_of(QKeySequence::HelpContents),
                 [this] { make_first_steps_dialog(this)->show(); });
    actions_
        .add(help, "shortcuts_action", tr("&Shortcuts"), "?",
             [this] { make_shortcuts_dialog(this)->show(); })
        ->setShortcuts({QKeySequence("?"), QKeySequence("Shift+?")});
    actions_.add(help, "about_action", tr("&About Palpate"), {},
                 [this] { make_about_dialog(this)->show(); });
}

void MainWindow::make_tool_bar() {
    QToolBar& bar = *addToolBar(tr("Tools"));
    bar.setObjectName("tools");
    const auto add = [&](const char* name, Shape shape) {
        QAction* action = actions_.find(name);
        action->setIcon(icon_of(shape));
        action->setIconVisibleInMenu(false);
        const QString key = action->shortcut().toString(QKeySequence::NativeText);
        if (!key.isEmpty()) action->setToolTip(QString("%1 (%2)").arg(action->toolTip(), key));
        bar.addAction(action);
    };
    add("open", Shape::open);
    bar.addSeparator();
    add("forces", Shape::forces);
    add("freeze", Shape::freeze);
    add("record", Shape::record);
    bar.addSeparator();
    add("pointer", Shape::touch);
    add("brush_action", Shape::brush);
    add("undo_action", Shape::undo);
    add("redo_action", Shape::redo);
    bar.addSeparator();
    for (const auto& [name, shape] : {std::pair{"measure", Shape::measure}, {"cut", Shape::cut}}) {
        auto* menu = findChild<QMenu*>(name);
        add_menu(bar, *menu, shape);
        actions_.limit(menu->menuAction(), if_open());
    }
    bar.addSeparator();
    add("whole", Shape::whole);
    add("from_hand", Shape::eye);
    auto* layout = new QMenu(tr("Layout"), this);
    layout->setObjectName("layout");
    for (const char* name : {"beside", "four", "scene_alone", "slice_alone"}) {
        layout->addAction(actions_.find(name));
    }
    add_menu(bar, *layout, Shape::layout);
    actions_.limit(layout->menuAction(), if_open());
}

void MainWindow::name_views(bool oriented) {
    for (const std::string& name : pictures::view_names()) {
        actions_.find(("view_" + name).c_str())->setText(view_text(name, oriented));
    }
}

void MainWindow::make_menus() {
    make_file_menu();
    make_session_menu();
    make_data_menu();
    make_view_menu();
    make_help_menu();
    make_tool_bar();
    for (const char* name :
         {"level_up", "level_down", "undo_action", "redo_action", "frame_back", "frame_on"}) {
        actions_.find(name)->setAutoRepeat(true);
    }
    actions_.refresh();
}

}  // namespace palpate::viewer
