// Lays out the page of an empty window and those of the menu Help.
#include "apps/viewer/window/welcome.hpp"

#include <QAction>
#include <QBoxLayout>
#include <QCommandLinkButton>
#include <QCoreApplication>
#include <QDialog>
#include <QDialogButtonBox>
#include <QGridLayout>
#include <QLabel>
#include <QPushButton>
#include <QScrollArea>
#include <QTextBrowser>
#include <QVBoxLayout>

#include <algorithm>

#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/window/file_dialogs.hpp"
#include "palpate/io/error.hpp"
#include "palpate/io/sample_volume.hpp"

namespace palpate::viewer {
namespace {

constexpr int column_width = 460, longest_name = 220, most_shown = 5;  // [pixels]

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
               tr("NRRD, MetaImage, NIfTI, DICOM, TIFF, HDF5, VTI, raw; a session or a recording"));
    auto* folder =
        button("welcome_folder", tr("Open a folder…"),
               tr("DICOM series, TIFF slices, Zarr and N5 stores. Ctrl+L opens an address"));
    auto* sample = button("welcome_sample", tr("Feel the sample head"), tr("A CT scan of a head"));
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
    column->setMaximumWidth(column_width);
    column->layout()->setSpacing(10);
    auto* page = new QWidget;
    auto* grid = new QGridLayout(page);
    grid->addWidget(column, 1, 1);
    for (const int side : {0, 2}) {
        grid->setRowStretch(side, 1);
        grid->setColumnStretch(side, 1);
    }
    grid->setColumnStretch(1, column_width);
    auto* scroll = new QScrollArea;  // of a small window
    scroll->setWidget(page);
    scroll->setWidgetResizable(true);
    scroll->setAccessibleName(title->text());
    scroll->setFrameShape(QFrame::NoFrame);
    column_in(this, {scroll});
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
        const QString name =
            fontMetrics().elidedText(short_name(path), Qt::ElideMiddle, longest_name);
        auto* link = new QPushButton(on_button(name));
        link->setFlat(true);
        link->setStyleSheet("text-align: left; padding: 2px 8px;");
        link->setToolTip("<p>" + path.toHtmlEscaped() + "</p>");
        connect(link, &QPushButton::clicked, this, [this, path] { Q_EMIT recent_chosen(path); });
        recent_->layout()->addWidget(link);
    }
}

void Welcome::set_devices(const QString& text) {
    devices_->setText(text);
}

namespace {

struct Help {
    Q_DECLARE_TR_FUNCTIONS(Help)
};

QString row(const QString& keys, const QString& what) {
    return QString("<tr><td style='padding-right:2em'><b>%1</b></td><td>%2</td></tr>")
        .arg(keys.toHtmlEscaped(), what.toHtmlEscaped());
}

QString heading(const QString& text) {
    return QString("<h3>%1</h3><table>").arg(text.toHtmlEscaped());
}

QString mouse_table() {
    return heading(Help::tr("Mouse in the scene")) +
           row(Help::tr("Left click"),
               Help::tr("with the mouse as device: touch the surface; held: press deeper")) +
           row(Help::tr("Left drag"),
               Help::tr(
                   "turn; with the mouse as device: move the probe in the plane of the view")) +
           row(Help::tr("Wheel"), Help::tr("zoom; with the mouse as device: probe into the depth "
                                           "(Shift: finely; Ctrl: zoom)")) +
           row(Help::tr("Right drag"),
               Help::tr("zoom; with the mouse as device: turn (Shift or middle: pan)")) +
           row(Help::tr("Double click"), Help::tr("this pane alone, or again all")) +
           row(Help::tr("Shift and double click"), Help::tr("centre there")) + "</table>" +
           heading(Help::tr("Mouse in a slice")) +
           row(Help::tr("Left"),
               Help::tr("crosshair (Ctrl: the probe, with the mouse as device)")) +
           row(Help::tr("Wheel"), Help::tr("next slice (Ctrl: zoom)")) +
           row(Help::tr("Right drag"), Help::tr("window and level")) +
           row(Help::tr("Middle drag"), Help::tr("pan; Shift and double click: the whole slice")) +
           "</table>";
}

/// A page of text with a button that closes it.
QDialog* page(QWidget* window, const char* name, const QString& title, const QString& html) {
    auto* dialog = new QDialog(window);
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setObjectName(name);
    dialog->setWindowTitle(title);
    auto* browser = new QTextBrowser;
    browser->setHtml(html);
    browser->setAccessibleName(title);
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Close);
    QObject::connect(buttons, &QDialogButtonBox::rejected, dialog, &QDialog::reject);
    auto* layout = new QVBoxLayout(dialog);
    layout->addWidget(browser);
    layout->addWidget(buttons);
    dialog->resize(72 * dialog->fontMetrics().averageCharWidth(),
                   36 * dialog->fontMetrics().height());
    return dialog;
}

}  // namespace

