// Opens an overlay over the volume, and shows it in slices and scene.
#pragma once

#include <QObject>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "apps/viewer/model/overlay.hpp"
#include "apps/viewer/scene/surface_maker.hpp"
#include "apps/viewer/window/desk.hpp"
#include "apps/viewer/window/messages.hpp"

namespace palpate::viewer {

class OverlayController : public Controller {
    Q_OBJECT

  public:
    explicit OverlayController(const Desk& desk);

    /// By a dialog.
    void ask_open();
    /// Over the volume that is open, once it has been read. Errors are shown; the overlay before
    /// stays then.
    void open(const run::Source& source);
    void close();
    /// Null: none.
    const std::shared_ptr<const Overlay>& overlay() const { return overlay_; }
    /// Labels have the colours and opacities of the layers shown, where those are by label.
    void colour();
    bool settled() const { return !loader_.busy() && !image_.extracting(); }
    BackgroundTask& loader() { return loader_; }

  Q_SIGNALS:
    /// Another overlay, or none.
    void changed();

  private:
    void use(std::shared_ptr<const Overlay> overlay, std::vector<ExtractedSurface> labels);
    void keep_file(const std::filesystem::path& file);
    void show();
    void go_to(int label);

    std::shared_ptr<const Overlay> overlay_;
    std::filesystem::path file_;  // of the overlay; empty: none
    std::vector<ExtractedSurface> labels_;
    SurfaceMaker image_;  // its surface
    BackgroundTask loader_;
};

}  // namespace palpate::viewer
