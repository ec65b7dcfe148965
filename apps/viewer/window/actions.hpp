// Actions of menus and shortcuts: each says itself when it is possible and whether it is on.
#pragma once

#include <QKeySequence>
#include <QObject>
#include <QString>
#include <functional>
#include <vector>

class QAction;
class QMenu;
class QWidget;

namespace palpate::viewer {

class Messages;

class Actions : public QObject {
    Q_OBJECT

  public:
    using Condition = std::function<bool()>;

    /// Actions are children of `window`. What they throw is shown.
    Actions(QWidget* window, Messages& messages) : window_(window), messages_(messages) {}

    /// `name` is the action's object name. Always possible without a condition.
    QAction* add(QMenu* menu, const char* name, const QString& text, const QKeySequence& key,
                 std::function<void()> action, Condition possible = {});
    /// The same; a key that is held repeats it.
    void add_repeating(QMenu* menu, const char* name, const QString& text, const QKeySequence& key,
                       std::function<void()> action, Condition possible = {});
    /// A switch: `action` gets the state that it is switched to.
    QAction* add_switch(QMenu* menu, const char* name, const QString& text, const QKeySequence& key,
                        std::function<void(bool)> action, Condition on, Condition possible = {});
    QAction* find(const char* name) const;

    /// Brings all actions to what is possible and on now.
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
