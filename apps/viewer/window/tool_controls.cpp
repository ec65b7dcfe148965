// Lists tools in sizes that suit the data, and makes the one that is chosen.
#include "apps/viewer/window/tool_controls.hpp"

#include <QLabel>

#include <cmath>
#include <exception>
#include <memory>
#include <stdexcept>
#include <utility>
#include <variant>
#include <vector>

#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/panel/sentences.hpp"
#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/file_dialogs.hpp"
#include "palpate/io/mesh_file.hpp"
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
    std::shared_ptr<const Tool> tool;
    double spacing = 0;  ///< [mm] of its points
};

/// Makes the tool, `scale` times as large. Its points are half a voxel apart, or farther if there
/// would be more than two thousand, for which a tick has no time. Throws std::invalid_argument if
/// the file is no tool. Exceptions of `progress` are passed on.
MadeTool made_tool(const io::ToolSpec& spec, double scale, const Geometry& geometry,
                   const io::Progress& progress) {
    constexpr std::size_t most_points = 2000;
    const io::ToolSpec scaled = io::scaled(spec, scale);
    MadeTool made{nullptr, io::usual_spacing(geometry)};
    constexpr int tries = 60;
    std::exception_ptr first;  // tells more than that a spacing is far too large
    for (int i = 0;; ++i) {
        progress(0);
        try {
            made.tool = io::make_tool(scaled, made.spacing, progress);
        } catch (const std::invalid_argument&) {  // most likely far too many points
            if (!first) first = std::current_exception();
            if (i == tries) std::rethrow_exception(first);
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

ToolControls::ToolControls(const Desk& desk)
    : EffectForm(desk.effect()), Desk(desk), reader_(messages_), maker_(messages_) {
    each_time(this, [this](QWidget&) { show_tool(); });
    choice_ = choice({"tool", "",
                      tr("What touches. No point of a tool ever goes through the surface; it "
                         "pushes and turns the hand. With the mouse, Ctrl and drag in the scene "
                         "turn it."),
                      tr("Tool")},
                     QStringList(),
                     {[this] { return wanted().row; }, [this](int row) { choose(row, 1); }});
    auto* open = button({"open_tool", tr("Open…"),
                         tr("A tool from a file: a mesh (STL, PLY, OBJ, VTP) or points (CSV: x, y, "
                            "z), in mm from the point that is held"),
                         tr("Open a tool")},
                        [this] {
                            const QString path = ask_open_name(
                                messages_.window(), tr("Open a tool"),
                                tr("Tools (*.stl *.ply *.obj *.vtp *.csv);;All files (*)"));
                            if (!path.isEmpty()) this->open(path);
                        });
    auto* form = form_in();
    auto* scale = quantity_in(
        *form,
        {"tool_scale", tr("Size"), tr("How many times as large as usual the tool is"),
         tr("Size of the tool")},
        {"×", 0.1, 10, 0.1, Quantity::Scale::factors},
        {[this] { return wanted().scale; }, [this](double to) { choose(wanted().row, to); }});
    each_time(scale, [this](Quantity& one) { one.setEnabled(wanted().row > 0); });
    auto* words = named(new QLabel, "tool_about");
    each_time(words, [this](QLabel& label) { label.setText(about()); });
    words->setWordWrap(true);
    choice_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    choice_->setMinimumContentsLength(8);
    column_in(this, {row_of({choice_, open}, 0)})->addLayout(form);
    layout()->addWidget(words);
    connect(&content_, &Content::closed, this, [this] {
        reader_.abandon();
        maker_.abandon();
    });
    connect(&maker_, &BackgroundTask::ended, this, &Form::refresh);
    refresh();
}

/// For another volume: offers sizes that suit it, and keeps tools of files.
void ToolControls::begin() {
    maker_.abandon();  // it was for another hand or another volume
    const Geometry& geometry = effect_.field().geometry();
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
    shown_ = asked_ = {};
}

/// A point needs no time.
void ToolControls::choose(int row, double scale) {
    if (row < 0 || row >= static_cast<int>(choices_.size())) return;
    maker_.abandon();
    making_ = {row, scale, nullptr, 0};
    const io::ToolSpec& spec = choices_[static_cast<std::size_t>(row)].spec;
    if (std::holds_alternative<io::PointSpec>(spec)) return use(making_);
    struct Result {
        MadeTool made;
        QString refusal;
    };
    const auto result = std::make_shared<Result>();
    maker_.start(
        tr("Making the tool"),
        [result, spec, scale, geometry = geometry_](const io::Progress& progress) {
            try {
                result->made = made_tool(spec, scale, geometry, progress);
            } catch (const std::invalid_argument& e) {
                result->refusal = in_words(e.what());
            }
        },
        [this, result, made = making_, given = std::holds_alternative<io::PointsSpec>(spec)] {
            if (!result->refusal.isEmpty()) return Q_EMIT nonsense(result->refusal);
            use({made.row, made.scale, result->made.tool, given ? 0 : result->made.spacing});
        });
}

void ToolControls::use(const Made& made) {
    asked_ = made;
    effect_.request(command::UseTool{made.tool});
}

/// One that was not made here, such as a session's, is one more choice.
void ToolControls::show_tool() {
    const std::shared_ptr<const Tool>& tool = effect_.settings().tool;
    if (tool == asked_.tool) {
        shown_ = asked_;
    } else if (!tool) {
        shown_ = {};
    } else if (tool != shown_.tool) {
        const std::vector<Vec3> points(tool->points().begin(), tool->points().end());
        const QString name = tr("This session's tool");
        if (choices_.size() > built_in_ && choices_.back().name == name) choices_.pop_back();
        choices_.push_back({name, io::PointsSpec{points, tool->turns(), tool->shape()}});
        shown_ = {static_cast<int>(choices_.size()) - 1, 1, tool, 0};
    }
    choice_->clear();
    for (const Choice& choice : choices_) choice_->addItem(choice.name);
}

QString ToolControls::about() const {
    if (!shown_.tool) return {};
    const int count = static_cast<int>(shown_.tool->points().size());
    const QString points = shown_.spacing > 0 ? tr("%n points, %1 mm apart.", nullptr, count)
                                                    .arg(QString::number(shown_.spacing, 'g', 3))
                                              : tr("%n points.", nullptr, count);
    return points + ' ' +
           tr("Layers, pressing through, magnet and texture are felt with a point only.");
}

bool ToolControls::is_tool_file(const QString& path) {
    return io::names_a_mesh(path.toStdString());
}

void ToolControls::open(const QString& path) {
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
        [read, path](const io::Progress& progress) {
            *read = io::tool_spec_from(path.toStdString(), progress);
        },
        [this, read, path] { add(short_name(path), *read); });
}

void ToolControls::add(const QString& name, const io::ToolSpec& spec) {
    choices_.push_back({name, spec});
    choose(static_cast<int>(choices_.size()) - 1, 1);
    refresh();
}

}  // namespace palpate::viewer
