// The cut as it is: every triangle with its solid part, every density, and the proxy's way.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "evaluation/walk_through/walk.hpp"

namespace palpate::evaluation {
namespace {

using Rows = std::vector<std::vector<double>>;

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

/// Everything in the cut that does not depend on a method.
struct Drawing {
    Rows edges, solid, contour;
    std::string labels;  // rows of x, y, "density"

    explicit Drawing(const Cut& cut) {
        for (int j = cut.low[1]; j <= cut.high[1]; ++j) {
            for (int i = cut.low[0]; i <= cut.high[0]; ++i) {
                const Corner corner = at(cut, i, j);
                labels += fmt::format("{} {} {}\n", corner.x, corner.y,
                                      fmt::format("{:.4g}", density(cut, corner)));
                if (i < cut.high[0] && j < cut.high[1]) add_square(cut, i, j);
            }
        }
    }

    static double density(const Cut& cut, const Corner& corner) {
        return cut.subject.isovalue + cut.subject.field.sign() * corner.excess;
    }
    static Corner at(const Cut& cut, double i, double j) {
        const Field& field = cut.subject.field;
        const Vec3 spacing = field.geometry().spacing;
        const Vec3 point(i * spacing[0], j * spacing[1], cut.z);
        return {point[0], point[1], field.sign() * (value_at(field, point) - cut.subject.isovalue)};
    }

    void add_square(const Cut& cut, int i, int j) {
        const Corner centre = at(cut, i + 0.5, j + 0.5);
        const std::array<Corner, 4> corners{at(cut, i, j), at(cut, i + 1, j), at(cut, i + 1, j + 1),
                                            at(cut, i, j + 1)};
        for (std::size_t c = 0; c < 4; ++c)
            add_triangle({centre, corners[c], corners[(c + 1) % 4]});
    }

