// The window's menus and tool bar.
#pragma once

namespace palpate::viewer {

class Actions;
class MainWindow;

/// Makes menus and tool bar of `window`; each action calls a controller.
void make_menus(MainWindow& window, Actions& actions);

}  // namespace palpate::viewer
