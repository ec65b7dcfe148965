// Reads files of tools in the background, because meshes may be large.
#include "apps/viewer/window/tool_controller.hpp"

#include <memory>

#include "apps/viewer/panel/panel.hpp"
#include "apps/viewer/panel/tool_controls.hpp"
#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/file_dialogs.hpp"
#include "apps/viewer/window/messages.hpp"
#include "palpate/io/mesh_file.hpp"
#include "palpate/io/tool_file.hpp"

namespace palpate::viewer {

ToolController::ToolController(Content& content, Panel& panel, Messages& messages)
    : content_(content), panel_(panel), messages_(messages), reader_(messages) {
    connect(&content, &Content::closed, this, [this] { reader_.abandon(); });
    connect(&panel.tool_controls(), &ToolControls::open_wanted, this, &ToolController::ask_open);
}

bool ToolController::is_tool_file(const QString& path) {
    return io::names_a_mesh(path.toStdString());
}

void ToolController::ask_open() {
    if (!content_.live()) return;
    const QString path = ask_open_tool_name(messages_.window());
    if (!path.isEmpty()) open(path);
}

void ToolController::open(const QString& path) {
    messages_.forget();
    if (!content_.live()) {
        return messages_.show_problem(
            tr("%1: this is a tool: open a volume first, and feel it, then open the tool")
                .arg(short_name(path)));
    }
    remember_folder(path);
    const auto read = std::make_shared<io::ToolSpec>();
    reader_.start(
        tr("Reading the tool"),
        [read, path](const io::Progress&) { *read = io::tool_spec_from(path.toStdString()); },
        [this, read, path] {
            if (content_.live()) panel_.tool_controls().add(short_name(path), *read);
        });
}

}  // namespace palpate::viewer
