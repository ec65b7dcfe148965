// A dialog that asks for a volume that is read as it is felt: its address, and which level of
// detail, channel and time of it.
#pragma once

#include <QDialog>
#include <memory>
#include <optional>
#include <string>

#include "apps/viewer/model/worker.hpp"
#include "palpate/run/source.hpp"

class QCheckBox;
class QComboBox;
class QLabel;
class QLineEdit;
class QPushButton;
class QSpinBox;

namespace palpate::viewer {

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
    /// What was chosen.
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
