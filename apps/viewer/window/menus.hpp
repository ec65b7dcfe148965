// The window's menus and tool bar.
#pragma once

namespace palpate::viewer {

class Actions;
class MainWindow;

/// Makes menus and tool bar of `window`; each action calls a controller.
void make_menus(MainWindow& window, Actions& actions);
/// Views from the sides of the body, or from the ends of the grid's axes where those are not known.
void name_views(Actions& actions, bool oriented);

}  // namespace palpate::viewer
