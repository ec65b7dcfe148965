// Offers the sets of layers that suit the volume, and opens and saves others.
#pragma once

#include <QObject>
#include <QString>
#include <vector>

#include "apps/viewer/model/layer_set.hpp"
#include "apps/viewer/window/desk.hpp"
#include "apps/viewer/window/messages.hpp"
#include "palpate/io/layers_file.hpp"

namespace palpate::viewer {

class OverlayController;
struct Overlay;
struct LayersChoice;
struct SessionFile;

class LayersController : public Controller {
    Q_OBJECT

  public:
    LayersController(const Desk& desk, OverlayController& overlays);

    /// Whether a file is a set of layers, by its content.
    static bool is_layers_file(const QString& path);

    /// By a dialog.
    void ask_open();
    void ask_save();
    /// Feels the layers of a file. Errors are shown; the layers before stay then.
    void open(const QString& path);
    void save(const QString& path);
    void feel_labels();
    /// Each hand of the session feels its layers that lack_labels() once their label volume has
    /// been read; a name that is relative counts from the working folder, then from that of `file`.
    void restore(const SessionFile& session, const QString& file);
    bool settled() const { return !reader_.busy(); }
    BackgroundTask& reader() { return reader_; }

  private:
    LayersChoice choice_of(const io::LayersFile& file) const;
    LayersChoice choice_of_labels(const Overlay& labels) const;
    void limit_to_labels(LayersChoice& choice) const;
    void offer();
    void use(const LayersChoice& choice);
    void place(const SharedLayers& layers);
    void show_overlay();

    OverlayController& overlays_;
    std::vector<io::LayersFile> files_;  // built in, then those that were opened
    BackgroundTask reader_;              // of labels
};

}  // namespace palpate::viewer
