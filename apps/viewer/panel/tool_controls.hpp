// Tool: what touches. A point, a built-in shape, or one of a file, and how large it is.
#pragma once

#include <QComboBox>
#include <QLabel>
#include <QPushButton>
#include <QWidget>

#include <memory>
#include <vector>

#include "apps/viewer/panel/effect.hpp"
#include "apps/viewer/panel/inputs.hpp"
#include "palpate/io/tool_file.hpp"

namespace palpate::viewer {

class ToolControls : public QWidget {
    Q_OBJECT

  public:
    explicit ToolControls(Effect& effect);

    /// Another choice, chosen as by hand.
    void add(const QString& name, const io::ToolSpec& spec);

  Q_SIGNALS:
    /// What was asked for is no tool.
    void nonsense(const QString& why);
    void open_wanted();

  private:
    struct Choice {
        QString name;
        io::ToolSpec spec;
    };
    struct Shown {
        int row = 0;
        double scale = 1;
        std::shared_ptr<const Tool> tool;
        double spacing = 0;  // [mm] 0: as given
    };
    void set_grid(const Geometry& geometry);
    void clear();
    void set_tool(const std::shared_ptr<const Tool>& tool);
    void choose(int row, double scale);
    void show(const Shown& now);

    Effect& effect_;
    Geometry geometry_{Index3::Zero()};
    std::size_t built_in_ = 0;     // of the choices, the first ones
    std::vector<Choice> choices_;  // then those of files and sessions
    Shown shown_, before_;         // before the last request, should that be refused
    QComboBox* choice_;
    QPushButton* open_;
    Quantity* scale_;
    QLabel* about_;
};

}  // namespace palpate::viewer
