// Keeps the controls of the overlay in step with its look.
#include "apps/viewer/panel/overlay_controls.hpp"

#include <QSignalBlocker>

#include <algorithm>

#include "apps/viewer/model/transfer.hpp"
#include "apps/viewer/panel/colours.hpp"
#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/panel/names.hpp"

namespace palpate::viewer {
namespace {

QLabel* label_for(const QString& text, QWidget* field) {
    auto* label = new QLabel(text);
    label->setBuddy(field);
    return label;
}

}  // namespace

OverlayControls::OverlayControls()
    : open_(named(new QPushButton(tr("Open…")), "open_overlay",
                  tr("A label map or another image of the same body, on a grid of its own"))),
      close_(named(new QPushButton(tr("Close")), "close_overlay")),
      name_(named(new QLabel, "overlay_name")),
      shown_(named(new QCheckBox(tr("In slices")), "overlay_shown",
                   tr("Over the grey of the slices"))),
      surface_(named(new QCheckBox(tr("In the scene")), "overlay_surface",
                     tr("Surfaces of the labels, or of the image's level"))),
      opacity_(new Quantity("overlay_opacity", "", 0, 1, 0.05)),
      surface_opacity_(new Quantity("overlay_surface_opacity", "", 0, 1, 0.05)),
      colours_(named(new QComboBox, "overlay_colours", tr("Colour map of the image"))),
      level_(named(new NumberBox, "overlay_level", tr("Level of the image's surface [its units]"))),
      labels_(named(new QListWidget, "overlay_labels",
                    tr("Labels; a double click goes to where one lies"))),
      feel_(named(new QPushButton(tr("Feel these labels")), "feel_labels",
                  tr("Layers by label: each label that is shown becomes one, with its name and "
                     "colour; change them on the page Feel"))) {
    opacity_->set_accessible_name(tr("Opacity of the overlay in slices"));
    surface_opacity_->set_accessible_name(tr("Opacity of the overlay's surfaces"));
    labels_->setAccessibleName(tr("Labels"));
    colours_->setAccessibleName(tr("Colour map of the overlay"));
    level_->setAccessibleName(tr("Level of the overlay's surface"));
    for (const std::string& name : colour_map_names()) add_choice(*colours_, name);
    let_wheel_pass(*colours_);
    name_->setTextFormat(Qt::PlainText);
    image_ = row_of(
        {label_for(tr("Colours"), colours_), colours_, label_for(tr("Level"), level_), level_}, 3);
    body_ = column_of({row_of({shown_, opacity_}, 1), row_of({surface_, surface_opacity_}, 1),
                       image_, labels_, feel_});
    column_in(this, {row_of({open_, close_, name_}, 2), body_});
    connect_inputs();
    set_overlay(nullptr);
}

void OverlayControls::change(const std::function<void(OverlayLook&)>& how) {
    how(look_);
    Q_EMIT look_changed(look_);
}

void OverlayControls::connect_inputs() {
    connect(open_, &QPushButton::clicked, this, &OverlayControls::open_wanted);
    connect(feel_, &QPushButton::clicked, this, &OverlayControls::feel_wanted);
    connect(close_, &QPushButton::clicked, this, &OverlayControls::close_wanted);
    connect(shown_, &QCheckBox::clicked, this,
            [this](bool on) { change([on](OverlayLook& l) { l.shown = on; }); });
    connect(surface_, &QCheckBox::clicked, this,
            [this](bool on) { change([on](OverlayLook& l) { l.surface = on; }); });
    const auto part = [this](Quantity* quantity, double OverlayLook::*member) {
        connect(quantity, &Quantity::wanted, this, [this, quantity, member](double value) {
            quantity->set_value(std::clamp(value, 0.0, 1.0));
            change([&](OverlayLook& l) { l.*member = quantity->value(); });
        });
    };
    part(opacity_, &OverlayLook::opacity);
    part(surface_opacity_, &OverlayLook::surface_opacity);
    connect(colours_, qOverload<int>(&QComboBox::activated), this, [this] {
        change([this](OverlayLook& l) {
            l.colours = colours_->currentData().toString().toStdString();
        });
    });
    connect(level_, qOverload<double>(&NumberBox::valueChanged), this,
            [this](double level) { change([level](OverlayLook& l) { l.level = level; }); });
    connect(labels_, &QListWidget::itemChanged, this, [this](const QListWidgetItem* item) {
        const int value = item->data(Qt::UserRole).toInt();
        const bool shown = item->checkState() == Qt::Checked;
        change([&](OverlayLook& l) {
            std::erase(l.hidden, value);
            if (!shown) l.hidden.push_back(value);
        });
    });
    connect(labels_, &QListWidget::itemDoubleClicked, this, [this](const QListWidgetItem* item) {
        Q_EMIT label_wanted(item->data(Qt::UserRole).toInt());
    });
}

void OverlayControls::fill_labels(const Overlay* overlay) {
    const QSignalBlocker quiet(labels_);
    labels_->clear();
    if (!overlay) return;
    for (const Label& label : overlay->labels) {
        auto* item = new QListWidgetItem(QString::fromStdString(label.name), labels_);
        QPixmap colour(16, 16);
        colour.fill(to_qt(label.colour));
        item->setIcon(QIcon(colour));
        item->setData(Qt::UserRole, label.value);
        item->setToolTip(tr("Value %1").arg(label.value));
        item->setFlags(item->flags() | Qt::ItemIsUserCheckable);
    }
}

void OverlayControls::set_overlay(const Overlay* overlay) {
    const QString path =
        overlay ? QString::fromStdString(run::name_of(overlay->source)) : QString();
    name_->setText(path.section('/', -1));
    name_->setToolTip(path);
    close_->setEnabled(overlay);
    body_->setVisible(overlay);
    image_->setVisible(overlay && !overlay->is_label_map());
    labels_->setVisible(overlay && overlay->is_label_map());
    feel_->setVisible(overlay && overlay->is_label_map());
    suggested_ = overlay ? overlay->level : 0;
    fill_labels(overlay);
    set_look(look_);
}

void OverlayControls::set_look(const OverlayLook& look) {
    look_ = look;
    shown_->setChecked(look.shown);
    surface_->setChecked(look.surface);
    opacity_->set_value(look.opacity);
    surface_opacity_->set_value(look.surface_opacity);
    colours_->setCurrentIndex(colours_->findData(QString::fromStdString(look.colours)));
    level_->show_value(look.level.value_or(suggested_));
    const QSignalBlocker quiet(labels_);
    for (int i = 0; i < labels_->count(); ++i) {
        QListWidgetItem* item = labels_->item(i);
        const int value = item->data(Qt::UserRole).toInt();
        const bool hidden = std::ranges::count(look.hidden, value) > 0;
        item->setCheckState(hidden ? Qt::Unchecked : Qt::Checked);
    }
}

}  // namespace palpate::viewer
