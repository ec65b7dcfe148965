// Saves the volume that is felt, and its surface, and asks whether unsaved edits may be lost.
#pragma once

#include <QObject>
#include <QString>
#include <functional>
#include <memory>

#include "apps/viewer/window/desk.hpp"
#include "apps/viewer/window/messages.hpp"
#include "palpate/run/data.hpp"
#include "palpate/surface.hpp"

namespace palpate::viewer {

class Panel;

class SaveController : public Controller {
    Q_OBJECT

  public:
    SaveController(const Desk& desk, Panel& panel);

    /// Asks for a name; offers the format of the volume, if it can be written. `then` runs once it
    /// is saved.
    void ask_save(std::function<void()> then = {});
    /// Saves the volume as it is now, edits included, in the background; what is felt then goes by
    /// this name. Errors are shown.
    void save(const QString& path, std::function<void()> then = {});
    /// Asks for a name, and saves the surface that is felt as a watertight mesh (.ply, .stl, .obj,
    /// .vtp) in the background. Offers to simplify one with many triangles. Errors are shown.
    void ask_save_surface();
    void save_surface(const QString& path);
    /// More triangles than this are many.
    void set_many_triangles(std::size_t triangles) { many_triangles_ = triangles; }
    bool saving() const { return saving_.busy(); }

    /// True if there are no unsaved edits, or the user goes on without them. Offers to save them,
    /// and calls `once_saved` when that is done. False while the volume is being saved.
    bool may_lose_edits(const std::function<void()>& once_saved);
    /// `action` at once, or once edits are saved or given up. For what names the volume, so that
    /// its edits are not lost.
    void save_edits_first(const std::function<void()>& action);
    /// The samples, if they have edits that were not saved; else null.
    std::shared_ptr<const Samples> unsaved() const;

  private:
    bool go_on(const QString& question, const QString& without,
               const std::function<void()>& once_saved);
    void write_surface(const QString& path, const std::shared_ptr<SurfaceMesh>& mesh);

    Panel& panel_;
    BackgroundTask saving_;
    std::size_t many_triangles_ = 1000000;
};

/// Saves edits where run::Data::rescue() finds a place; prints the name on standard error.
void rescue_edits(run::Data& data);

}  // namespace palpate::viewer
