// The dialog for raw files.
#include "apps/viewer/window/raw_dialog.hpp"

#include <QComboBox>
#include <QDialogButtonBox>
#include <QDoubleSpinBox>
#include <QFileInfo>
#include <QFormLayout>
#include <QLabel>
#include <QPushButton>
#include <QSlider>
#include <cmath>
#include <limits>

#include "apps/viewer/model/raw_preview.hpp"
#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/panel/number_box.hpp"

namespace palpate::viewer {
namespace {

constexpr int picture_side = 280;  // pixels

}  // namespace

RawDialog::RawDialog(const QString& path, QWidget* parent)
    : QDialog(parent),
      path_(path),
      size_{new QSpinBox, new QSpinBox, new QSpinBox},
      spacing_{new QDoubleSpinBox, new QDoubleSpinBox, new QDoubleSpinBox},
      type_(named(new QComboBox, "raw_type")),
      order_(named(new QComboBox, "raw_order")),
      skip_(named(new QSpinBox, "raw_skip")),
      skip_rest_(named(new QPushButton(tr("Skip the rest")), "raw_skip_rest",
                       tr("Takes the bytes that are left over for a header"))),
      slice_(named(new QSlider(Qt::Horizontal), "raw_slice")),
      picture_(named(new QLabel, "raw_picture")),
      verdict_(named(new QLabel, "raw_verdict")) {
    setObjectName("raw");
    setWindowTitle(tr("Raw data: %1").arg(QFileInfo(path).fileName()));
    make_fields();
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Open | QDialogButtonBox::Cancel);
    accept_ = buttons->button(QDialogButtonBox::Open);
    connect(buttons, &QDialogButtonBox::accepted, this, &QDialog::accept);
    connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);
    auto* form = new QFormLayout;
    add_row(*form, tr("Samples"), row_of({size_[0], size_[1], size_[2]}),
            tr("How many along x, which runs fastest, y and z"));
    add_row(*form, tr("Sample type"), type_, tr("Of each sample in the file"));
    add_row(*form, tr("Byte order"), order_, tr("Of samples of two or four bytes"));
    add_row(*form, tr("Spacing [mm]"), row_of({spacing_[0], spacing_[1], spacing_[2]}),
            tr("Between samples along x, y and z"));
    add_row(*form, tr("Header [bytes]"), row_of({skip_, skip_rest_}),
            tr("Skipped before the samples"));
    form->addRow(verdict_);
    auto* fields = new QWidget;
    fields->setLayout(form);
    column_in(this, {row_of({fields, make_preview()}), buttons})->setContentsMargins(9, 9, 9, 9);
    judge();
}

void RawDialog::make_fields() {
    const auto changed = [this] { judge(); };
    const auto bytes = static_cast<std::uint64_t>(QFileInfo(path_).size());
    const io::RawLayout guess = guessed_layout(path_.toStdString(), bytes);
    const char* const axes[] = {"x", "y", "z"};
    for (std::size_t a = 0; a < 3; ++a) {
        size_[a]->setRange(1, 65535);
        size_[a]->setValue(guess.size[int(a)]);
        size_[a]->setObjectName(QString("size%1").arg(a));
        size_[a]->setAccessibleName(tr("Samples along %1").arg(axes[a]));
        spacing_[a]->setRange(1e-4, 1000);
        spacing_[a]->setDecimals(4);
        spacing_[a]->setValue(1);
        spacing_[a]->setAccessibleName(tr("Spacing along %1").arg(axes[a]));
        connect(size_[a], qOverload<int>(&QSpinBox::valueChanged), this, changed);
    }
    type_->addItems({"uint8", "int16", "uint16", "float32"});
    type_->setCurrentText(QString::fromLatin1(name_of(guess.type).data()));
    order_->addItems({tr("little-endian (PC)"), tr("big-endian")});
    order_->setCurrentIndex(guess.big_endian ? 1 : 0);
    skip_->setRange(0, std::numeric_limits<int>::max());
    for (QComboBox* box : {type_, order_}) {
        connect(box, qOverload<int>(&QComboBox::currentIndexChanged), this, changed);
    }
    connect(skip_, qOverload<int>(&QSpinBox::valueChanged), this, changed);
    connect(skip_rest_, &QPushButton::clicked, this, [this] {
        const double rest = double(QFileInfo(path_).size()) - bytes_of(layout_now());
        skip_->setValue(static_cast<int>(skip_->value() + rest));
    });
    verdict_->setWordWrap(true);
}

QWidget* RawDialog::make_preview() {
    picture_->setFixedSize(picture_side, picture_side);
    picture_->setAlignment(Qt::AlignCenter);
    picture_->setWordWrap(true);
    picture_->setFrameShape(QFrame::StyledPanel);
    slice_->setAccessibleName(tr("Slice of the preview"));
    slice_->setRange(0, size_[2]->value() - 1);
    slice_->setValue(size_[2]->value() / 2);
    connect(slice_, &QSlider::valueChanged, this, &RawDialog::show_slice);
    return column_of({picture_, slice_});
}

io::RawLayout RawDialog::layout_now() const {
    io::RawLayout layout;
    for (int a = 0; a < 3; ++a) {
        layout.size[a] = size_.at(static_cast<std::size_t>(a))->value();
        layout.spacing[a] = spacing_.at(static_cast<std::size_t>(a))->value();
    }
    layout.type = sample_type_from(type_->currentText().toStdString());
    layout.skip = static_cast<std::uint64_t>(skip_->value());
    layout.big_endian = order_->currentIndex() == 1;
    return layout;
}

void RawDialog::judge() {
    const io::RawLayout layout = layout_now();
    const double bytes = bytes_of(layout);
    const bool packed = path_.endsWith(".gz", Qt::CaseInsensitive);
    const auto have = static_cast<double>(QFileInfo(path_).size());
    order_->setEnabled(size_of(layout.type) > 1);
    accept_->setEnabled(packed || bytes == have);
    skip_rest_->setEnabled(!packed && bytes < have && have - bytes < skip_->maximum());
    verdict_->setText(
        packed ? tr("These samples take %1 bytes once unpacked.").arg(count_text(bytes))
        : bytes == have
            ? tr("These samples are just what the file holds.")
            : (have > bytes ? tr("The file holds %1 bytes, %2 more than these samples take.")
                            : tr("The file holds %1 bytes, %2 fewer than these samples take."))
                  .arg(count_text(have), count_text(std::abs(have - bytes))));
    if (slice_->maximum() != layout.size[2] - 1) {
        slice_->setMaximum(layout.size[2] - 1);
        slice_->setValue(layout.size[2] / 2);
    }
    show_slice();
}

void RawDialog::show_slice() {
    const auto slice = raw_slice(path_.toStdString(), layout_now(), slice_->value());
    if (!slice) return picture_->setText(tr("No preview"));
    const QImage image(slice->grey.data(), slice->width, slice->height, slice->width,
                       QImage::Format_Grayscale8);
    picture_->setPixmap(QPixmap::fromImage(image.scaled(
        picture_->contentsRect().size(), Qt::KeepAspectRatio, Qt::SmoothTransformation)));
}

run::FileSource RawDialog::layout_source() const {
    const io::RawLayout layout = layout_now();
    const bool given = layout.spacing != Vec3::Ones();
    return {path_.toStdString(), layout, given ? std::optional(layout.spacing) : std::nullopt, {}};
}

}  // namespace palpate::viewer