    void add_triangle(const std::array<Corner, 3>& triangle) {
        add(edges, triangle[0]);
        add(edges, triangle[1]);
        add(edges, triangle[2]);
        edges.emplace_back();
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

    /// Rows of x, y, x and y of the label, text. Labels of close neighbours are put farther off,
    /// each more than the one before.
    std::string rows() const {
        constexpr double nearest = 0.4, step = 0.36, farthest = 1.2;  // [voxel]
        std::string rows;
        double off = 0;
        const Vec3* last = nullptr;
        for (const Mark& mark : marks_) {
            const bool is_close = last && (mark.point - *last).norm() < 0.65 * voxel_;
            off = is_close && off + step <= farthest ? off + step : nearest;
            last = &mark.point;
            const Vec3 label = mark.point + off * voxel_ * mark.out;
            rows += fmt::format("{} {} {} {} {}\n", mark.point[0], mark.point[1], label[0],
                                label[1], text_of(mark.numbers));
        }
        return rows;
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

std::string text_block(const std::string& name, const std::string& rows) {
    return "$" + name + " << EOD\n" + (rows.empty() ? "NaN NaN NaN NaN x\n" : rows) + "EOD\n";
}

Rows or_nothing(Rows rows) {
    if (rows.empty()) rows.push_back({std::nan(""), std::nan("")});
    return rows;
}

/// The data blocks of a walk: its way, crossings, SCPs and GOALs.
std::string blocks_of(const Cut& cut, const Walk& walk, const std::string& name) {
    const double voxel = cut.subject.field.geometry().spacing.minCoeff();
    Rows way{{walk.before[0], walk.before[1]}}, crossings;
    Marks scps(voxel), goals(voxel);
    // Numbers stand across the way, on the side that was free at the start.
    const Field& field = cut.subject.field;
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
        way.push_back({step.point[0], step.point[1]});
        if (step.kind == StepKind::cross) {
            crossings.push_back({step.point[0], step.point[1]});
            continue;
        }
        put_scp(step.point, ++number);
        if (goal) goals.put(*goal, Vec3::UnitX(), number);
        goal.reset();
    }
    return block("way" + name, way) + block("crossings" + name, or_nothing(crossings)) +
           text_block("scps" + name, scps.rows()) + text_block("goals" + name, goals.rows());
}

/// In the order in which they are drawn: later ones on top. `$` data of the walk end in `name`.
std::string panel(const Walk& walk, const std::string& name) {
    const std::string way = "$way" + name, crossings = "$crossings" + name;
    const std::string scps = "$scps" + name, goals = "$goals" + name;
    const auto numbered = [](const std::string& data, const char* look) {
        return data + " using 1:2:3 with labels noenhanced " + look + " notitle, ";
    };
    // With a thin line from the mark to its number.
    const std::string led = fmt::format(
        "{0} using 1:2:($3-$1):($4-$2) with vectors nohead lc rgb '#8a3c00' lw 0.7 notitle, "
        "{0} using 3:4:5 with labels boxed noenhanced font ',12' tc rgb '#8a3c00' notitle, ",
        scps);
    return "set title " + gnuplot_text(walk.method) +
           " noenhanced\nplot $solid with filledcurves closed fc rgb '#dbe9f6' notitle, "
           "$edges with lines lc rgb '#c4c4c4' lw 1 notitle, "
           "$labels using 1:2 with points pt 7 ps 0.4 lc rgb '#707070' notitle, " +
           numbered("$labels", "font ',9' tc rgb '#707070' offset 1.2,-0.5") +
           "$contour with lines lc rgb '#0072B2' lw 3 notitle, " + goals +
           " using 1:2 with points pt 12 ps 2 lw 2 lc rgb '#009E73' notitle, " + goals +
           " using 1:2:5 with labels noenhanced font ',12' tc rgb '#006b4e' left offset 1.2,0 "
           "notitle, " +
           way + " with lines lc rgb '#D55E00' lw 2.5 notitle, " + crossings +
           " with points pt 7 ps 0.6 lc rgb '#D55E00' notitle, " + scps +
           " using 1:2 with points pt 7 ps 1.3 lc rgb '#D55E00' notitle, " + led +
           "$hips using 1:2 with points pt 2 ps 1.6 lw 3 lc rgb '#000000' notitle, " +
           numbered("$hips", "font ',11' left offset 1.2,0") + "-1 notitle\n";
}

/// What the marks mean, in an empty panel under the others.
std::string key(double height, double isovalue) {
    return fmt::format(
        "set lmargin at screen 0.02\nset rmargin at screen 0.98\nset bmargin at screen 0\n"
        "set tmargin at screen {}\nunset border\nunset tics\nunset grid\nunset title\n"
        "set size noratio\nset xlabel ''\nset ylabel ''\nset xrange [0:1]\nset yrange [0:1]\n"
        "set key noenhanced center horizontal maxcols 4 width 1\nplot -1 notitle, "
        "keyentry with points pt 7 ps 1.3 lc rgb '#D55E00' title 'SCP, after each move', "
        "keyentry with points pt 7 ps 0.6 lc rgb '#D55E00' title 'wall crossed', "
        "keyentry with points pt 12 ps 2 lw 2 lc rgb '#009E73' title 'GOAL of a move', "
        "keyentry with points pt 2 ps 1.6 lw 3 lc rgb '#000000' title 'HIP', "
        "keyentry with lines lc rgb '#0072B2' lw 3 title 'isosurface at {:g}', "
        "keyentry with boxes fs solid 1 fc rgb '#dbe9f6' title 'solid', "
        "keyentry with lines lc rgb '#c4c4c4' title 'tetrahedra in the cut', "
        "keyentry with points pt 7 ps 0.4 lc rgb '#707070' title 'sample, with its density'\n"
        "unset multiplot\n",
        height, isovalue);
}

}  // namespace

Figure walk_figure(const Cut& cut, const std::vector<Walk>& walks) {
    const Vec3 spacing = cut.subject.field.geometry().spacing;
    const double left = (cut.low[0] - 0.4) * spacing[0], right = (cut.high[0] + 0.8) * spacing[0];
    const double bottom = (cut.low[1] - 0.6) * spacing[1], top = (cut.high[1] + 0.4) * spacing[1];
    const Drawing drawing(cut);
    Figure figure;
    figure.caption = fmt::format(
        "{}: one update in a plane cut of the lattice by {} and by {}. 0 is the SCP before the "
        "update, the numbers are its moves; GOALs are shown where they are not the HIP.",
        cut.subject.name, walks.front().method, walks.back().method);
    constexpr double key_pixels = 90, axis_pixels = 60, title_pixels = 40, panel_pixels = 680;
    const double panel_height =
        std::clamp(panel_pixels * (top - bottom) / (right - left), 200.0, 1400.0);
    figure.size = {1500, static_cast<int>(panel_height + key_pixels + axis_pixels + title_pixels)};
    const double height = figure.size.height;
    figure.script =
        block("solid", or_nothing(drawing.solid)) + block("edges", drawing.edges) +
        block("contour", or_nothing(drawing.contour)) + text_block("labels", drawing.labels) +
        text_block("hips", fmt::format("{} {} \"HIP before\"\n{} {} HIP\n", cut.hip_before[0],
                                       cut.hip_before[1], cut.hip[0], cut.hip[1]));
    for (std::size_t w = 0; w < walks.size(); ++w) {
        figure.script += blocks_of(cut, walks[w], std::to_string(w));
    }
    figure.script += fmt::format(
        "set multiplot\nunset key\nunset grid\nset style textbox opaque noborder margins 0.6,0.6\n"
        "set size ratio -1\nset xrange [{}:{}]\n"
        "set yrange [{}:{}]\nset xlabel 'x [mm]'\nset ylabel 'y [mm]'\n",
        left, right, bottom, top);
    for (std::size_t w = 0; w < walks.size(); ++w) {
        const double width = 1.0 / double(walks.size());
        figure.script += fmt::format(
            "set lmargin at screen {}\nset rmargin at screen {}\nset bmargin at screen {}\n"
            "set tmargin at screen {}\n",
            double(w) * width + 0.055, double(w + 1) * width - 0.005,
            (key_pixels + axis_pixels) / height, 1 - title_pixels / height);
        figure.script += panel(walks[w], std::to_string(w));
    }
    figure.script += key(key_pixels / height, cut.subject.isovalue);
    return figure;
}

}  // namespace palpate::evaluation
