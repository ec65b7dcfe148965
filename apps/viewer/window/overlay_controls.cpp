// Reads overlays, and keeps controls, slices and scene in step with them.
#include "apps/viewer/window/overlay_controls.hpp"

#include <QSignalBlocker>

#include <algorithm>
#include <span>
#include <utility>

#include "apps/viewer/model/transfer.hpp"
#include "apps/viewer/panel/sentences.hpp"
#include "apps/viewer/scene/render_request.hpp"
#include "apps/viewer/scene/scene.hpp"
#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/file_dialogs.hpp"
#include "apps/viewer/window/views.hpp"
#include "palpate/run/beside.hpp"

namespace palpate::viewer {
namespace {

/// Of the layer that a label is, if it is one.
double opacity_of(int label, const SharedLayers& layers) {
    if (!layers || !layers->by_label) return 1;
    const auto labels = std::span(layers->layers).subspan(level_count(*layers));
    const auto layer = std::ranges::find(labels, label, &Layer::level);
    return layer != labels.end() ? layer->opacity : 1;
}

}  // namespace

OverlayControls::OverlayControls(const Desk& desk, LookControls& look)
    : EffectForm(desk.effect()),
      Desk(desk),
      look_(look),
      image_surface_({2000000, 40000}),
      loader_(messages_),
      name_(named(new QLabel, "overlay_name")),
      beside_(new Note(this, "overlay_beside", Note::Kind::warning)),
      labels_(named(new QListWidget, "overlay_labels",
                    tr("Labels; a double click goes to where one lies"))) {
    const Parts<OverlayLook> its{[this]() -> const OverlayLook& { return its_look(); },
                                 [&look](const std::function<void(OverlayLook&)>& how) {
                                     look.change([&](Look& all) { how(all.overlay); });
                                 }};
    auto* open = button({"open_overlay", tr("Open…"),
                         tr("A label map or another image of the same body, on a grid of its own")},
                        [this] { ask_open(); });
    close_ = button({"close_overlay", tr("Close")}, [this] { close_overlay(); });
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
    auto* level =
        number({"overlay_level", "", tr("Level of the image's surface [its units]"),
                tr("Level of the overlay's surface")},
               {[this] { return its_look().level.value_or(overlay_ ? overlay_->level : 0); },
                its[&OverlayLook::level].set});
    name_->setTextFormat(Qt::PlainText);
    name_->setMinimumWidth(1);  // a long name must not make the panel wider
    image_ = row_of(
        {label_for(tr("Colours"), colours), colours, label_for(tr("Level"), level), level}, 3);
    make_labels();
    body_ = column_of({slices, scene, image_, labels_, feel_});
    column_in(this, {row_of({open, close_, name_}, 2), body_});
    connect(&look, &LookControls::look_changed, this, [this] {
        refresh();
        show_surfaces();
    });
    connect(&image_surface_, &SurfaceMaker::made, this, &OverlayControls::show_surfaces);
    connect(&content_, &Content::closed, this, &OverlayControls::close_overlay);
    list(nullptr);
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
    connect(labels_, &QListWidget::itemDoubleClicked, this,
            [this](const QListWidgetItem* item) { go_to(item->data(Qt::UserRole).toInt()); });
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

void OverlayControls::list(const Overlay* overlay) {
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

void OverlayControls::ask_open() {
    if (!content_.volume()) return;
    const QString path = ask_open_overlay_name(messages_.window());
    if (path.isEmpty()) return;
    remember_folder(path);
    open(run::source_named(path.toStdString()));
}

void OverlayControls::open(const run::Source& source) {
    if (!content_.volume()) return;
    messages_.forget();
    struct Read {
        std::shared_ptr<const Overlay> overlay;
        std::vector<ExtractedSurface> labels;
    };
    const auto read = std::make_shared<Read>();
    const QString name = short_name(QString::fromStdString(run::name_of(source)));
    loader_.start(
        tr("Opening %1").arg(name),
        [source, read, volume = content_.volume()](const io::Progress& progress) {
            constexpr double reading = 0.6;
            const run::LoadedVolume loaded = run::load_beside(
                source, volume->loaded, [&](double part) { progress(reading * part); });
            read->overlay = std::make_shared<const Overlay>(make_overlay(loaded, source));
            read->labels = label_surfaces(
                *read->overlay, [&](double part) { progress(reading + (1 - reading) * part); });
        },
        [this, read] { use(read->overlay, std::move(read->labels)); });
}

void OverlayControls::use(std::shared_ptr<const Overlay> overlay,
                          std::vector<ExtractedSurface> labels) {
    if (!content_.volume()) return;
    keep_file(run::place_of(overlay->source));
    overlay_ = std::move(overlay);
    beside_->say(in_words(run::warning_beside(
        run::name_of(overlay_->source), overlay_->volume.geometry(), content_.volume()->loaded)));
    if (!warning().isEmpty()) messages_.show_done(warning());
    label_surfaces_ = std::move(labels);
    const std::optional<double> level = its_look().level;
    if (overlay_->is_label_map()) {
        image_surface_.clear();
    } else {
        image_surface_.set_field(linear_field(overlay_->volume), {level.value_or(overlay_->level)});
    }
    colour_labels();
    Q_EMIT overlay_changed();
}

/// From being replaced by the volume that is saved.
void OverlayControls::keep_file(const std::filesystem::path& file) {
    if (const auto& felt = content_.data()) {
        felt->release(file_);
        felt->keep(file);
    }
    file_ = file;
}

void OverlayControls::colour_labels() {
    const auto coloured = in_colours_of(overlay_, views_.shown().layers);
    if (coloured != views_.shown().overlay) {
        list(coloured.get());
        set(views_, &Shown::overlay, coloured);
    }
    show_surfaces();
}

void OverlayControls::close_overlay() {
    loader_.abandon();
    if (!overlay_) return;
    keep_file({});
    overlay_.reset();
    beside_->say({});
    label_surfaces_.clear();
    image_surface_.clear();
    colour_labels();
    views_.scene().set_overlay({});
    Q_EMIT overlay_changed();
}

void OverlayControls::show_surfaces() {
    if (!overlay_ || !content_.volume()) return;
    constexpr Colour image_colour{0.85, 0.35, 0.25};
    const OverlayLook& look = its_look();
    const Vec3 offset = physical_centre(overlay_->volume.geometry()) -
                        physical_centre(content_.volume()->loaded.volume.geometry());
    const double opacity = look.surface ? look.surface_opacity : 0;
    std::vector<DrawnSurface> surfaces;
    if (overlay_->is_label_map()) {
        for (std::size_t i = 0; i < label_surfaces_.size(); ++i) {
            const Label& label = views_.shown().overlay->labels[i];
            const bool hidden = std::ranges::count(look.hidden, label.value) > 0;
            const double seen =
                hidden ? 0 : opacity * opacity_of(label.value, views_.shown().layers);
            surfaces.push_back({label_surfaces_[i], label.colour, seen, offset});
        }
    } else {
        image_surface_.set_levels({look.level.value_or(overlay_->level)});
        for (const ExtractedSurface& surface : image_surface_.surfaces()) {
            surfaces.push_back({surface, image_colour, opacity, offset});
        }
    }
    views_.scene().set_overlay(std::move(surfaces));
}

/// Slices through the middle of where the label lies.
void OverlayControls::go_to(int value) {
    const auto label = std::ranges::find(overlay_->labels, value, &Label::value);
    if (label == overlay_->labels.end()) return;
    const Vec3 index = 0.5 * (label->box.low + label->box.high).cast<double>();
    views_.set_follow(false);
    set(views_, &Shown::crosshair, physical_from_index(overlay_->volume.geometry(), index));
}

}  // namespace palpate::viewer
