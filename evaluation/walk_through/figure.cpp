// Draws a cut: every triangle with its solid part, every density, and the path of the proxy.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "evaluation/contestants.hpp"
#include "evaluation/walk_through/walk.hpp"

namespace palpate::evaluation {
namespace {

/// A corner of the cut's triangulation.
struct Corner {
    double x = 0, y = 0;  // [mm]
    double excess = 0;    // of the density, > 0 in the solid
};

Corner between(const Corner& a, const Corner& b) {
    const double part = a.excess / (a.excess - b.excess);
    return {a.x + part * (b.x - a.x), a.y + part * (b.y - a.y), 0};
}

void add(Rows& rows, const Corner& corner) {
    rows.push_back({corner.x, corner.y});
}

/// Everything in the cut that is the field's.
class Drawing {
  public:
    Drawing(const Cut& cut, const Contestant& contestant)
        : cut_(cut), field_(as_felt_by(contestant, cut.subject).field) {
        const bool is_smooth = field_.interpolation() == Interpolation::cubic;
        const double begin = is_smooth ? -0.5 : 0;  // of a square, from its first sample
        parts_ = is_smooth ? 6 : 1;
        for (int j = cut.low[1]; j <= cut.high[1]; ++j) {
            for (int i = cut.low[0]; i <= cut.high[0]; ++i) {
                const Corner corner = at(i, j);
                add(densities.rows, corner);
                densities.labels.push_back(fmt::format("{:.4g}", density(corner)));
                if (is_smooth || (i < cut.high[0] && j < cut.high[1])) {
                    add_square(i + begin, j + begin);
                }
            }
        }
        densities.text = {.size = 9, .right = 1.2, .up = -0.5};
    }

    Rows edges, solid, contour;
    Series densities{Draw::text, "", {"#707070"}, {}};

  private:
    double density(const Corner& corner) const {
        return cut_.subject.isovalue + field_.sign() * corner.excess;
    }
    Corner at(double i, double j) const {
        const Vec3 spacing = field_.geometry().spacing;
        const Vec3 point(i * spacing[0], j * spacing[1], cut_.z);
        return {point[0], point[1],
                field_.sign() * (value_at(field_, point) - cut_.subject.isovalue)};
    }

    void add_square(double i, double j) {
        using Place = std::array<double, 2>;
        const Place centre{i + 0.5, j + 0.5};
        const std::array<Place, 4> corners{{{i, j}, {i + 1, j}, {i + 1, j + 1}, {i, j + 1}}};
        for (std::size_t c = 0; c < 4; ++c) {
            const Place &a = corners[c], &b = corners[(c + 1) % 4];
            for (const Place& corner : {centre, a, b}) add(edges, at(corner[0], corner[1]));
            edges.emplace_back();
            // In parts so small that the field is as good as linear in them.
            const auto within = [&](int u, int v) {
                const double s = double(u) / parts_, t = double(v) / parts_;
                return at(centre[0] + s * (a[0] - centre[0]) + t * (b[0] - centre[0]),
                          centre[1] + s * (a[1] - centre[1]) + t * (b[1] - centre[1]));
            };
            for (int u = 0; u < parts_; ++u) {
                for (int v = 0; u + v < parts_; ++v) {
                    add_part({within(u, v), within(u + 1, v), within(u, v + 1)});
                    if (u + v + 1 == parts_) continue;
                    add_part({within(u + 1, v), within(u + 1, v + 1), within(u, v + 1)});
                }
            }
        }
    }

    void add_part(const std::array<Corner, 3>& triangle) {
        Rows part;
        std::vector<Corner> on_level;
        for (std::size_t c = 0; c < 3; ++c) {
            const Corner &from = triangle[c], &to = triangle[(c + 1) % 3];
            if (from.excess > 0) add(part, from);
            if ((from.excess > 0) == (to.excess > 0)) continue;
            on_level.push_back(between(from, to));
            add(part, on_level.back());
        }
        if (part.size() >= 3) {
            part.push_back(part.front());
            solid.insert(solid.end(), part.begin(), part.end());
            solid.emplace_back();
        }
        if (on_level.size() == 2) {
            add(contour, on_level[0]);
            add(contour, on_level[1]);
            contour.emplace_back();
        }
    }

