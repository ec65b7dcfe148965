// Builds rows, columns and sections.
#include "apps/viewer/panel/layout.hpp"

#include <QAbstractButton>
#include <QBoxLayout>
#include <QDialog>
#include <QEvent>
#include <QHBoxLayout>
#include <QKeyEvent>
#include <QPushButton>
#include <QVBoxLayout>
#include <QVariant>

#include <algorithm>
#include <cstddef>
#include <vector>

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

/// Side by side, on as many lines as the width needs.
class WrappingRow : public QHBoxLayout {
  public:
    using QHBoxLayout::QHBoxLayout;

    bool hasHeightForWidth() const override { return true; }
    int heightForWidth(int width) const override {
        if (!fits(width)) return lines({0, 0, width, 0}, false);
        return QHBoxLayout::hasHeightForWidth() ? QHBoxLayout::heightForWidth(width)
                                                : QHBoxLayout::sizeHint().height();
    }
    int minimumHeightForWidth(int width) const override { return heightForWidth(width); }
    QSize minimumSize() const override {
        QSize size(0, QHBoxLayout::minimumSize().height());
        for (const QLayoutItem* one : shown()) {
            size.setWidth(std::max(size.width(), one->minimumSize().width()));
        }
        return size;
    }
    void setGeometry(const QRect& room) override {
        QHBoxLayout::setGeometry(room);
        if (!fits(room.width())) lines(room, true);
    }

  private:
    bool fits(int width) const { return width >= QHBoxLayout::minimumSize().width(); }

    std::vector<QLayoutItem*> shown() const {
        std::vector<QLayoutItem*> all;
        for (int i = 0; i < count(); ++i) {
            if (!itemAt(i)->isEmpty()) all.push_back(itemAt(i));
        }
        return all;
    }

    /// Returns the height.
    int lines(const QRect& room, bool place) const {
        const std::vector<QLayoutItem*> all = shown();
        int top = room.top();
        for (std::size_t first = 0, end = 0; first < all.size(); first = end) {
            int used = -spacing(), height = 0;
            for (; end < all.size(); ++end) {
                const int more = spacing() + all[end]->minimumSize().width();
                if (end > first && used + more > room.width()) break;
                used += more;
            }
            // What is left goes to all alike.
            const int extra = (room.width() - used) / static_cast<int>(end - first);
            for (std::size_t i = first; i < end; ++i) {
                const int width = all[i]->minimumSize().width() + std::max(0, extra);
                height =
                    std::max(height, all[i]->hasHeightForWidth() ? all[i]->heightForWidth(width)
                                                                 : all[i]->sizeHint().height());
            }
            int left = room.left();
            for (std::size_t i = first; i < end && place; ++i) {
                const int width = all[i]->minimumSize().width() + std::max(0, extra);
                all[i]->setGeometry({left, top, width, height});
                left += width + spacing();
            }
            top += height + (end < all.size() ? spacing() : 0);
        }
        return top - room.top();
    }
};

QBoxLayout* filled(QBoxLayout* layout, std::initializer_list<QWidget*> widgets) {
    layout->setContentsMargins(0, 0, 0, 0);
    for (QWidget* widget : widgets) layout->addWidget(widget);
    return layout;
}

}  // namespace

QBoxLayout* row_in(QWidget* owner, std::initializer_list<QWidget*> widgets) {
    return filled(new WrappingRow(owner), widgets);
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

QLabel* label_for(const QString& text, QWidget* field) {
    auto* label = new QLabel(text);
    label->setBuddy(field);
    return label;
}

QFormLayout* form_in(QWidget* owner) {
    auto* form = new QFormLayout(owner);
    form->setContentsMargins(0, 0, 0, 0);
    form->setVerticalSpacing(3);
    form->setRowWrapPolicy(QFormLayout::WrapLongRows);
    return form;
}

void add_row(QFormLayout& form, const QString& label, QWidget* field, const QString& tip) {
    field->setToolTip(tip);
    form.addRow(label, field);  // makes the field the label's buddy
    form.labelForField(field)->setToolTip(tip);
}

QPushButton* fill(QDialog& dialog, QWidget* content, QDialogButtonBox::StandardButton accept) {
    auto* buttons = new QDialogButtonBox(accept | QDialogButtonBox::Cancel);
    QObject::connect(buttons, &QDialogButtonBox::accepted, &dialog, &QDialog::accept);
    QObject::connect(buttons, &QDialogButtonBox::rejected, &dialog, &QDialog::reject);
    column_in(&dialog, {content, buttons})->setContentsMargins(9, 9, 9, 9);
    return buttons->button(accept);
}

void allow(QWidget& widget, const QString& why) {
    constexpr const char* usual = "usual_tip";
    QList<QWidget*> all = widget.findChildren<QWidget*>();
    all << &widget;
    for (QWidget* one : all) {
        if (!one->property(usual).isValid()) one->setProperty(usual, one->toolTip());
        // A part without a tip shows that of the whole.
        one->setToolTip(why.isEmpty()    ? one->property(usual).toString()
                        : one == &widget ? why
                                         : QString());
    }
    widget.setEnabled(why.isEmpty());
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

Note::Note(QWidget* owner, const QString& name, Kind kind) : QLabel(owner), kind_(kind) {
    setObjectName(name);
    setTextFormat(Qt::PlainText);
    setWordWrap(true);
    setFixedSize(0, 0);
    hide();
}

void Note::say(const QString& text) {
    if (text == this->text()) return;
    setText(text);
    setVisible(!text.isEmpty());
    for (QWidget* around = parentWidget(); around; around = around->parentWidget()) {
        if (auto* section = qobject_cast<Section*>(around)) section->show_notes();
    }
}

static QString note_sign() {
    return QString::fromUtf8("  ℹ");
}

Section::Section(const QString& title, const QString& name, QWidget* content)
    : title_(title),
      heading_(named(new QToolButton, name + "_heading")),
      content_(content),
      message_(new Note(this, name + "_message", Note::Kind::warning)) {
    setObjectName(name);
    heading_->setCheckable(true);
    heading_->setAutoRaise(true);
    heading_->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
    heading_->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
    heading_->setFocusPolicy(Qt::TabFocus);
    make_bold(*heading_);
    column_in(this, {heading_, content_})->setSpacing(2);
    connect(heading_, &QToolButton::toggled, this, &Section::set_open);
    set_open(true);
    // Room for the sign of a note, so that nothing moves when one comes.
    heading_->setText(title_ + note_sign());
    heading_->setMinimumWidth(heading_->sizeHint().width());
    show_notes();
}

void Section::set_open(bool open) {
    heading_->setChecked(open);
    heading_->setArrowType(open ? Qt::DownArrow : Qt::RightArrow);
    content_->setVisible(open);
}

void Section::show_notes() {
    QStringList lines;
    for (const Note* note : findChildren<Note*>()) {
        if (!note->text().isEmpty()) lines << note->text();
    }
    heading_->setText(lines.isEmpty() ? title_ : title_ + note_sign());
    lines << tr("Fold this part away or back");
    heading_->setToolTip("<p>" + lines.join('\n').toHtmlEscaped().replace("\n", "</p><p>") +
                         "</p>");
}

void Section::say(const QString& why) {
    message_->say(why);
    if (!why.isEmpty()) set_open(true);
}

}  // namespace palpate::viewer
