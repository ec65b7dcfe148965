// Offers the sets of layers that suit the volume, and opens and saves others.
#pragma once

#include <QObject>
#include <QString>
#include <vector>

#include "palpate/io/layers_file.hpp"

namespace palpate::viewer {

class Content;
class Messages;
class Panel;
struct LayersChoice;

class LayersController : public QObject {
    Q_OBJECT

  public:
    LayersController(Content& content, Panel& panel, Messages& messages);

    /// By a dialog.
    void ask_open();
    void ask_save();
    /// Feels the layers of a file. Errors are shown; the layers before stay then.
    void open(const QString& path);
    void save(const QString& path);

  private:
    LayersChoice choice_of(const io::LayersFile& file) const;
    void offer();

    Content& content_;
    Panel& panel_;
    Messages& messages_;
    std::vector<io::LayersFile> files_;  // built in, then those that were opened
};

}  // namespace palpate::viewer
