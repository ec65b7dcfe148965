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

#include "apps/viewer/panel/colours.hpp"
#include "apps/viewer/panel/timeline.hpp"
#include "apps/viewer/scene/scene.hpp"
#include "apps/viewer/window/brush_controls.hpp"
#include "apps/viewer/window/device_controls.hpp"
#include "apps/viewer/window/file_dialogs.hpp"
#include "apps/viewer/window/look_controls.hpp"
#include "apps/viewer/window/main_window.hpp"
#include "apps/viewer/window/messages.hpp"
#include "apps/viewer/window/overlay_controls.hpp"
#include "apps/viewer/window/panel.hpp"
#include "apps/viewer/window/preferences.hpp"
#include "apps/viewer/window/views.hpp"
#include "apps/viewer/window/welcome.hpp"

namespace palpate::viewer {

void Actions::add(QMenu* menu, const std::vector<ActionRow>& rows) {
    for (const ActionRow& row : rows) {
        if (!row.name) {
            menu->addSeparator();
            continue;
        }
        auto* entry = new QAction(row.text, window_);
        entry->setObjectName(row.name);
        entry->setShortcut(row.key);
        entry->setAutoRepeat(false);
        entry->setCheckable(row.on != nullptr);
        connect(entry, &QAction::triggered, this,
                [this, act = row.act](bool checked) { messages_.guarded([&] { act(checked); }); });
        menu->addAction(entry);
        entries_.push_back({entry, row.on, row.possible});
    }
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

const ActionRow separator;
const ActionRow::Condition always;

/// A menu in another, under this name.
QMenu* submenu(QMenu& menu, const char* name, const QString& text) {
    QMenu* sub = menu.addMenu(text);
    sub->setObjectName(name);
    return sub;
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

void MainWindow::fill_recent(QMenu& menu) {
    menu.clear();
    for (const QString& path : recent_files()) {
        connect(menu.addAction(on_button(path)), &QAction::triggered, this,
                [this, path] { files_.settle_work([this, path] { files_.open_path(path); }); });
    }
    if (menu.isEmpty()) menu.addAction(tr("nothing yet"))->setEnabled(false);
}

void MainWindow::make_file_menu() {
    QMenu* menu = menuBar()->addMenu(tr("&File"));
    const auto settled = [this](auto action) {
        return [this, action] { files_.settle_work(action); };
    };
    const auto open = [this, settled](auto ask, auto then) {
        return settled([this, ask, then] {
            if (const QString path = ask(this); !path.isEmpty()) then(path);
        });
    };
    const auto by_name = [this](const QString& path) { files_.open_path(path); };
    const auto raw = [this](const QString& path) {
        files_.ask_layout(run::source_named(path.toStdString()));
    };
    const auto picture = [this](bool whole_window) {
        const QString path =
            ask_save_name(this, tr("Save a picture"), "palpate-" + time_stamp() + ".png", "png",
                          tr("Pictures (*.png)"));
        if (!path.isEmpty()) save_picture(path, whole_window);
    };
    actions_.add(menu,
                 {{"open", tr("&Open…"), QKeySequence::Open, open(ask_open_anything, by_name)},
                  {"open_folder", tr("Open a &folder (DICOM, TIFF, Zarr)…"), "Ctrl+Shift+O",
                   open(ask_open_folder, by_name)},
                  {"open_raw", tr("Open raw &data…"), "", open(ask_open_raw_name, raw)},
                  {"open_address", tr("Open a&n address…"), "Ctrl+L",
                   settled([this] { files_.ask_address(); })}});
    QMenu* recent = submenu(*menu, "recent", tr("Open &recent"));
    connect(recent, &QMenu::aboutToShow, this, [this, recent] { fill_recent(*recent); });
    actions_.add(menu,
                 {separator,
                  {"save_session", tr("&Save the session"), QKeySequence::Save,
                   [this] { files_.ask_save_session(content_.session()); }, if_open_},
                  {"save_session_as", tr("Save the session &as…"), "",
                   [this] { files_.ask_save_session({}); }, if_open_},
                  {"picture", tr("&Picture of the scene…"), "Ctrl+P", [picture] { picture(false); },
                   if_open_},
                  {"window_picture", tr("Picture of the &window…"), "Ctrl+Shift+P",
                   [picture] { picture(true); }},
                  separator,
                  {"ask_preferences", tr("Pr&eferences…"), "Ctrl+,", [this] { ask_preferences(); }},
                  {"quit", tr("&Quit"), "Ctrl+Q", [this] { close(); }}});
}

void MainWindow::record(bool on) {
    actions_.refresh();  // the switch shows the present state until a name is chosen
    if (!on) return recordings_.stop();
    const QString path =
        ask_save_name(this, tr("Record the session"), "session-" + time_stamp() + ".csv", "csv",
                      tr("Recordings (*.csv)"), false);
    if (!path.isEmpty()) recordings_.start(path);
}

void MainWindow::make_session_menu() {
    QMenu* menu = menuBar()->addMenu(tr("&Session"));
    Effect& effect = content_.effect();
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
    actions_.add(
        menu,
        {{"forces", tr("&Forces on"), "Space",
          [&effect](bool on) { effect.request(command::Forces{on}); }, if_live_,
          [&effect] { return effect.there() && effect.settings().forces_on; }},
         {"freeze", tr("Free&ze"), "F", [&effect](bool on) { effect.request(command::Freeze{on}); },
          if_live_, [&effect] { return effect.there() && effect.session().frozen; }},
         {"clutch", tr("&Clutch: the volume follows the hand"), "C",
          [&effect](bool on) { effect.request(command::Clutch{on}); }, if_live_,
          [&effect] { return effect.there() && effect.session().clutched; }},
         {"pointer", tr("&Mouse moves the probe"), "H",
          [this](bool on) { probe_.set_pointing(on); }, [this] { return probe_.possible(); },
          [this] { return probe_.pointing(); }},
         {"next_hand", tr("Settings of the &next hand"), "N",
          [this] { panel_->hand_switch().choose_next(); }, [this] { return content_.hands() > 1; }},
         separator,
         {"level_up", tr("Isovalue &up by 1 %"), "+", raise(1), if_live_},
         {"level_down", tr("Isovalue &down by 1 %"), "-", raise(-1), if_live_},
         {"coarser", tr("Hand &larger in the volume"), "]", scale(1.1), if_live_},
         {"finer", tr("Hand &smaller in the volume"), "[", scale(1 / 1.1), if_live_},
         separator,
         {"record", tr("&Record…"), "Ctrl+R", [this](bool on) { record(on); }, if_live_,
          [this] { return recordings_.recording(); }},
         {"leave_playback", tr("Leave the recordin&g, feel again"), "Esc",
          [this] {
              if (!measuring_.cancel()) files_.leave_playback();
          },
          [this] { return playback() != nullptr; }}});
}

void MainWindow::make_data_menu() {
    QMenu* menu = menuBar()->addMenu(tr("&Data"));
    BrushControls& brush = panel_->brush_controls();
    OverlayControls& overlays = panel_->overlay_controls();
    const auto playable = [this] { return content_.player() || playback(); };
    const auto is_store = [this] {
        return live() && std::holds_alternative<run::StoreSource>(content_.source().from);
    };
    actions_.add(
        menu, {{"brush_action", tr("&Brush at the probe"), "B",
                [this, &brush](bool) {
                    brush.toggle();
                    actions_.refresh();
                },
                if_live_, [&brush] { return brush.choice().on; }},
               {"undo_action", tr("&Undo"), QKeySequence::Undo, [&brush] { brush.undo(); },
                [&brush] { return brush.history().undo_steps > 0; }},
               {"redo_action", tr("&Redo"), "Ctrl+Shift+Z", [&brush] { brush.redo(); },
                [&brush] { return brush.history().redo_steps > 0; }},
               {"save_volume", tr("&Save the volume…"), "Ctrl+Shift+S",
                [this] { saver_.ask_save(); }, if_live_},
               {"save_surface", tr("Save the surface as a &mesh…"), "",
                [this] { saver_.ask_save_surface(); }, if_live_},
               {"open_overlay_action", tr("Open an o&verlay: labels or another image…"), "",
                [&overlays] { overlays.ask_open(); }, if_open_},
               {"close_overlay_action", tr("&Close the overlay"), "",
                [&overlays] { overlays.close_overlay(); },
                [&overlays] { return overlays.overlay() != nullptr; }},
               {"choose_level", tr("&Level, channel and time…"), "",
                [this] { files_.settle_work([this] { files_.ask_level(); }); }, is_store},
               {"choose_grid", tr("Or&ientation and spacing…"), "",
                [this] { files_.settle_work([this] { files_.ask_grid(); }); },
                [this] { return live() && content_.from_file(); }},
               separator,
               {"play_sequence", tr("&Play the sequence, or pause it"), "K",
                [this] { timeline_->toggle_playing(); }, playable},
               {"frame_back", tr("A frame bac&k"), ",", [this] { timeline_->step(-1); }, playable},
               {"frame_on", tr("A frame &on"), ".", [this] { timeline_->step(1); }, playable}});
}

void MainWindow::make_measure_and_cut_menus(QMenu& view) {
    const auto measured = [this] {
        return measuring_.measuring() || !measuring_.measurements().empty();
    };
    actions_.add(submenu(view, "measure", tr("&Measure")),
                 {{"measure_length", tr("A &length"), "M",
                   [this] { measuring_.begin(Measure::length); }, if_open_},
                  {"measure_angle", tr("An &angle"), "Shift+M",
                   [this] { measuring_.begin(Measure::angle); }, if_open_},
                  {"measure_remove_last", tr("&Remove the last"), "Shift+Backspace",
                   [this] { measuring_.remove_last(); }, measured},
                  {"measure_remove_all", tr("R&emove all"), "", [this] { measuring_.remove_all(); },
                   measured}});
    LookControls& look = panel_->look_controls();
    const auto cut = [this, &look](Cut kind) {
        return [this, &look, kind](bool on) {
            look.set_cut(on ? kind : Cut::nothing);
            actions_.refresh();
        };
    };
    const auto is_cut = [&look](Cut kind) {
        return [&look, kind] { return look.look().cut == kind; };
    };
    actions_.add(
        submenu(view, "cut", tr("Cut awa&y")),
        {{"cut_nothing", tr("&Nothing"), "", cut(Cut::nothing), if_open_, is_cut(Cut::nothing)},
         {"cut_plane", tr("By a &plane that faces you"), "V", cut(Cut::plane), if_open_,
          is_cut(Cut::plane)},
         {"cut_box", tr("To a &box"), "Shift+V", cut(Cut::box), if_open_, is_cut(Cut::box)}});
}

void MainWindow::make_view_menu() {
    QMenu* menu = menuBar()->addMenu(tr("&View"));
    Views& views = *views_;
    std::vector<ActionRow> rows{
        {"whole", tr("&Whole volume"), "R", [&views] { views.scene().show_whole(); }, if_open_},
        {"from_hand", tr("From the &hand"), "0", [this] { display_.look_from_hand(); }, if_live_}};
    const auto& names = pictures::view_names();
    std::vector<std::string> view_actions;
    for (const std::string& name : names) view_actions.push_back("view_" + name);
    for (std::size_t i = 0; i < names.size(); ++i) {
        const auto look = [&views, name = names[i]] {
            views.scene().look_from(pictures::view_named(name));
        };
        rows.push_back(
            {view_actions[i].c_str(), view_text(names[i], true), QString::number(i + 1), look});
    }
    actions_.add(menu, rows);
    actions_.add(menu, {separator,
                        {"slices", tr("&Slices beside the scene"), "X",
                         [&views](bool on) { views.show_slices(on); }, always,
                         [&views] { return views.slices_shown(); }},
                        {"beside", tr("Scene with slices &beside it"), "F5",
                         [&views] { views.arrange(Views::Arrangement::beside); }, if_open_},
                        {"four", tr("Four &panes"), "F6",
                         [&views] { views.arrange(Views::Arrangement::four); }, if_open_},
                        {"scene_alone", tr("Scene a&lone, or all panes"), "F7",
                         [&views] { views.toggle_alone(&views.scene()); }, if_open_},
                        {"slice_alone", tr("A slice al&one, then the next"), "F8",
                         [&views] { views.show_next_slice(); }, if_open_}});
    make_measure_and_cut_menus(*menu);
    actions_.add(menu, {{"follow", tr("&Crosshair follows the probe"), "G",
                         [&views](bool on) { views.set_follow(on); }, always,
                         [&views] { return views.follows(); }}});
    auto* dock = findChild<QDockWidget*>("dock");
    dock->toggleViewAction()->setShortcut(QKeySequence("F9"));
    menu->addAction(dock->toggleViewAction());
    actions_.add(menu, {{"full", tr("&Full screen"), "F11",
                         [this](bool on) { on ? showFullScreen() : showNormal(); }, always,
                         [this] { return isFullScreen(); }}});
    const auto dress = [](Appearance as) { return [as] { set_appearance(as); }; };
    actions_.add(menu->addMenu(tr("&Appearance")),
                 {{"system", tr("As the &system"), "", dress(Appearance::system)},
                  {"light", tr("&Light"), "", dress(Appearance::light)},
                  {"dark", tr("&Dark"), "", dress(Appearance::dark)}});
}

void MainWindow::make_help_menu() {
    const auto show = [this](auto make) { return [this, make] { make(this)->show(); }; };
    actions_.add(menuBar()->addMenu(tr("&Help")),
                 {{"first_steps_action", tr("&First steps"), QKeySequence::HelpContents,
                   show(make_first_steps_dialog)},
                  {"shortcuts_action", tr("&Shortcuts"), "?", show(make_shortcuts_dialog)},
                  {"about_action", tr("&About Palpate"), "", show(make_about_dialog)}});
    actions_.find("shortcuts_action")->setShortcuts({QKeySequence("?"), QKeySequence("Shift+?")});
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
        actions_.limit(menu->menuAction(), if_open_);
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
    actions_.limit(layout->menuAction(), if_open_);
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
