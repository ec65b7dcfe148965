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

#include "apps/viewer/panel/brush_controls.hpp"
#include "apps/viewer/panel/icons.hpp"
#include "apps/viewer/panel/panel.hpp"
#include "apps/viewer/panel/timeline.hpp"
#include "apps/viewer/scene/scene.hpp"
#include "apps/viewer/window/actions.hpp"
#include "apps/viewer/window/appearance.hpp"
#include "apps/viewer/window/file_dialogs.hpp"
#include "apps/viewer/window/help.hpp"
#include "apps/viewer/window/main_window.hpp"
#include "apps/viewer/window/views.hpp"

namespace palpate::viewer {
namespace {

void fill_recent(QMenu& menu, MainWindow& window) {
    menu.clear();
    for (const QString& path : recent_files()) {
        QObject::connect(menu.addAction(path), &QAction::triggered, &window, [&window, path] {
            window.settle_work([&window, path] { window.files().open_path(path); });
        });
    }
    if (menu.isEmpty()) menu.addAction(MainWindow::tr("nothing yet"))->setEnabled(false);
}

void add_open_actions(MainWindow& window, Actions& actions, QMenu* menu) {
    const auto open = [&window](auto ask) {
        return [&window, ask] {
            window.settle_work([&window, ask] {
                const QString path = ask(&window);
                if (!path.isEmpty()) window.files().open_path(path);
            });
        };
    };
    actions.add(menu, "open", MainWindow::tr("&Open…"), QKeySequence::Open, open(ask_open_name));
    actions.add(menu, "open_folder", MainWindow::tr("Open a &folder (DICOM, TIFF, Zarr)…"),
                QKeySequence("Ctrl+Shift+O"), open(ask_open_folder));
    actions.add(menu, "open_raw", MainWindow::tr("Open raw &data…"), {}, [&window] {
        window.settle_work([&window] {
            const QString path = ask_open_raw_name(&window);
            if (!path.isEmpty()) window.files().ask_layout(run::source_named(path.toStdString()));
        });
    });
    actions.add(menu, "open_address", MainWindow::tr("Open a&n address…"), QKeySequence("Ctrl+L"),
                [&window] { window.settle_work([&window] { window.files().ask_address(); }); });
    QMenu* recent = menu->addMenu(MainWindow::tr("Open &recent"));
    recent->setObjectName("recent");
    QObject::connect(recent, &QMenu::aboutToShow, &window,
                     [&window, recent] { fill_recent(*recent, window); });
}

void add_save_actions(MainWindow& window, Actions& actions, QMenu* menu) {
    const auto opened = [&window] { return window.content().volume() != nullptr; };
    actions.add(
        menu, "save_session", MainWindow::tr("&Save the session"), QKeySequence::Save,
        [&window] { window.save_session(window.content().session()); }, opened);
    actions.add(
        menu, "save_session_as", MainWindow::tr("Save the session &as…"), {},
        [&window] { window.save_session({}); }, opened);
    const auto picture = [&window](bool whole_window) {
        const QString path = ask_save_name(&window, MainWindow::tr("Save a picture"),
                                           "palpate-" + time_stamp() + ".png", "png");
        if (!path.isEmpty()) window.save_picture(path, whole_window);
    };
    actions.add(
        menu, "picture", MainWindow::tr("&Picture of the scene…"), QKeySequence("Ctrl+P"),
        [picture] { picture(false); }, opened);
    actions.add(menu, "window_picture", MainWindow::tr("Picture of the &window…"),
                QKeySequence("Ctrl+Shift+P"), [picture] { picture(true); });
}

void make_file_menu(MainWindow& window, Actions& actions) {
    QMenu* file = window.menuBar()->addMenu(MainWindow::tr("&File"));
    add_open_actions(window, actions, file);
    file->addSeparator();
    add_save_actions(window, actions, file);
    file->addSeparator();
    actions.add(file, "ask_preferences", MainWindow::tr("Pr&eferences…"), QKeySequence("Ctrl+,"),
                [&window] { window.ask_preferences(); });
    actions.add(file, "quit", MainWindow::tr("&Quit"), QKeySequence("Ctrl+Q"),
                [&window] { window.close(); });
}

void add_recording_actions(MainWindow& window, Actions& actions, QMenu* menu) {
    const auto record = [&window, &actions](bool on) {
        actions.refresh();  // the switch shows the present state until a name is chosen
        if (!on) return window.recordings().stop();
        const QString path = ask_save_name(&window, MainWindow::tr("Record the session"),
                                           "session-" + time_stamp() + ".csv", "csv", false);
        if (!path.isEmpty()) window.recordings().start(path);
    };
    actions.add_switch(
        menu, "record", MainWindow::tr("&Record…"), QKeySequence("Ctrl+R"), record,
        [&window] { return window.recordings().recording(); },
        [&window] { return window.live() != nullptr; });
    actions.add(
        menu, "leave_playback", MainWindow::tr("Leave the recordin&g, feel again"),
        QKeySequence("Esc"),
        [&window] {
            if (!window.measuring().cancel()) window.files().leave_playback();
        },
        [&window] { return window.playback() != nullptr; });
}

void make_session_menu(MainWindow& window, Actions& actions) {
    QMenu* menu = window.menuBar()->addMenu(MainWindow::tr("&Session"));
    const auto live = [&window] { return window.live() != nullptr; };
    Effect& effect = window.content().effect();
    const auto send = [&effect](const Command& command) { effect.request(command); };
    actions.add_switch(
        menu, "forces", MainWindow::tr("&Forces on"), QKeySequence(Qt::Key_Space),
        [send](bool on) { send(command::Forces{on}); },
        [&effect] { return effect.there() && effect.settings().forces_on; }, live);
    actions.add_switch(
        menu, "freeze", MainWindow::tr("Free&ze"), QKeySequence("F"),
        [send](bool on) { send(command::Freeze{on}); },
        [&effect] { return effect.there() && effect.session().frozen; }, live);
    actions.add_switch(
        menu, "clutch", MainWindow::tr("&Clutch: the volume follows the hand"), QKeySequence("C"),
        [send](bool on) { send(command::Clutch{on}); },
        [&effect] { return effect.there() && effect.session().clutched; }, live);
    actions.add_switch(
        menu, "pointer", MainWindow::tr("&Mouse moves the probe"), QKeySequence("H"),
        [&window](bool on) { window.probe().set_pointing(on); },
        [&window] { return window.probe().pointing(); },
        [&window] { return window.probe().possible(); });
    actions.add(
        menu, "next_hand", MainWindow::tr("Settings of the &next hand"), QKeySequence("N"),
        [&window] { window.run().choose_next_hand(); },
        [&window] { return window.content().hands() > 1; });
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
    actions.add(menu, "level_up", MainWindow::tr("Isovalue &up by 1 %"), QKeySequence("+"),
                raise(1), live);
    actions.add(menu, "level_down", MainWindow::tr("Isovalue &down by 1 %"), QKeySequence("-"),
                raise(-1), live);
    actions.add(menu, "coarser", MainWindow::tr("Hand &larger in the volume"), QKeySequence("]"),
                scale(1.1), live);
    actions.add(menu, "finer", MainWindow::tr("Hand &smaller in the volume"), QKeySequence("["),
                scale(1 / 1.1), live);
    menu->addSeparator();
    add_recording_actions(window, actions, menu);
}

void make_data_menu(MainWindow& window, Actions& actions) {
    QMenu* menu = window.menuBar()->addMenu(MainWindow::tr("&Data"));
    const auto editable = [&window] { return window.content().editor() != nullptr; };
    const auto playable = [&window] { return window.content().player() || window.playback(); };
    actions.add(
        menu, "brush_action", MainWindow::tr("&Brush at the probe"), QKeySequence("B"),
        [&window] {
            BrushControls& brush = window.panel().brush_controls();
            brush.reason().isEmpty() ? brush.toggle() : window.messages().show_done(brush.reason());
        },
        [&window] { return window.live() != nullptr; });
    actions.add(
        menu, "undo_action", MainWindow::tr("&Undo"), QKeySequence::Undo,
        [&window] { window.editing().undo(); }, editable);
    actions.add(
        menu, "redo_action", MainWindow::tr("&Redo"), QKeySequence("Ctrl+Shift+Z"),
        [&window] { window.editing().redo(); }, editable);
    actions.add(
        menu, "save_volume", MainWindow::tr("&Save the volume…"), QKeySequence("Ctrl+Shift+S"),
        [&window] { window.editing().ask_save(); }, [&window] { return window.live() != nullptr; });
    actions.add(
        menu, "save_surface", MainWindow::tr("Save the surface as a &mesh…"), {},
        [&window] { window.editing().ask_save_surface(); },
        [&window] { return window.live() != nullptr; });
    actions.add(
        menu, "open_overlay_action", MainWindow::tr("Open an o&verlay: labels or another image…"),
        {}, [&window] { window.overlays().ask_open(); },
        [&window] { return window.content().volume() != nullptr; });
    actions.add(
        menu, "close_overlay_action", MainWindow::tr("&Close the overlay"), {},
        [&window] { window.overlays().close(); },
        [&window] { return window.overlays().overlay() != nullptr; });
    actions.add(
        menu, "choose_level", MainWindow::tr("&Level, channel and time…"), {},
        [&window] { window.settle_work([&window] { window.files().ask_level(); }); },
        [&window] {
            return window.live() &&
                   std::holds_alternative<run::StoreSource>(window.content().source().from);
        });
    actions.add(
        menu, "choose_grid", MainWindow::tr("Or&ientation and spacing…"), {},
        [&window] { window.settle_work([&window] { window.ask_grid(); }); },
        [&window] { return window.live() && window.content().from_file(); });
    menu->addSeparator();
    actions.add(
        menu, "play_sequence", MainWindow::tr("&Play the sequence, or pause it"), QKeySequence("K"),
        [&window] { window.timeline().toggle_playing(); }, playable);
    const auto step = [&window](int frames) {
        return [&window, frames] { window.timeline().step(frames); };
    };
    actions.add(menu, "frame_back", MainWindow::tr("A frame bac&k"), QKeySequence(","), step(-1),
                playable);
    actions.add(menu, "frame_on", MainWindow::tr("A frame &on"), QKeySequence("."), step(1),
                playable);
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

void add_camera_actions(MainWindow& window, Actions& actions, QMenu* menu) {
    actions.add(
        menu, "whole", MainWindow::tr("&Whole volume"), QKeySequence("R"),
        [&window] { window.views().scene().show_whole(); },
        [&window] { return window.content().volume() != nullptr; });
    const auto from_hand = [&window] {
        const auto now = window.live() ? window.live()->snapshot() : std::nullopt;
        if (now) window.display().look_from_hand(now->session.transform);
    };
    actions.add(menu, "from_hand", MainWindow::tr("From the &hand"), QKeySequence("0"), from_hand,
                [&window] { return window.live() != nullptr; });
    int number = 0;
    for (const std::string& name : pictures::view_names()) {
        actions.add(menu, ("view_" + name).c_str(), view_text(name, true),
                    QKeySequence(QString::number(++number)), [&window, name] {
                        window.views().scene().look_from(pictures::view_named(name));
                    });
    }
}

void add_measure_actions(MainWindow& window, Actions& actions, QMenu* view) {
    const auto opened = [&window] { return window.content().volume() != nullptr; };
    QMenu* measure = view->addMenu(MainWindow::tr("&Measure"));
    measure->setObjectName("measure");
    MeasureController& measuring = window.measuring();
    actions.add(
        measure, "measure_length", MainWindow::tr("A &length"), QKeySequence("M"),
        [&measuring] { measuring.begin(Measure::length); }, opened);
    actions.add(
        measure, "measure_angle", MainWindow::tr("An &angle"), QKeySequence("Shift+M"),
        [&measuring] { measuring.begin(Measure::angle); }, opened);
    const auto measured = [&measuring] {
        return measuring.measuring() || !measuring.measurements().empty();
    };
    actions.add(
        measure, "measure_remove_last", MainWindow::tr("&Remove the last"),
        QKeySequence("Shift+Backspace"), [&measuring] { measuring.remove_last(); }, measured);
    actions.add(
        measure, "measure_remove_all", MainWindow::tr("R&emove all"), {},
        [&measuring] { measuring.remove_all(); }, measured);
}

void add_cut_actions(MainWindow& window, Actions& actions, QMenu* view) {
    const auto opened = [&window] { return window.content().volume() != nullptr; };
    QMenu* cut = view->addMenu(MainWindow::tr("Cut awa&y"));
    cut->setObjectName("cut");
    const auto add_cut = [&](const char* name, const QString& text, Cut kind,
                             const QKeySequence& key) {
        actions.add(
            cut, name, text, key, [&window, kind] { window.display().set_cut(kind); }, opened);
    };
    add_cut("cut_nothing", MainWindow::tr("&Nothing"), Cut::nothing, {});
    add_cut("cut_plane", MainWindow::tr("By a &plane that faces you"), Cut::plane,
            QKeySequence("V"));
    add_cut("cut_box", MainWindow::tr("To a &box"), Cut::box, QKeySequence("Shift+V"));
}

void make_view_menu(MainWindow& window, Actions& actions) {
    QMenu* view = window.menuBar()->addMenu(MainWindow::tr("&View"));
    add_camera_actions(window, actions, view);
    view->addSeparator();
    Views& views = window.views();
    actions.add_switch(
        view, "slices", MainWindow::tr("&Slices beside the scene"), QKeySequence("X"),
        [&views](bool on) { views.show_slices(on); }, [&views] { return views.slices_shown(); });
    const auto opened = [&window] { return window.content().volume() != nullptr; };
    actions.add(
        view, "beside", MainWindow::tr("Scene with slices &beside it"), QKeySequence("F5"),
        [&views] { views.arrange(Views::Arrangement::beside); }, opened);
    actions.add(
        view, "four", MainWindow::tr("Four &panes"), QKeySequence("F6"),
        [&views] { views.arrange(Views::Arrangement::four); }, opened);
    actions.add(
        view, "scene_alone", MainWindow::tr("Scene a&lone, or all panes"), QKeySequence("F7"),
        [&views] { views.toggle_alone(&views.scene()); }, opened);
    actions.add(
        view, "slice_alone", MainWindow::tr("A slice al&one, then the next"), QKeySequence("F8"),
        [&views] { views.show_next_slice(); }, opened);
    add_measure_actions(window, actions, view);
    add_cut_actions(window, actions, view);
    QAction* follow = actions.add_switch(
        view, "follow", MainWindow::tr("&Crosshair follows the probe"), QKeySequence("G"),
        [&views](bool on) { views.set_follow(on); }, [&views] { return views.follows(); });
    QObject::connect(&views, &Views::follow_changed, follow, &QAction::setChecked);
    auto* dock = window.findChild<QDockWidget*>("dock");
    dock->toggleViewAction()->setShortcut(QKeySequence("F9"));
    view->addAction(dock->toggleViewAction());
    actions.add_switch(
        view, "full", MainWindow::tr("&Full screen"), QKeySequence("F11"),
        [&window](bool on) { on ? window.showFullScreen() : window.showNormal(); },
        [&window] { return window.isFullScreen(); });
    QMenu* menu = view->addMenu(MainWindow::tr("&Appearance"));
    const auto add = [&](const char* name, const QString& text, Appearance appearance) {
        actions.add(menu, name, text, {}, [appearance] { set_appearance(appearance); });
    };
    add("system", MainWindow::tr("As the &system"), Appearance::system);
    add("light", MainWindow::tr("&Light"), Appearance::light);
    add("dark", MainWindow::tr("&Dark"), Appearance::dark);
}

void make_help_menu(MainWindow& window, Actions& actions) {
    QMenu* help = window.menuBar()->addMenu(MainWindow::tr("&Help"));
    actions.add(help, "first_steps_action", MainWindow::tr("&First steps"),
                QKeySequence::HelpContents,
                [&window] { make_first_steps_dialog(&window)->show(); });
    actions
        .add(help, "shortcuts_action", MainWindow::tr("&Shortcuts"), QKeySequence("?"),
             [&window] { make_shortcuts_dialog(&window)->show(); })
        ->setShortcuts({QKeySequence("?"), QKeySequence("Shift+?")});
    actions.add(help, "about_action", MainWindow::tr("&About Palpate"), {},
                [&window] { make_about_dialog(&window)->show(); });
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

void make_tool_bar(MainWindow& window, Actions& actions) {
    QToolBar& bar = *window.addToolBar(MainWindow::tr("Tools"));
    bar.setObjectName("tools");
    const auto add = [&](const char* name, Shape shape) {
        QAction* action = actions.find(name);
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
    add_menu(bar, *window.findChild<QMenu*>("measure"), Shape::measure);
    add_menu(bar, *window.findChild<QMenu*>("cut"), Shape::cut);
    bar.addSeparator();
    add("whole", Shape::whole);
    add("from_hand", Shape::eye);
    auto* layout = new QMenu(MainWindow::tr("Layout"), &window);
    for (const char* name : {"beside", "four", "scene_alone", "slice_alone"}) {
        layout->addAction(actions.find(name));
    }
    add_menu(bar, *layout, Shape::layout);
}

}  // namespace

void name_views(Actions& actions, bool oriented) {
    for (const std::string& name : pictures::view_names()) {
        actions.find(("view_" + name).c_str())->setText(view_text(name, oriented));
    }
}

void make_menus(MainWindow& window, Actions& actions) {
    make_file_menu(window, actions);
    make_session_menu(window, actions);
    make_data_menu(window, actions);
    make_view_menu(window, actions);
    make_help_menu(window, actions);
    make_tool_bar(window, actions);
    for (const char* name :
         {"level_up", "level_down", "undo_action", "redo_action", "frame_back", "frame_on"}) {
        actions.find(name)->setAutoRepeat(true);
    }
    actions.refresh();
}

}  // namespace palpate::viewer
