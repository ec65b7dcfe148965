// Lays out the buttons and words of an empty window.
#include "apps/viewer/window/welcome.hpp"

#include <QBoxLayout>
#include <QCommandLinkButton>
#include <QLabel>
#include <QPushButton>

#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/window/file_dialogs.hpp"
#include "palpate/io/error.hpp"
#include "palpate/io/sample_volume.hpp"

namespace palpate::viewer {
namespace {

constexpr int column_width = 460, most_shown = 5;

bool has_sample() {
    try {
        (void)io::sample_volume_path();
        return true;
    } catch (const io::InputError&) {
        return false;
    }
}

QCommandLinkButton* button(const char* name, const QString& text, const QString& what) {
    return named(new QCommandLinkButton(text, what), name);
}

QLabel* words(const QString& text) {
    auto* label = new QLabel(text);
    label->setWordWrap(true);
    return label;
}

}  // namespace

Welcome::Welcome(QWidget* parent)
    : QWidget(parent), recent_(named(new QWidget, "welcome_recent")), devices_(words({})) {
    setObjectName("welcome");
    devices_->setObjectName("welcome_devices");
    auto* open =
        button("welcome_open", tr("Open a volume…"),
               tr("NRRD, MetaImage, NIfTI, DICOM, TIFF, VTI, raw; a session or a recording"));
    auto* folder = button("welcome_folder", tr("Open a folder…"), tr("DICOM series, TIFF slices"));
    auto* sample =
        button("welcome_sample", tr("Feel the sample volume"), tr("A CT scan of a head"));
    sample->setVisible(has_sample());
    connect(open, &QCommandLinkButton::clicked, this, &Welcome::open_asked);
    connect(folder, &QCommandLinkButton::clicked, this, &Welcome::folder_asked);
    connect(sample, &QCommandLinkButton::clicked, this, &Welcome::sample_asked);
    auto* title = words(tr("Palpate: feel volumes"));
    QFont large = title->font();
    large.setPointSizeF(1.6 * large.pointSizeF());
    title->setFont(large);
    auto* how = words(tr(
        "Click a surface to touch it; drag to move along, hold the button or turn the wheel to "
        "press.\nThe right button turns the view.\nDrag the line in the histogram to feel another "
        "level. The page Feel lets you press through surfaces."));
    auto* column = column_of({title, open, folder, sample, recent_, how, devices_});
    column->setFixedWidth(column_width);
    column->layout()->setSpacing(10);
    auto* row = new QHBoxLayout(this);
    row->addStretch();
    row->addWidget(column, 0, Qt::AlignVCenter);
    row->addStretch();
    column_in(recent_);
    refresh();
}

void Welcome::refresh() {
    for (auto* old : recent_->findChildren<QWidget*>()) delete old;
    const QStringList files = recent_files().mid(0, most_shown);
    recent_->setVisible(!files.isEmpty());
    if (files.isEmpty()) return;
    recent_->layout()->addWidget(words(tr("Recent")));
    for (const QString& path : files) {
        auto* link = new QPushButton(short_name(path));
        link->setFlat(true);
        link->setStyleSheet("text-align: left; padding: 2px 8px;");
        link->setToolTip(path);
        connect(link, &QPushButton::clicked, this, [this, path] { Q_EMIT recent_chosen(path); });
        recent_->layout()->addWidget(link);
    }
}

void Welcome::set_devices(const QString& text) {
    devices_->setText(text);
}

}  // namespace palpate::viewer
