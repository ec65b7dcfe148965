// The window's menus and tool bar: tables of actions, each with the conditions that enable and
// check it.
#pragma once

#include <QKeySequence>
#include <QObject>
#include <QString>

#include <functional>
#include <type_traits>
#include <utility>
#include <vector>

class QAction;
class QMenu;
class QWidget;

namespace palpate::viewer {

class Messages;

/// A line of a menu; one without a name is a separator.
struct ActionRow {
    struct Key : QKeySequence {
        using QKeySequence::QKeySequence;
        Key(const char* text = "") : QKeySequence(QString(text)) {}
        Key(const QString& text) : QKeySequence(text) {}
    };
    /// With or without the state that a switch is switched to.
    struct Act : std::function<void(bool)> {
        template <class Function>
        Act(Function call)
            : function([call = std::move(call)](bool switched_on) {
                  if constexpr (std::is_invocable_v<Function, bool>) {
                      call(switched_on);
                  } else {
                      call();
                  }
              }) {}
    };
    using Condition = std::function<bool()>;

    const char* name = nullptr;  ///< the action's object name
    QString text = {};
    Key key = {};
    Act act = [] {};
    Condition possible = {};  ///< always, without one
    Condition on = {};        ///< it is a switch, and on
};

class Actions : public QObject {
  public:
    /// Actions are children of `window`. What they throw is shown.
    Actions(QWidget* window, Messages& messages) : window_(window), messages_(messages) {}

    /// A key that is held triggers its action once; setAutoRepeat(true): again and again.
    void add(QMenu* menu, const std::vector<ActionRow>& rows);
    /// Also one that is not made here.
    void limit(QAction* action, ActionRow::Condition possible) {
        entries_.push_back({action, {}, std::move(possible)});
    }
    QAction* find(const char* name) const;

    /// Updates which actions are enabled and checked.
    void refresh();

  private:
    struct Entry {
        QAction* action;
        ActionRow::Condition on, possible;
    };
    QWidget* window_;
    Messages& messages_;
    std::vector<Entry> entries_;
};

}  // namespace palpate::viewer