    const Cut& cut_;
    Field field_;
    int parts_ = 1;
};

/// Places that are marked with the numbers of the moves that end there.
class Marks {
  public:
    explicit Marks(double voxel) : voxel_(voxel) {}

    /// `out` is the unit vector in which the number is put off.
    void put(const Vec3& point, const Vec3& out, int number) {
        for (Mark& mark : marks_) {
            if ((mark.point - point).norm() > 0.15 * voxel_) continue;
            mark.numbers.push_back(number);
            return;
        }
        marks_.push_back({point, out, {number}});
    }

    /// Adds the marks, their numbers off them, and a thin line from each mark to its number.
    /// Numbers of close neighbours are put farther off, each more than the one before.
    void add_to(Panel& panel, const char* title, const Look& look) const {
        constexpr double nearest = 0.4, step = 0.36, farthest = 1.2;  // [voxel]
        Series marks{Draw::points, title, look, {}};
        Series numbers{Draw::text, "", {"#8a3c00"}, {}};
        Series leads{Draw::segments, "", {.colour = "#8a3c00", .width = 0.7}, {}};
        numbers.text.has_background = true;
        double off = 0;
        const Vec3* last = nullptr;
        for (const Mark& mark : marks_) {
            const bool is_close = last && (mark.point - *last).norm() < 0.65 * voxel_;
            off = is_close && off + step <= farthest ? off + step : nearest;
            last = &mark.point;
            const Vec3 label = mark.point + off * voxel_ * mark.out;
            marks.rows.push_back({mark.point[0], mark.point[1]});
            numbers.rows.push_back({label[0], label[1]});
            numbers.labels.push_back(text_of(mark.numbers));
            leads.rows.push_back({mark.point[0], mark.point[1], label[0], label[1]});
        }
        panel.series.insert(panel.series.end(), {marks, leads, numbers});
    }

    /// Adds the marks with their numbers at their right.
    void add_plain(Panel& panel, const char* title, const Look& look, const char* colour) const {
        Series marks{Draw::points, title, look, {}};
        Series numbers{Draw::text, "", {colour}, {}};
        numbers.text = {.align = Align::left, .right = 1.2};
        for (const Mark& mark : marks_) {
            marks.rows.push_back({mark.point[0], mark.point[1]});
            numbers.labels.push_back(text_of(mark.numbers));
        }
        numbers.rows = marks.rows;
        panel.series.insert(panel.series.end(), {marks, numbers});
    }

  private:
    struct Mark {
        Vec3 point, out;
        std::vector<int> numbers;  // rising
    };

    /// "2,5-7"
    static std::string text_of(const std::vector<int>& numbers) {
        std::string text;
        for (std::size_t i = 0; i < numbers.size();) {
            std::size_t end = i;
            while (end + 1 < numbers.size() && numbers[end + 1] == numbers[end] + 1) ++end;
            text += fmt::format("{}{}", text.empty() ? "" : ",", numbers[i]);
            if (end > i) text += fmt::format("-{}", numbers[end]);
            i = end + 1;
        }
        return text;
    }

