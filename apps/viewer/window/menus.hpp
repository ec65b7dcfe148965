// The window's menus and tool bar: actions, each with the conditions that enable and check it.
#pragma once

#include <QKeySequence>
#include <QObject>
#include <QString>

#include <functional>
#include <utility>
#include <vector>

class QAction;
class QMenu;
class QWidget;

namespace palpate::viewer {

class Messages;

class Actions : public QObject {
  public:
    using Condition = std::function<bool()>;

    /// Actions are children of `window`. What they throw is shown.
    Actions(QWidget* window, Messages& messages) : window_(window), messages_(messages) {}

    /// `name` is the action's object name. Always possible without a condition. A key that is held
    /// triggers it once; setAutoRepeat(true) on the result: again and again.
    QAction* add(QMenu* menu, const char* name, const QString& text, const QString& key,
                 std::function<void()> action, Condition possible = {});
    /// A switch: `action` gets the state that it is switched to.
    QAction* add_switch(QMenu* menu, const char* name, const QString& text, const QString& key,
                        std::function<void(bool)> action, Condition on, Condition possible = {});
    /// Also one that is not made here.
    void limit(QAction* action, Condition possible) {
        entries_.push_back({action, {}, std::move(possible)});
    }
    QAction* find(const char* name) const;

    /// Updates which actions are enabled and checked.
    void refresh();

  private:
    struct Entry {
        QAction* action;
        Condition on, possible;
    };
    QWidget* window_;
    Messages& messages_;
    std::vector<Entry> entries_;
};

}  // namespace palpate::viewer
