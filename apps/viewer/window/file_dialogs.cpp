// File dialogs; folder and recent files are remembered from one start to the next.
#include "apps/viewer/window/file_dialogs.hpp"

#include <QCoreApplication>
#include <QDateTime>
#include <QDir>
#include <QFileDialog>
#include <QFileInfo>
#include <QMessageBox>
#include <QSettings>

#include "palpate/io/address.hpp"
#include "palpate/io/error.hpp"
#include "palpate/io/sample_volume.hpp"
#include "palpate/run/source.hpp"

namespace palpate::viewer {
namespace {

struct FileDialogs {
    Q_DECLARE_TR_FUNCTIONS(FileDialogs)
};

constexpr int most_recent = 10;

constexpr const char* forgetful = "forgetful";  // a property of the application

/// For the next start.
void keep(const char* key, const QVariant& value) {
    if (!QCoreApplication::instance()->property(forgetful).toBool()) {
        QSettings().setValue(key, value);
    }
}

/// At first the one in which the program was started, unless a menu started it somewhere else.
QString last_folder() {
    const bool writable = QFileInfo(QDir::currentPath()).isWritable();
    const QString usual = writable ? QDir::currentPath() : QDir::homePath();
    return QSettings().value("folder", usual).toString();
}

/// In a folder of the program.
bool is_sample(const QString& path) {
    try {
        return QFileInfo(path) ==
               QFileInfo(QString::fromStdString(io::sample_volume_path().string()));
    } catch (const io::InputError&) {
        return false;
    }
}

constexpr const char* volumes =
    "*.nrrd *.nhdr *.mha *.mhd *.nii *.nii.gz *.hdr *.mgh *.mgz *.mrc *.dcm *.tif *.tiff *.vti "
    "*.vtk *.ims *.h5 *.hdf5";

/// A synthetic volume, a live source or a web address.
bool is_no_file(const QString& path) {
    return path.startsWith("synthetic:") || path.startsWith("live:") ||
           io::is_web_address(path.toStdString());
}

bool may_replace(QWidget* window, const QString& path) {
    return QMessageBox::question(
               window, "Palpate",
               FileDialogs::tr("%1 exists already. Replace it?").arg(short_name(path))) ==
           QMessageBox::Yes;
}

}  // namespace

QString ask_open_name(QWidget* window, const QString& title, const QString& filter) {
    return QFileDialog::getOpenFileName(window, title, last_folder(), filter);
}

QString ask_open_anything(QWidget* window) {
    return ask_open_name(
        window, FileDialogs::tr("Open a volume, a session, layers or a recording"),
        FileDialogs::tr("All that can be opened (%1 *.raw *.raw.gz *.json *.csv);;All files (*)")
            .arg(volumes));
}

QString ask_open_overlay_name(QWidget* window) {
    return ask_open_name(window, FileDialogs::tr("Open an overlay: labels or another image"),
                         FileDialogs::tr("Volumes (%1);;All files (*)").arg(volumes));
}

QString ask_open_folder(QWidget* window) {
    return QFileDialog::getExistingDirectory(
        window, FileDialogs::tr("Open a folder of slices, or a Zarr image"), last_folder());
}

QString ask_save_name(QWidget* window, const QString& title, const QString& name,
                      const QString& suffix, const QString& filter, bool replaces) {
    const bool only = filter.endsWith("(*." + suffix + ")");
    QFileDialog dialog(window, title, last_folder(), filter);
    dialog.setAcceptMode(QFileDialog::AcceptSave);
    dialog.setDefaultSuffix(suffix);
    dialog.setOption(QFileDialog::DontConfirmOverwrite, !replaces);
    dialog.selectFile(name);
    while (dialog.exec() == QDialog::Accepted) {
        keep("folder", dialog.directory().absolutePath());
        const QString path = dialog.selectedFiles().value(0);
        if (!only || path.endsWith("." + suffix, Qt::CaseInsensitive)) return path;
        // The dialog adds none to "day.2", which would not open again as what it is.
        const QString longer = path + "." + suffix;
        if (!replaces || !QFileInfo::exists(longer) || may_replace(window, longer)) return longer;
    }
    return {};
}

QString ask_open_raw_name(QWidget* window) {
    return ask_open_name(window, FileDialogs::tr("Open raw data"),
                         FileDialogs::tr("All files (*)"));
}

void remember_nothing(bool nothing) {
    QCoreApplication::instance()->setProperty(forgetful, nothing);
}

void remember_folder(const QString& path) {
    if (!is_no_file(path) && !is_sample(path)) keep("folder", QFileInfo(path).absolutePath());
}

void remember_file(const QString& path) {
    if (path.contains(QChar::ReplacementCharacter)) return;  // not UTF-8: it would not be found
    const QString name = is_no_file(path) ? path : QFileInfo(path).absoluteFilePath();
    QStringList recent = recent_files();
    recent.removeAll(name);
    recent.prepend(name);
    keep("recent", QStringList(recent.mid(0, most_recent)));
}

QStringList recent_files() {
    return QSettings().value("recent").toStringList();
}

QString time_stamp() {
    return QDateTime::currentDateTime().toString("yyyyMMdd-hhmmss");
}

QString on_button(QString name) {
    return name.replace('&', "&&");
}

QString short_name(const QString& path) {
    return path.startsWith("synthetic:") ? path : QFileInfo(QDir::cleanPath(path)).fileName();
}

}  // namespace palpate::viewer