    double voxel_;
    std::vector<Mark> marks_;
};

/// The path of the SCP, where it crosses walls, and its moves with their numbers.
void add_walk(Panel& panel, const Cut& cut, const Walk& walk) {
    const double voxel = cut.subject.field.geometry().spacing.minCoeff();
    Rows path{{walk.before[0], walk.before[1]}}, crossings;
    Marks scps(voxel), goals(voxel);
    // Numbers stand across the path, on the side that was free at the start.
    const Field field = as_felt_by(contestant(walk.method), cut.subject).field;
    const Vec3 into = field.sign() * gradient_at(field, walk.before);
    Vec3 out = into.norm() > 0 ? Vec3(-into.normalized()) : Vec3(Vec3::UnitY());
    Vec3 last = walk.before;
    const auto put_scp = [&](const Vec3& scp, int number) {
        const Vec3 move = scp - last;
        const Vec3 across = move.norm() > 0 ? Vec3(Vec3(-move[1], move[0], 0).normalized()) : out;
        out = across.dot(out) < 0 ? Vec3(-across) : across;
        last = scp;
        scps.put(scp, out, number);
    };
    put_scp(walk.before, 0);
    int number = 0;
    std::optional<Vec3> goal;  // of the move that follows
    for (const Step& step : walk.steps) {
        if (step.kind == StepKind::goal) {
            goal = step.goal;
            continue;
        }
        path.push_back({step.point[0], step.point[1]});
        if (step.kind == StepKind::cross) {
            crossings.push_back({step.point[0], step.point[1]});
            continue;
        }
        put_scp(step.point, ++number);
        if (goal) goals.put(*goal, Vec3::UnitX(), number);
        goal.reset();
    }
    goals.add_plain(panel, "GOAL of a move", {colours::green, Marker::open_diamond, 2}, "#006b4e");
    panel.add(Draw::line, "", {.colour = colours::vermilion, .width = 2.5}, std::move(path));
    panel.add(Draw::points, "wall crossed", {colours::vermilion, Marker::circle, 0.6},
              std::move(crossings));
    scps.add_to(panel, "SCP, after each move", {colours::vermilion, Marker::circle, 1.3});
}

Panel panel_of(const Cut& cut, const Walk& walk) {
    const Drawing drawing(cut, contestant(walk.method));
    Panel panel;
    panel.title = walk.method;
    panel.has_grid = false;
    panel.is_to_scale = true;
    const Vec3 spacing = cut.subject.field.geometry().spacing;
    panel.x = {.title = "x [mm]",
               .low = (cut.low[0] - 0.4) * spacing[0],
               .high = (cut.high[0] + 0.8) * spacing[0]};
    panel.y = {.title = "y [mm]",
               .low = (cut.low[1] - 0.6) * spacing[1],
               .high = (cut.high[1] + 0.4) * spacing[1]};
    panel.add(Draw::polygons, "solid", {"#dbe9f6"}, drawing.solid);
    panel.add(Draw::line, "tetrahedra in the cut", {.colour = "#c4c4c4", .width = 1},
              drawing.edges);
    panel.add(Draw::points, "sample, with its density", {"#707070", Marker::circle, 0.4},
              drawing.densities.rows);
    panel.series.push_back(drawing.densities);
    panel.add(Draw::line, fmt::format("isosurface at {:g}", cut.subject.isovalue),
              {.colour = colours::blue, .width = 3}, drawing.contour);
    add_walk(panel, cut, walk);
    const Rows hips{{cut.hip_before[0], cut.hip_before[1]}, {cut.hip[0], cut.hip[1]}};
    panel.add(Draw::points, "HIP", {colours::black, Marker::cross, 1.6, 3}, hips);
    Series& names = panel.add(Draw::text, "", {colours::black}, hips);
    names.labels = {"HIP before", "HIP"};
    names.text = {.size = 11, .align = Align::left, .right = 1.2};
    return panel;
}

}  // namespace

Figure walk_figure(const Cut& cut, const std::vector<Walk>& walks) {
    Figure figure;
    std::string methods = walks.front().method;
    for (std::size_t i = 1; i < walks.size(); ++i) methods += " and by " + walks[i].method;
    figure.caption = fmt::format(
        "{}: one update in a plane cut of the lattice by {}. 0 is the SCP before the update, the "
        "numbers are its moves; GOALs are shown where they are not the HIP.",
        cut.subject.name, methods);
    figure.columns = walks.size();
    for (const Walk& walk : walks) figure.panels.push_back(panel_of(cut, walk));
    const Panel& first = figure.panels.front();
    const double shape = (first.y.high - first.y.low) / (first.x.high - first.x.low);
    figure.width = walks.size() > 1 ? 1500 : 900;
    figure.height = static_cast<int>(std::clamp(650 * shape, 200.0, 1400.0)) + 180;
    return figure;
}

}  // namespace palpate::evaluation