QDialog* make_first_steps_dialog(QWidget* window) {
    return page(
        window, "first_steps", Help::tr("First steps"),
        Help::tr(
            "<h3>Touch</h3><p>Click a surface: the probe goes there and touches it. Hold the "
            "button, or turn the wheel, to press; drag to move along the surface. The blue ball "
            "is your hand, the vermilion one the proxy, which stays on the surface; the green "
            "arrow is the force. The right button turns the view. With a haptic device, choose it "
            "under <i>Device</i>.</p>"
            "<h3>Choose what is solid</h3><p>Drag the line in the histogram: everything denser is "
            "solid, at once. The ticks are good levels to begin with.</p>"
            "<h3>Go deeper</h3><p>Under <i>Pressing through</i> switch on <i>Surfaces give "
            "way</i>: press harder, and the hand goes through to what is denser.</p>"
            "<h3>See more</h3><p>Under <i>Look</i> add a surface: skin over bone. V cuts "
            "everything open with a plane; drag its blue balls. M measures a length. Under "
            "<i>Data</i> open an overlay: labels or another image.</p>"
            "<h3>Change the data</h3><p>Switch the brush on (B) and touch: it carves, adds, "
            "smooths or paints. Ctrl+Z takes a stroke back, Ctrl+Shift+S saves the volume.</p>"
            "<h3>Come back</h3><p>Ctrl+S saves the session: volume, level, view and settings. "
            "Ctrl+R records what is felt, to be played later.</p>"));
}

QDialog* make_shortcuts_dialog(QWidget* window) {
    QString text = heading(Help::tr("Keys"));
    // Actions of the menus come before those that need the focus in the scene.
    auto actions = window->findChildren<QAction*>();
    std::stable_partition(actions.begin(), actions.end(), [](const QAction* action) {
        return action->shortcutContext() == Qt::WindowShortcut;
    });
    for (const QAction* action : actions) {
        if (action->shortcut().isEmpty()) continue;
        text += row(action->shortcut().toString(QKeySequence::NativeText),
                    action->text().remove('&').remove(QString::fromUtf8("\u2026")));
    }
    return page(window, "shortcuts", Help::tr("Shortcuts"), text + "</table>" + mouse_table());
}

QDialog* make_about_dialog(QWidget* window) {
    const QString versions =
        Help::tr("Palpate %1, Qt %2, VTK %3, built %4")
            .arg(PALPATE_VERSION, qVersion(), PALPATE_VTK_VERSION,
                 sizeof(void*) == 8 ? Help::tr("for 64 bits") : Help::tr("for 32 bits"));
    return page(window, "about", Help::tr("About Palpate"),
                Help::tr("<h2>Palpate</h2><p>Feel the surfaces inside volumetric data.</p><p>%1</p>"
                         "<p>After \"Volume Haptic Rendering with Dynamically Extracted "
                         "Isosurface\" by Corenthy, San Martin, Otaduy and Garcia (2012).</p>"
                         "<p>Not a medical device: for research, teaching and development.</p>")
                    .arg(versions));
}

}  // namespace palpate::viewer
