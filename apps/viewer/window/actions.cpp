// Makes actions and keeps them up to date.
#include "apps/viewer/window/actions.hpp"

#include <QAction>
#include <QMenu>
#include <utility>

#include "apps/viewer/window/messages.hpp"

namespace palpate::viewer {

QAction* Actions::add_switch(QMenu* menu, const char* name, const QString& text,
                             const QKeySequence& key, std::function<void(bool)> action,
                             Condition on, Condition possible) {
    auto* entry = new QAction(text, window_);
    entry->setObjectName(name);
    entry->setShortcut(key);
    entry->setAutoRepeat(false);
    entry->setCheckable(on != nullptr);
    connect(entry, &QAction::triggered, this, [this, action = std::move(action)](bool checked) {
        messages_.guarded([&] { action(checked); });
    });
    menu->addAction(entry);
    entries_.push_back({entry, std::move(on), std::move(possible)});
    return entry;
}

QAction* Actions::add(QMenu* menu, const char* name, const QString& text, const QKeySequence& key,
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

}  // namespace palpate::viewer
