// Dialogs that ask what to open: how a raw file lies, which DICOM series, which address, level of
// detail, channel and time, and how the grid of a volume lies in the body.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "palpate/io/orientation.hpp"
#include "palpate/io/series.hpp"
#include "palpate/run/source.hpp"

class QDialog;
class QString;
class QWidget;

namespace palpate::viewer {

// Each calls `then` with the answer, if there is one. Messages::ask() opens them.

/// Begins with what the file's name and length suggest. Shows at every change a slice, and whether
/// the file has just the bytes that are needed; else it cannot be accepted.
QDialog* make_raw_dialog(const QString& path, QWidget* window,
                         std::function<void(const run::FileSource&)> then);

/// Which of the DICOM series of a file or folder, from 1.
QDialog* make_series_dialog(const QString& name, const std::vector<io::SeriesInfo>& series,
                            QWidget* window, std::function<void(int)> then);

/// What an address has is looked up in the background once it was typed; only then can the dialog
/// be accepted. Without a known source it asks for the address, too.
QDialog* make_store_dialog(const std::optional<run::StoreSource>& known, int time, QWidget* window,
                           std::function<void(const run::Source&)> then);

/// `grid`: as it is felt, with `given` in it. The answer replaces the file's own orientation and
/// spacing; what was not touched stays as it was given. If nothing was changed there is none.
QDialog* make_grid_dialog(const Geometry& grid, const io::GivenGrid& given, QWidget* window,
                          std::function<void(const io::GivenGrid&)> then);

}  // namespace palpate::viewer
