// walk-through (the paper's Fig. 5 and 6): the SCPs of one update in a plane cut of the lattice,
// and where the gradient method ends on the same picture.
#include "evaluation/walk_through/walk.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "evaluation/contestants.hpp"
#include "evaluation/experiment.hpp"

namespace palpate::evaluation {
namespace {

/// In the field that the method feels.
double excess_of_range(const Cut& cut, const std::string& method, const Vec3& physical) {
    const Field field = as_felt_by(contestant(method), cut.subject).field;
    return field.sign() * (value_at(field, physical) - cut.subject.isovalue) / field.range();
}

const char* name_of(StepKind kind) {
    constexpr std::array names{"place", "free move", "cross", "goal", "slide", "recover", "press"};
    return names[static_cast<std::size_t>(kind)];
}

/// "cell 2 4 0, face +z, edge -y": the axes are the grid's.
std::string text_of(const Tetrahedron& t) {
    const auto side = [&](std::size_t i) {
        return fmt::format("{}{}", t.sign[i] > 0 ? '+' : '-', "xyz"[t.axis[i]]);
    };
    return fmt::format("cell {} {} {}, face {}, edge {}", t.cell[0], t.cell[1], t.cell[2], side(0),
                       side(1));
}

void add_rows(Table& table, const Cut& cut, const Walk& walk) {
    const Field field = as_felt_by(contestant(walk.method), cut.subject).field;
    const auto add = [&](double number, const char* kind, const Vec3& scp, const Vec3& goal,
                         const std::string& tetrahedron) {
        table.add({{"volume", cut.subject.name},
                   {"method", walk.method},
                   {"step", number},
                   {"kind", kind},
                   {"scp_x_mm", scp[0]},
                   {"scp_y_mm", scp[1]},
                   {"goal_x_mm", goal[0]},
                   {"goal_y_mm", goal[1]},
                   {"density", value_at(field, scp)},
                   {"isovalue", cut.subject.isovalue},
                   {"tetrahedron", tetrahedron},
                   {"distance_to_hip_mm", (scp - cut.hip).norm()}});
    };
    add(0, "before", walk.before, cut.hip_before, "");
    double number = 0;
    for (const Step& step : walk.steps) {
        add(++number, name_of(step.kind), step.point, step.goal, text_of(step.tetrahedron));
    }
}

/// The largest excess of any point of the path: its corners, and a hundred points of each piece.
double worst_on_path(const Cut& cut, const Walk& walk) {
    constexpr int parts = 100;
    double worst = -1;
    Vec3 from = walk.before;
    for (const Step& step : walk.steps) {
        for (int i = 0; i <= parts; ++i) {
            const Vec3 point = from + (step.point - from) * (double(i) / parts);
            worst = std::max(worst, excess_of_range(cut, walk.method, point));
        }
        from = step.point;
    }
    return worst;
}

double farthest_off_plane(const Cut& cut, const std::vector<Walk>& walks) {
    double farthest = 0;
    for (const Walk& walk : walks) {
        for (const Step& step : walk.steps) {
            farthest = std::max(farthest, std::abs(step.point[2] - cut.z));
        }
    }
    return farthest;
}

void add_claims(std::vector<Claim>& claims, const Cut& cut, const std::vector<Walk>& walks,
                bool own_cut) {
    for (const Walk& walk : walks) {
        if (walk.method != "exact" && walk.method != "paper" && walk.method != "smooth") continue;
        const double worst = worst_on_path(cut, walk);
        claims.push_back(
            {fmt::format("{}: every SCP of {} and the path between them is outside to "
                         "{:g} of the data's range",
                         cut.subject.name, walk.method, granted),
             worst <= granted,
             fmt::format("largest excess {:.2g} over {} steps", worst, walk.steps.size())});
    }
    const double off = farthest_off_plane(cut, walks);
    claims.push_back(
        {fmt::format("{}: all motion stays in the plane that is shown", cut.subject.name),
         off <= 1e-9, fmt::format("farthest {:.2g} mm", off)});
    if (!own_cut) return;
    const auto gradient = std::find_if(walks.begin(), walks.end(),
                                       [](const Walk& walk) { return walk.method == "gradient"; });
    const double excess = excess_of_range(cut, gradient->method, gradient->end.scp);
    claims.push_back({fmt::format("{}: gradient ends inside, by more than a tenth of the data's "
                                  "range",
                                  cut.subject.name),
                      excess > 0.1, fmt::format("excess {:.3g}", excess)});
}

int moves_of(const Walk& walk) {
    return static_cast<int>(
        std::count_if(walk.steps.begin(), walk.steps.end(), [](const Step& step) {
            return step.kind != StepKind::goal && step.kind != StepKind::cross;
        }));
}

std::string counted(int count, const char* one, const char* many) {
    return fmt::format("{} {}", count, count == 1 ? one : many);
}

std::string paragraph_of(const Cut& cut, const std::vector<Walk>& walks) {
    std::string text;
    for (const Walk& walk : walks) {
        const double excess = excess_of_range(cut, walk.method, walk.end.scp);
        text += fmt::format("{}{} takes {} through {} and ends {:.3g} mm from the hand, {}",
                            text.empty() ? "" : "; ", walk.method,
                            counted(moves_of(walk), "move", "moves"),
                            counted(walk.end.tetrahedra, "tetrahedron", "tetrahedra"),
                            (walk.end.scp - cut.hip).norm(),
                            excess > 0.01 ? fmt::format("in the solid (density {:.3g}, level {:g})",
                                                        walk.end.density, cut.subject.isovalue)
                                          : std::string("outside or on the surface"));
    }
    return fmt::format(
        "{}: one update, in which the hand jumps from ({:.2f}, {:.2f}) to ({:.2f}, {:.2f}) mm. The "
        "volume is the same in every slice, so the motion stays in a plane of samples, and the cut "
        "shows all of it: squares between four samples, each of four triangles with a linear "
        "density; of the smooth field the squares lie round the samples, with a cubic in each "
        "triangle. {}.",
        cut.subject.name, cut.hip_before[0], cut.hip_before[1], cut.hip[0], cut.hip[1], text);
}

}  // namespace

Walk walk_in(const Cut& cut, const std::string& method) {
    const Contestant& mover = contestant(method);
    const ProxyMethod move = mover.method;
    const Field field = as_felt_by(mover, cut.subject).field;
    Walk walk;
    walk.method = method;
    Proxy proxy;
    place(proxy, field, cut.start, cut.subject.isovalue);
    move(proxy, field, cut.hip_before, {}, {});
    walk.before = proxy.scp_physical;
    const auto keep = [](const Step& step, void* steps) {
        static_cast<std::vector<Step>*>(steps)->push_back(step);
    };
    walk.end = move(proxy, field, cut.hip, {}, {keep, &walk.steps});
    return walk;
}

Result walk_through(const Options& options) {
    std::vector<Cut> cuts;
    for (const Subject& subject : options.subjects) cuts.push_back(slice_of(subject));
    const bool own_cut = cuts.empty();
    if (own_cut) cuts.push_back(wall_cut());
    Result result;
    for (const Cut& cut : cuts) {
        options.progress(double(&cut - cuts.data()) / double(cuts.size()));
        std::vector<Walk> walks, shown;
        for (const Contestant& one : contestants()) {
            walks.push_back(walk_in(cut, one.name));
            add_rows(result.table, cut, walks.back());
        }
        // The method of choice, and the gradient method or, if that is it, what it should do.
        const std::string other = options.method == "gradient" ? "exact" : "gradient";
        for (const std::string& method : {options.method, other})
            shown.push_back(walk_in(cut, method));
        const auto number = &cut - cuts.data() + 1;
        result.figures.push_back(walk_figure(cut, shown));
        if (number > 1) result.figures.back().suffix = std::to_string(number);
        result.figures.push_back(walk_figure(cut, {walk_in(cut, "smooth")}));
        result.figures.back().suffix = number > 1 ? fmt::format("smooth-{}", number) : "smooth";
        add_claims(result.claims, cut, walks, own_cut);
        result.paragraph += (result.paragraph.empty() ? "" : " ") + paragraph_of(cut, walks);
    }
    return result;
}

}  // namespace palpate::evaluation
