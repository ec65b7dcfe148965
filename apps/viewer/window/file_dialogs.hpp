// Dialogs that ask for files to open and to save, and the list of recent files. The folder used
// last and the recent files are kept in QSettings.
#pragma once

#include <QString>
#include <QStringList>

class QWidget;

namespace palpate::viewer {

/// These return an empty name if the user cancels.
QString ask_open_name(QWidget* window, const QString& title, const QString& filter);
/// A volume, a session, layers or a recording.
QString ask_open_anything(QWidget* window);
QString ask_open_overlay_name(QWidget* window);
QString ask_open_folder(QWidget* window);
QString ask_open_raw_name(QWidget* window);
/// `filter`: the files that the dialog shows. Names without an extension get `suffix`, and if the
/// filter has no other one, so do all names that do not end with it. `replaces`: the dialog asks
/// before an existing file is replaced; false for files that are never replaced.
QString ask_save_name(QWidget* window, const QString& title, const QString& name,
                      const QString& suffix, const QString& filter, bool replaces = true);

/// The dialogs begin in the folder of this file.
void remember_folder(const QString& path);
/// True: folders and files are not remembered from now on, in this process.
void remember_nothing(bool nothing);
/// Puts a file first in the list of recent ones.
void remember_file(const QString& path);
QStringList recent_files();

/// For names of new files: "20260130-174501".
QString time_stamp();
/// As the text of a button or a menu's entry, which would take "&" for the mark of a key.
QString on_button(QString name);
/// The name without its folder, for titles and messages.
QString short_name(const QString& path);

}  // namespace palpate::viewer
