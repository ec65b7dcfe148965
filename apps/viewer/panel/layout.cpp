// Builds rows and columns.
#include "apps/viewer/panel/layout.hpp"

#include <QAbstractButton>
#include <QHBoxLayout>
#include <QKeyEvent>
#include <QVBoxLayout>

namespace palpate::viewer {
namespace {

class ReturnPresses : public QObject {
  public:
    using QObject::QObject;
    bool eventFilter(QObject* watched, QEvent* event) override {
        if (event->type() != QEvent::KeyPress) return false;
        const int key = static_cast<QKeyEvent*>(event)->key();
        if (key != Qt::Key_Return && key != Qt::Key_Enter) return false;
        static_cast<QAbstractButton*>(watched)->click();
        return true;
    }
};

QBoxLayout* filled(QBoxLayout* layout, std::initializer_list<QWidget*> widgets) {
    layout->setContentsMargins(0, 0, 0, 0);
    for (QWidget* widget : widgets) layout->addWidget(widget);
    return layout;
}

}  // namespace

QBoxLayout* row_in(QWidget* owner, std::initializer_list<QWidget*> widgets) {
    return filled(new QHBoxLayout(owner), widgets);
}

QBoxLayout* column_in(QWidget* owner, std::initializer_list<QWidget*> widgets) {
    return filled(new QVBoxLayout(owner), widgets);
}

QWidget* row_of(std::initializer_list<QWidget*> widgets, int wide) {
    auto* row = new QWidget;
    QBoxLayout* layout = row_in(row, widgets);
    if (wide >= 0) layout->setStretch(wide, 1);
    return row;
}

QWidget* column_of(std::initializer_list<QWidget*> widgets) {
    auto* column = new QWidget;
    column_in(column, widgets);
    return column;
}

void add_row(QFormLayout& form, const QString& label, QWidget* field, const QString& tip) {
    field->setToolTip(tip);
    form.addRow(label, field);  // makes the field the label's buddy
    form.labelForField(field)->setToolTip(tip);
}

void make_bold(QWidget& widget, bool bold) {
    QFont font = widget.font();
    font.setBold(bold);
    widget.setFont(font);
}

void let_return_press_buttons(QWidget& parent) {
    auto* presses = new ReturnPresses(&parent);
    for (auto* button : parent.findChildren<QAbstractButton*>())
        button->installEventFilter(presses);
}

}  // namespace palpate::viewer
