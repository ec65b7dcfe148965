// Builds headings and notes of sections.
#include "apps/viewer/panel/section.hpp"

#include <QBoxLayout>
#include <QEvent>

#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/panel/level_axis.hpp"

namespace palpate::viewer {

Note::Note(const QString& name, Kind kind) : kind_(kind) {
    setObjectName(name);
    setTextFormat(Qt::PlainText);
    setWordWrap(true);
    setTextInteractionFlags(Qt::TextSelectableByMouse);
    hide();
    paint_text();
}

void Note::say(const QString& text) {
    if (text == this->text()) return;
    setText(text);
    setVisible(!text.isEmpty());
}

void Note::paint_text() {
    if (kind_ == Kind::plain) return;
    const QColor colour = is_dark(palette()) ? QColor(255, 160, 130) : QColor(170, 40, 0);
    if (palette().color(QPalette::WindowText) == colour) return;
    QPalette changed = palette();
    changed.setColor(QPalette::WindowText, colour);
    setPalette(changed);
}

void Note::changeEvent(QEvent* event) {
    if (event->type() == QEvent::PaletteChange) paint_text();
    QLabel::changeEvent(event);
}

Section::Section(const QString& title, const QString& name, QWidget* content)
    : heading_(named(new QToolButton, name + "_heading", tr("Fold this part away or back"))),
      content_(content),
      message_(new Note(name + "_message", Note::Kind::warning)) {
    setObjectName(name);
    heading_->setText(title);
    heading_->setCheckable(true);
    heading_->setAutoRaise(true);
    heading_->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
    heading_->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
    heading_->setFocusPolicy(Qt::TabFocus);
    make_bold(*heading_);
    column_in(this, {heading_, message_, content_})->setSpacing(2);
    connect(heading_, &QToolButton::toggled, this, &Section::set_open);
    set_open(true);
}

void Section::set_open(bool open) {
    heading_->setChecked(open);
    heading_->setArrowType(open ? Qt::DownArrow : Qt::RightArrow);
    content_->setVisible(open);
}

void Section::say(const QString& why) {
    message_->say(why);
    if (!why.isEmpty()) set_open(true);
}

}  // namespace palpate::viewer
