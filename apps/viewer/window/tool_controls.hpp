// Tool: what touches. A point, a built-in shape, or one of a file, and how large it is.
#pragma once

#include <memory>
#include <vector>

#include "apps/viewer/panel/effect.hpp"
#include "apps/viewer/panel/form.hpp"
#include "apps/viewer/window/desk.hpp"
#include "apps/viewer/window/messages.hpp"
#include "palpate/io/tool_file.hpp"

namespace palpate::viewer {

class ToolControls : public EffectForm, protected Desk {
    Q_OBJECT

  public:
    explicit ToolControls(const Desk& desk);

    /// Whether a file that is dropped on the window is a tool: a mesh, by its name.
    static bool is_tool_file(const QString& path);
    /// Feels with the tool of a file. Errors are shown; the tool before stays then.
    void open(const QString& path);
    BackgroundTask& maker() { return maker_; }
    /// Another choice, chosen as by hand.
    void add(const QString& name, const io::ToolSpec& spec);

  private:
    struct Choice {
        QString name;
        io::ToolSpec spec;
    };
    /// A tool, and how it was made.
    struct Made {
        int row = 0;
        double scale = 1;
        std::shared_ptr<const Tool> tool;
        double spacing = 0;  // [mm] 0: as given
    };
    void begin() override;
    void choose(int row, double scale);
    void use(const Made& made);
    /// The one in the making, else the one in effect.
    const Made& wanted() const { return maker_.busy() ? making_ : shown_; }
    void show_tool();
    QString about() const;

    BackgroundTask reader_, maker_;
    Geometry geometry_{Index3::Zero()};
    std::size_t built_in_ = 0;     // of the choices, the first ones
    std::vector<Choice> choices_;  // then those of files and sessions
    Made shown_, asked_;           // in effect, and last asked for, whatever became of it
    Made making_;                  // without the tool
    QComboBox* choice_ = nullptr;
};

}  // namespace palpate::viewer
