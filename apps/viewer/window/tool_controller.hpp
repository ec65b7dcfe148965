// Opens files of tools: meshes and points.
#pragma once

#include <QObject>
#include <QString>

#include "apps/viewer/window/background_task.hpp"

namespace palpate::viewer {

class Content;
class Messages;
class Panel;

class ToolController : public QObject {
    Q_OBJECT

  public:
    ToolController(Content& content, Panel& panel, Messages& messages);

    /// Whether a file that is dropped on the window is a tool: a mesh, by its name.
    static bool is_tool_file(const QString& path);

    /// By a dialog.
    void ask_open();
    /// Feels with the tool of a file. Errors are shown; the tool before stays then.
    void open(const QString& path);
    bool settled() const { return !reader_.busy(); }
    BackgroundTask& reader() { return reader_; }

  private:
    Content& content_;
    Panel& panel_;
    Messages& messages_;
    BackgroundTask reader_;
};

}  // namespace palpate::viewer
