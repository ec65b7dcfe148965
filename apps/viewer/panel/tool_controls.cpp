// Lists tools in sizes that suit the data, and makes the one that is chosen.
#include "apps/viewer/panel/tool_controls.hpp"

#include <QFormLayout>

#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>
#include <variant>
#include <vector>

#include "apps/viewer/panel/layout.hpp"
#include "palpate/io/tool_file.hpp"

namespace palpate::viewer {
namespace {

/// The next of 1, 2, 5, 10, 20, ...
double rounded_up(double length) {
    const double decade = std::pow(10, std::floor(std::log10(length)));
    for (const double step : {1.0, 2.0, 5.0}) {
        if (step * decade >= length) return step * decade;
    }
    return 10 * decade;
}

/// A point, then each built-in shape: some voxels large, but for the fingertip, which has its own
/// size.
std::vector<io::ToolSpec> built_in_tools(const Geometry& geometry) {
    const double unit = rounded_up(3 * geometry.spacing.minCoeff());  // [mm]
    return {io::PointSpec{},        io::SphereSpec{unit},
            io::RodSpec{10 * unit}, io::NeedleSpec{20 * unit, 0.25 * unit},
            io::BurrSpec{unit},     io::BoxSpec{{4 * unit, 2 * unit, unit}},
            io::FingertipSpec{}};
}

struct MadeTool {
    std::shared_ptr<const Tool> tool;  ///< null: a point
    double spacing = 0;                ///< [mm] of its points
};

/// Of the tool `scale` times as large. Points are half a voxel apart, or farther where that would
/// be more than two thousand, which a tick has time for. Throws std::invalid_argument for what is
/// no tool.
MadeTool made_tool(const io::ToolSpec& spec, double scale, const Geometry& geometry) {
    constexpr std::size_t most_points = 2000;
    if (std::holds_alternative<io::PointSpec>(spec)) return {};
    const io::ToolSpec scaled = io::scaled(spec, scale);
    MadeTool made{nullptr, io::usual_spacing(geometry)};
    constexpr int tries = 60;
    for (int i = 0;; ++i) {
        try {
            made.tool = io::make_tool(scaled, made.spacing);
        } catch (const std::invalid_argument&) {  // most likely far too many points
            if (i == tries) throw;
            made.spacing *= 2;
            continue;
        }
        const std::size_t count = made.tool->points().size();
        const bool given = std::holds_alternative<io::PointsSpec>(spec);
        if (count <= most_points || given || i == tries) return made;
        made.spacing *= 1.02 * std::sqrt(double(count) / double(most_points));
    }
}

}  // namespace

ToolControls::ToolControls(Effect& effect)
    : effect_(effect),
      choice_(named(new QComboBox, "tool",
                    tr("What touches. No point of a tool ever goes through the surface; it pushes "
                       "and turns the hand. With the mouse, Ctrl and drag in the scene turn it."))),
      open_(named(new QPushButton(tr("Open…")), "open_tool",
                  tr("A tool from a file: a mesh (STL, PLY, OBJ, VTP) or points (CSV: x, y, z), in "
                     "mm from the point that is held"))),
      scale_(new Quantity("tool_scale", "×", 0.1, 10, 0.1, Quantity::Scale::factors)),
      about_(named(new QLabel, "tool_about")) {
    choice_->setAccessibleName(tr("Tool"));
    open_->setAccessibleName(tr("Open a tool"));
    choice_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    choice_->setMinimumContentsLength(8);
    let_wheel_pass(*choice_);
    about_->setWordWrap(true);
    scale_->set_value(1);
    scale_->set_accessible_name(tr("Size of the tool"));
    auto* form = new QFormLayout;
    add_row(*form, tr("Size"), scale_, tr("How many times as large as usual the tool is"));
    column_in(this, {row_of({choice_, open_}, 0)})->addLayout(form);
    layout()->addWidget(about_);
    connect(choice_, qOverload<int>(&QComboBox::activated), this,
            [this](int row) { choose(row, 1); });
    connect(scale_, &Quantity::wanted, this, [this](double scale) { choose(shown_.row, scale); });
    connect(open_, &QPushButton::clicked, this, &ToolControls::open_wanted);
    connect(&effect, &Effect::begun, this, [this] {
        scale_->drop();
        set_grid(effect_.field().geometry());
    });
    connect(&effect, &Effect::ended, this, &ToolControls::clear);
    connect(&effect, &Effect::changed, this, [this] { set_tool(effect_.settings().tool); });
    show({});
}

/// Of another volume: sizes suit it. Tools of files stay.
void ToolControls::set_grid(const Geometry& geometry) {
    if (geometry.size == geometry_.size && geometry.spacing == geometry_.spacing) return;
    const QString names[] = {tr("Point"), tr("Ball"), tr("Rod"),      tr("Needle"),
                             tr("Burr"),  tr("Box"),  tr("Fingertip")};
    geometry_ = geometry;
    choices_.erase(choices_.begin(), choices_.begin() + static_cast<std::ptrdiff_t>(built_in_));
    std::vector<Choice> all;
    for (const io::ToolSpec& spec : built_in_tools(geometry)) {
        all.push_back({names[all.size()], spec});
    }
    built_in_ = all.size();
    all.insert(all.end(), choices_.begin(), choices_.end());
    choices_ = std::move(all);
    before_ = {};
    show({});
}

void ToolControls::clear() {
    scale_->drop();
    before_ = {};
    show({});
}

void ToolControls::show(const Shown& now) {
    shown_ = now;
    choice_->clear();
    for (const Choice& choice : choices_) choice_->addItem(choice.name);
    choice_->setCurrentIndex(now.row);
    scale_->set_value(now.scale);
    scale_->setEnabled(now.tool != nullptr);
    if (!now.tool) return about_->setText({});
    const int count = static_cast<int>(now.tool->points().size());
    const QString points = now.spacing > 0 ? tr("%n points, %1 mm apart.", nullptr, count)
                                                 .arg(QString::number(now.spacing, 'g', 3))
                                           : tr("%n points.", nullptr, count);
    about_->setText(points + ' ' +
                    tr("Layers, pressing through, magnet and texture are felt with a point only."));
}

void ToolControls::choose(int row, double scale) {
    if (row < 0 || row >= static_cast<int>(choices_.size())) return;
    const Choice& choice = choices_[static_cast<std::size_t>(row)];
    Shown next{row, scale, nullptr, 0};
    try {
        const MadeTool made = made_tool(choice.spec, scale, geometry_);
        next.tool = made.tool;
        if (!std::holds_alternative<io::PointsSpec>(choice.spec)) next.spacing = made.spacing;
    } catch (const std::invalid_argument& e) {
        show(Shown(shown_));
        Q_EMIT nonsense(QString::fromStdString(e.what()));
        return;
    }
    before_ = shown_;
    show(next);
    effect_.request(command::UseTool{next.tool});
}

/// One that was not made here, such as a session's, is one more choice.
void ToolControls::set_tool(const std::shared_ptr<const Tool>& tool) {
    if (tool == shown_.tool) return;
    if (tool == before_.tool) return show(Shown(before_));
    if (!tool) return show({});
    const std::vector<Vec3> points(tool->points().begin(), tool->points().end());
    const QString name = tr("As given");
    if (choices_.size() > built_in_ && choices_.back().name == name) choices_.pop_back();
    choices_.push_back({name, io::PointsSpec{points, tool->turns(), tool->shape()}});
    show({static_cast<int>(choices_.size()) - 1, 1, tool, 0});
}

void ToolControls::add(const QString& name, const io::ToolSpec& spec) {
    choices_.push_back({name, spec});
    choose(static_cast<int>(choices_.size()) - 1, 1);
}

}  // namespace palpate::viewer
