// Dialogs that ask what to open: how a raw file lies, which DICOM series, and which address, level
// of detail, channel and time.
#pragma once

#include <QDialog>

#include <memory>
#include <optional>
#include <string>

#include "apps/viewer/model/worker.hpp"
#include "palpate/io/series.hpp"
#include "palpate/run/source.hpp"

class QCheckBox;
class QComboBox;
class QLabel;
class QLineEdit;
class QPushButton;
class QSlider;
class QSpinBox;
class QTableWidget;

namespace palpate::viewer {

class Form;

/// Begins with what the file's name and length suggest. Shows at every change a slice, and whether
/// the file has just the bytes that are needed; else it cannot be accepted.
class RawDialog : public QDialog {
    Q_OBJECT

  public:
    explicit RawDialog(const QString& path, QWidget* parent = nullptr);
    /// The file with the layout that is chosen.
    run::FileSource layout_source() const;

  private:
    QWidget* make_numbers(Form& form, const QString& name, const QString& spoken,
                          auto io::RawLayout::*member, double low, double high);
    void add_rows(Form& form);
    QWidget* make_preview();
    bool is_packed() const;
    bool judge();
    void show_slice();

    QString path_;
    double have_;  // [bytes] of the file
    io::RawLayout layout_;
    QSlider* slice_;
    QLabel *picture_, *verdict_;
};

/// A dialog that asks which of the DICOM series of a file or folder to open.
class SeriesDialog : public QDialog {
    Q_OBJECT

  public:
    SeriesDialog(const QString& name, const std::vector<io::SeriesInfo>& series,
                 QWidget* parent = nullptr);
    /// From 1.
    int chosen() const;

  private:
    QTableWidget* table_;
};

/// What an address has is looked up in the background once it was typed; only then can the dialog
/// be accepted.
class StoreDialog : public QDialog {
    Q_OBJECT

  public:
    /// Without a source: asks for the address, too.
    explicit StoreDialog(const std::optional<run::StoreSource>& known, int time = 0,
                         QWidget* parent = nullptr);
    /// Stops what is looked up.
    ~StoreDialog() override;
    run::Source source() const;

  private:
    struct Found;

    void look();
    void take(const std::shared_ptr<Found>& found);
    void show_found();

    QLineEdit* address_;
    QPushButton* look_;
    QComboBox *level_, *channel_;
    QSpinBox* time_;
    QCheckBox *all_times_, *forbidden_;
    QLabel* verdict_;
    QPushButton* accept_;
    int first_level_ = 0, first_channel_ = 0, first_time_ = 0;  // as they are felt now
    run::StoreSource known_;
    std::shared_ptr<Found> looking_, found_;  // asked last; what can be opened
    NewestWorker worker_;                     // that looks
};

/// "0: 512 x 512 x 234, every 1 x 1 x 2 mm, 61 MB".
QString level_words(const stream::StoreInfo& info, int level);

}  // namespace palpate::viewer
