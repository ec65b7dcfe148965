// Builds the strip: a label, a bar and a button.
#include "apps/viewer/window/progress_strip.hpp"

#include <QHBoxLayout>
#include <QLabel>
#include <QProgressBar>
#include <QPushButton>

namespace palpate::viewer {

ProgressStrip::ProgressStrip(QWidget* parent)
    : QWidget(parent), what_(new QLabel), bar_(new QProgressBar) {
    setObjectName("progress");
    auto* layout = new QHBoxLayout(this);
    layout->addWidget(what_);
    layout->addWidget(bar_, 1);
    auto* cancel = new QPushButton(tr("Cancel"));
    cancel->setObjectName("cancel");
    layout->addWidget(cancel);
    bar_->setRange(0, 100);
    connect(cancel, &QPushButton::clicked, this, &ProgressStrip::cancelled);
    hide();
}

void ProgressStrip::begin(const QString& what) {
    what_->setText(what);
    bar_->setValue(0);
    show();
}

void ProgressStrip::at(double fraction) {
    bar_->setValue(static_cast<int>(100 * fraction));
}

void ProgressStrip::end() {
    hide();
}

}  // namespace palpate::viewer
