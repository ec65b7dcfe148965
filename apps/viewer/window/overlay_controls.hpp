// The overlay: opens and closes one over the volume, in the background, and shows it in slices and
// scene. Its controls show and change the overlay's part of the look.
#pragma once

#include <QLabel>
#include <QListWidget>

#include <filesystem>
#include <memory>
#include <vector>

#include "apps/viewer/model/overlay.hpp"
#include "apps/viewer/scene/surface_maker.hpp"
#include "apps/viewer/window/desk.hpp"
#include "apps/viewer/window/look_controls.hpp"
#include "apps/viewer/window/messages.hpp"

namespace palpate::viewer {

class OverlayControls : public EffectForm, protected Desk {
    Q_OBJECT

  public:
    OverlayControls(const Desk& desk, LookControls& look);

    /// By a dialog.
    void ask_open();
    /// Over the volume that is open, once it has been read. Errors are shown; the overlay before
    /// stays then.
    void open(const run::Source& source);
    void close_overlay();
    /// Null: none.
    const std::shared_ptr<const Overlay>& overlay() const { return overlay_; }
    /// Labels have the colours and opacities of the layers shown, where those are by label.
    void colour_labels();
    bool settled() const { return !loader_.busy() && !image_surface_.extracting(); }
    BackgroundTask& loader() { return loader_; }
    /// run::warning_beside() of the overlay; empty: none.
    QString warning() const { return beside_->text(); }

  Q_SIGNALS:
    /// Another overlay, or none.
    void overlay_changed();
    /// The labels that are shown are to be felt.
    void feel_wanted();

  private:
    const OverlayLook& its_look() const { return look_.look().overlay; }
    void make_labels();
    void use(std::shared_ptr<const Overlay> overlay, std::vector<ExtractedSurface> labels);
    void keep_file(const std::filesystem::path& file);
    void list(const Overlay* overlay);
    void show_surfaces();
    void go_to(int label);

    LookControls& look_;
    std::shared_ptr<const Overlay> overlay_;
    std::filesystem::path file_;  // of the overlay; empty: none
    std::vector<ExtractedSurface> label_surfaces_;
    SurfaceMaker image_surface_;
    BackgroundTask loader_;
    QLabel* name_;
    Note* beside_;
    QPushButton *close_, *feel_;
    QWidget *body_, *image_;
    QListWidget* labels_;
};

}  // namespace palpate::viewer
