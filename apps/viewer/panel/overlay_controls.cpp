// Keeps the controls of the overlay in step with its look.
#include "apps/viewer/panel/overlay_controls.hpp"

#include <QSignalBlocker>

#include <algorithm>

#include "apps/viewer/model/transfer.hpp"

namespace palpate::viewer {

OverlayControls::OverlayControls(Effect& effect, LookControls& look)
    : EffectForm(effect),
      look_(look),
      name_(named(new QLabel, "overlay_name")),
      labels_(named(new QListWidget, "overlay_labels",
                    tr("Labels; a double click goes to where one lies"))) {
    const Parts<OverlayLook> its{[this]() -> const OverlayLook& { return its_look(); },
                                 [&look](const std::function<void(OverlayLook&)>& how) {
                                     look.change([&](Look& all) { how(all.overlay); });
                                 }};
    auto* open = button({"open_overlay", tr("Open…"),
                         tr("A label map or another image of the same body, on a grid of its own")},
                        [this] { Q_EMIT open_wanted(); });
    close_ = button({"close_overlay", tr("Close")}, [this] { Q_EMIT close_wanted(); });
    feel_ = button(
        {"feel_labels", tr("Feel these labels"),
         tr("Layers by label: each label that is shown becomes one, with its name and "
            "colour; change them on the page Feel")},
        [this] { Q_EMIT feel_wanted(); }, [this] { return effect_.there(); });
    auto* slices =
        row_of({check({"overlay_shown", tr("In slices"), tr("Over the grey of the slices")},
                      its[&OverlayLook::shown]),
                quantity({"overlay_opacity", "", {}, tr("Opacity of the overlay in slices")},
                         parts_span, as_part(its[&OverlayLook::opacity]))},
               1);
    auto* scene = row_of(
        {check({"overlay_surface", tr("In the scene"),
                tr("Surfaces of the labels, or of the image's level")},
               its[&OverlayLook::surface]),
         quantity({"overlay_surface_opacity", "", {}, tr("Opacity of the overlay's surfaces")},
                  parts_span, as_part(its[&OverlayLook::surface_opacity]))},
        1);
    auto* colours = choice(
        {"overlay_colours", "", tr("Colour map of the image"), tr("Colour map of the overlay")},
        colour_map_names(), its[&OverlayLook::colours]);
    auto* level = number(
        {"overlay_level", "", tr("Level of the image's surface [its units]"),
         tr("Level of the overlay's surface")},
        {[this] { return its_look().level.value_or(suggested_); }, its[&OverlayLook::level].set});
    name_->setTextFormat(Qt::PlainText);
    image_ = row_of(
        {label_for(tr("Colours"), colours), colours, label_for(tr("Level"), level), level}, 3);
    make_labels();
    body_ = column_of({slices, scene, image_, labels_, feel_});
    column_in(this, {row_of({open, close_, name_}, 2), body_});
    connect(&look, &LookControls::look_changed, this, &OverlayControls::refresh);
    connect(&look, &LookControls::look_set, this, &OverlayControls::refresh);
    set_overlay(nullptr);
}

void OverlayControls::make_labels() {
    labels_->setAccessibleName(tr("Labels"));
    connect(labels_, &QListWidget::itemChanged, this, [this](const QListWidgetItem* item) {
        const int value = item->data(Qt::UserRole).toInt();
        const bool shown = item->checkState() == Qt::Checked;
        look_.change([&](Look& look) {
            std::erase(look.overlay.hidden, value);
            if (!shown) look.overlay.hidden.push_back(value);
        });
    });
    connect(labels_, &QListWidget::itemDoubleClicked, this, [this](const QListWidgetItem* item) {
        Q_EMIT label_wanted(item->data(Qt::UserRole).toInt());
    });
    each_time(labels_, [this](QListWidget& labels) {
        const QSignalBlocker quiet(labels);
        for (int i = 0; i < labels.count(); ++i) {
            QListWidgetItem* item = labels.item(i);
            const bool hidden =
                std::ranges::count(its_look().hidden, item->data(Qt::UserRole).toInt()) > 0;
            item->setCheckState(hidden ? Qt::Unchecked : Qt::Checked);
        }
    });
}

void OverlayControls::set_overlay(const Overlay* overlay) {
    const QString path =
        overlay ? QString::fromStdString(run::name_of(overlay->source)) : QString();
    const bool label_map = overlay && overlay->is_label_map();
    name_->setText(path.section('/', -1));
    name_->setToolTip(path);
    close_->setEnabled(overlay);
    body_->setVisible(overlay);
    image_->setVisible(overlay && !label_map);
    labels_->setVisible(label_map);
    feel_->setVisible(label_map);
    suggested_ = overlay ? overlay->level : 0;
    labels_->clear();
    for (const Label& label : overlay ? overlay->labels : std::vector<Label>()) {
        auto* item = new QListWidgetItem(icon_of(label.colour), QString::fromStdString(label.name));
        item->setData(Qt::UserRole, label.value);
        item->setToolTip(tr("Value %1").arg(label.value));
        item->setFlags(item->flags() | Qt::ItemIsUserCheckable);
        labels_->addItem(item);
    }
    refresh();
}

}  // namespace palpate::viewer
