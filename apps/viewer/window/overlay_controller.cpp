// Reads overlays in the background.
#include "apps/viewer/window/overlay_controller.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "apps/viewer/panel/look_controls.hpp"
#include "apps/viewer/panel/overlay_controls.hpp"
#include "apps/viewer/panel/panel.hpp"
#include "apps/viewer/scene/render_request.hpp"
#include "apps/viewer/scene/scene.hpp"
#include "apps/viewer/scene/surface_maker.hpp"
#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/file_dialogs.hpp"
#include "apps/viewer/window/messages.hpp"
#include "apps/viewer/window/views.hpp"

namespace palpate::viewer {
namespace {

/// Of the layer that a label is, if it is one.
double opacity_of(int label, const SharedLayers& layers) {
    if (!layers || !layers->by_label) return 1;
    const auto labels = std::span(layers->layers).subspan(level_count(*layers));
    const auto layer = std::ranges::find(labels, label, &palpate::Layer::level);
    return layer != labels.end() ? layer->opacity : 1;
}

}  // namespace

OverlayController::OverlayController(const Desk& desk)
    : Controller(desk), image_({2000000, 40000}), loader_(messages_) {
    connect(&content_, &Content::closed, this, &OverlayController::close);
    connect(&image_, &SurfaceMaker::made, this, &OverlayController::show);
    connect(&panel_.look_controls(), &LookControls::look_changed, this, &OverlayController::show);
    connect(&panel_.look_controls(), &LookControls::look_set, this, &OverlayController::show);
    OverlayControls& controls = panel_.overlay_controls();
    connect(&controls, &OverlayControls::open_wanted, this, &OverlayController::ask_open);
    connect(&controls, &OverlayControls::close_wanted, this, &OverlayController::close);
    connect(&controls, &OverlayControls::label_wanted, this, &OverlayController::go_to);
}

void OverlayController::ask_open() {
    if (!content_.volume()) return;
    const QString path = ask_open_overlay_name(messages_.window());
    if (path.isEmpty()) return;
    remember_folder(path);
    open(run::source_named(path.toStdString()));
}

void OverlayController::open(const run::Source& source) {
    messages_.forget();
    struct Read {
        std::shared_ptr<const Overlay> overlay;
        std::vector<ExtractedSurface> labels;
    };
    const auto read = std::make_shared<Read>();
    const QString name = short_name(QString::fromStdString(run::name_of(source)));
    loader_.start(
        tr("Opening %1").arg(name),
        [source, read](const io::Progress& progress) {
            constexpr double reading = 0.6;
            const run::LoadedVolume loaded =
                run::load(source, [&](double part) { progress(reading * part); });
            read->overlay = std::make_shared<const Overlay>(make_overlay(loaded, source));
            read->labels = label_surfaces(
                *read->overlay, [&](double part) { progress(reading + (1 - reading) * part); });
        },
        [this, read] { use(read->overlay, std::move(read->labels)); });
}

void OverlayController::use(std::shared_ptr<const Overlay> overlay,
                            std::vector<ExtractedSurface> labels) {
    if (!content_.volume()) return;
    keep_file(run::place_of(overlay->source));
    overlay_ = std::move(overlay);
    labels_ = std::move(labels);
    const std::optional<double> level = panel_.look_controls().look().overlay.level;
    if (overlay_->is_label_map()) {
        image_.clear();
    } else {
        image_.set_field(linear_field(overlay_->volume), {level.value_or(overlay_->level)});
    }
    colour();
    Q_EMIT changed();
}

/// From being replaced by the volume that is saved.
void OverlayController::keep_file(const std::filesystem::path& file) {
    if (const auto& data = content_.data()) {
        data->release(file_);
        data->keep(file);
    }
    file_ = file;
}

void OverlayController::colour() {
    const auto coloured = in_colours_of(overlay_, views_.shown().layers);
    if (coloured != views_.shown().overlay) {
        panel_.overlay_controls().set_overlay(coloured.get());
        set(views_, &Shown::overlay, coloured);
    }
    show();
}

void OverlayController::close() {
    loader_.abandon();
    if (!overlay_) return;
    keep_file({});
    overlay_.reset();
    labels_.clear();
    image_.clear();
    colour();
    views_.scene().set_overlay({});
    Q_EMIT changed();
}

void OverlayController::show() {
    if (!overlay_ || !content_.volume()) return;
    constexpr Colour image_colour{0.85, 0.35, 0.25};
    const OverlayLook& look = panel_.look_controls().look().overlay;
    const Vec3 offset = physical_centre(overlay_->volume.geometry()) -
                        physical_centre(content_.volume()->loaded.volume.geometry());
    const double opacity = look.surface ? look.surface_opacity : 0;
    std::vector<DrawnSurface> surfaces;
    if (overlay_->is_label_map()) {
        for (std::size_t i = 0; i < labels_.size(); ++i) {
            const Label& label = views_.shown().overlay->labels[i];
            const bool hidden = std::ranges::count(look.hidden, label.value) > 0;
            const double seen =
                hidden ? 0 : opacity * opacity_of(label.value, views_.shown().layers);
            surfaces.push_back({labels_[i], label.colour, seen, offset});
        }
    } else {
        image_.set_levels({look.level.value_or(overlay_->level)});
        for (const ExtractedSurface& surface : image_.surfaces()) {
            surfaces.push_back({surface, image_colour, opacity, offset});
        }
    }
    views_.scene().set_overlay(std::move(surfaces));
}

/// Slices through the middle of where the label lies.
void OverlayController::go_to(int value) {
    const auto label = std::ranges::find(overlay_->labels, value, &Label::value);
    if (label == overlay_->labels.end()) return;
    const Vec3 index = 0.5 * (label->box.low + label->box.high).cast<double>();
    views_.set_follow(false);
    set(views_, &Shown::crosshair, physical_from_index(overlay_->volume.geometry(), index));
}

}  // namespace palpate::viewer
