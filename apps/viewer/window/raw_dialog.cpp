// The dialog for raw files.
#include "apps/viewer/window/raw_dialog.hpp"

#include <QComboBox>
#include <QDialogButtonBox>
#include <QDoubleSpinBox>
#include <QFileInfo>
#include <QFormLayout>
#include <QLabel>
#include <QPushButton>
#include <limits>

#include "apps/viewer/panel/layout.hpp"

namespace palpate::viewer {
RawDialog::RawDialog(const QString& path, QWidget* parent)
    : QDialog(parent),
      path_(path),
      size_{new QSpinBox, new QSpinBox, new QSpinBox},
      spacing_{new QDoubleSpinBox, new QDoubleSpinBox, new QDoubleSpinBox},
      type_(new QComboBox),
      skip_(new QSpinBox),
      verdict_(new QLabel) {
    setObjectName("raw");
    setWindowTitle(QString("Raw data: %1").arg(QFileInfo(path).fileName()));
    const auto changed = [this] { judge(); };
    for (std::size_t a = 0; a < 3; ++a) {
        size_[a]->setRange(1, 65535);
        size_[a]->setValue(256);
        size_[a]->setObjectName(QString("size%1").arg(a));
        spacing_[a]->setRange(1e-4, 1000);
        spacing_[a]->setDecimals(4);
        spacing_[a]->setValue(1);
        connect(size_[a], qOverload<int>(&QSpinBox::valueChanged), this, changed);
    }
    type_->addItems({"uint8", "int16", "uint16", "float32"});
    connect(type_, qOverload<int>(&QComboBox::currentIndexChanged), this, changed);
    skip_->setRange(0, std::numeric_limits<int>::max());
    connect(skip_, qOverload<int>(&QSpinBox::valueChanged), this, changed);
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Open | QDialogButtonBox::Cancel);
    accept_ = buttons->button(QDialogButtonBox::Open);
    connect(buttons, &QDialogButtonBox::accepted, this, &QDialog::accept);
    connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);
    auto* form = new QFormLayout(this);
    form->addRow("Samples (x runs fastest)", row_of({size_[0], size_[1], size_[2]}));
    form->addRow("Sample type (little-endian)", type_);
    form->addRow("Spacing [mm]", row_of({spacing_[0], spacing_[1], spacing_[2]}));
    form->addRow("Bytes of header to skip", skip_);
    verdict_->setWordWrap(true);
    form->addRow(verdict_);
    form->addRow(buttons);
    judge();
}

void RawDialog::judge() {
    const std::size_t each = size_of(sample_type_from(type_->currentText().toStdString()));
    double bytes = double(each) + 0.0;
    for (const QSpinBox* size : size_) bytes *= size->value();
    bytes += skip_->value();
    const bool packed = path_.endsWith(".gz", Qt::CaseInsensitive);
    const auto have = static_cast<double>(QFileInfo(path_).size());
    accept_->setEnabled(packed || bytes <= have);
    verdict_->setText(
        packed ? QString("These samples take %L1 bytes once unpacked.").arg(bytes, 0, 'f', 0)
        : bytes == have ? "These samples are just what the file holds."
                        : QString("The file holds %L1 bytes, these samples take %L2.")
                              .arg(have, 0, 'f', 0)
                              .arg(bytes, 0, 'f', 0));
}

run::Source RawDialog::source() const {
    io::RawLayout layout;
    for (int a = 0; a < 3; ++a) {
        layout.size[a] = size_.at(static_cast<std::size_t>(a))->value();
        layout.spacing[a] = spacing_.at(static_cast<std::size_t>(a))->value();
    }
    layout.type = sample_type_from(type_->currentText().toStdString());
    layout.skip = static_cast<std::uint64_t>(skip_->value());
    run::Source source;
    source.from = run::FileSource{path_.toStdString(), layout, layout.spacing, {}};
    return source;
}

}  // namespace palpate::viewer
