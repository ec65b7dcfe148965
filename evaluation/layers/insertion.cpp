// Straight insertions against the closed form, and at which force each surface gave way.
#include "evaluation/layers/insertion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace palpate::evaluation {
namespace {

constexpr double most_off_share = 2;  // [%] of a puncture force, claimed
constexpr int halvings = 20;          // of a tick's way, to find where a surface gave way

/// A tick in which a layer's surface was touched.
struct Sample {
    int layer = -1;
    double depth = 0, force = 0;  // [mm], [N]
};

/// At which forces a layer's surface gave way.
struct Punctures {
    int count = 0;
    double sum = 0, worst_off = 0;                 // of what was extrapolated [N], [N]
    double greatest_sampled = 0, sampled_sum = 0;  // the last force before it [N]
};

/// What all insertions at one speed gave.
struct Insertions {
    std::int64_t ticks = 0;
    double squares = 0, worst = 0;  // of the error [N^2], [N]
    std::vector<Punctures> punctures;
};

/// Where on the way from `from` to `to` [mm of depth] a surface gives way: found with copies of
/// the renderer as it was at `from`.
double gives_way_at(const Renderer& before, const HandLine& line, double time, double from,
                    double to) {
    for (int i = 0; i < halvings; ++i) {
        const double middle = 0.5 * (from + to);
        Renderer copy = before;
        const Tick tick = render(copy, {.time = time, .position = line.at(middle)});
        (tick.layers.punctured > 0 ? to : from) = middle;
    }
    return to;
}

class InsertionRun {
  public:
    InsertionRun(const Field& field, const HandLine& line)
        : layers_(std::make_shared<Layers>(five_tissues())),
          line_(line),
          renderer_(layered_renderer(field, layers_)) {}

    template <class Visit>
    void run(double start, double speed, Insertions& found, Visit&& visit) {
        const double step = speed / layers_rate;
        for (int i = 0; start + i * step < phantom_depth; ++i) {
            const double depth = start + i * step;
            const Renderer before = renderer_;
            const double time = (i + 1) / layers_rate;
            const Tick tick = render(renderer_, {.time = time, .position = line_.at(depth)});
            const double wanted = spring_at(*layers_, depth);
            const double off = (tick.force + wanted * line_.inward).norm();
            found.squares += off * off;
            found.worst = std::max(found.worst, off);
            ++found.ticks;
            if (tick.layers.punctured > 0) note_puncture(before, time, depth, found);
            const double force = -tick.force.dot(line_.inward);
            older_ = last_;
            last_ = {tick.layers.touched, depth, force};
            visit(depth, force, wanted);
        }
    }

  private:
    /// Extends the line through the last two forces on the surface to where it gave way.
    void note_puncture(const Renderer& before, double time, double depth, Insertions& found) {
        if (last_.layer < 0 || older_.layer != last_.layer) return;
        const double at = gives_way_at(before, line_, time, last_.depth, depth);
        const double slope = (last_.force - older_.force) / (last_.depth - older_.depth);
        const double force = last_.force + slope * (at - last_.depth);
        Punctures& p = found.punctures[last_.layer];
        ++p.count;
        p.sum += force;
        p.worst_off = std::max(p.worst_off,
                               std::abs(force - puncture_force_of(layers_->layers[last_.layer])));
        p.sampled_sum += last_.force;
        p.greatest_sampled = std::max(p.greatest_sampled, last_.force);
    }

    std::shared_ptr<const Layers> layers_;
    HandLine line_;
    Renderer renderer_;
    Sample last_, older_;
};

using Cells = std::vector<NamedCell>;

Cells joined(Cells row, const Cells& where, const Cells& rest) {
    row.insert(row.end(), where.begin(), where.end());
    row.insert(row.end(), rest.begin(), rest.end());
    return row;
}

void add_punctures(Table& table, const Cells& where, const Insertions& found) {
    const Layers tissues = five_tissues();
    for (std::size_t i = 0; i < tissues.layers.size(); ++i) {
        const Punctures& p = found.punctures[i];
        const double wanted = puncture_force_of(tissues.layers[i]);
        if (!std::isfinite(wanted)) continue;
        table.add(joined({{"part", "puncture"}}, where,
                         {{"layer", tissues.layers[i].name},
                          {"punctures", double(p.count)},
                          {"puncture_force_n", wanted},
                          {"extrapolated_mean_n", p.sum / p.count},
                          {"extrapolated_off_percent", 100 * p.worst_off / wanted},
                          {"greatest_sampled_n", p.greatest_sampled},
                          {"greatest_sampled_mean_n", p.sampled_sum / p.count}}));
    }
}

/// More at a speed at which each has fewer ticks: a single tick on the other side of a surface that
/// gives way is off by the whole force.
int lines_at(double speed, bool quick) {
    const double slow = quick ? 1 : 50;
    return static_cast<int>(slow * std::pow(speed / insertion_speeds[0], quick ? 1 : 0.75));
}

}  // namespace

void add_insertions(Table& table, const LayeredPhantom& phantom, Interpolation interpolation,
                    bool quick, std::uint64_t seed) {
    Field field = phantom.field;
    field.set_interpolation(interpolation);
    for (const double speed : insertion_speeds) {
        const int lines = lines_at(speed, quick);
        const bool has_curve = interpolation == Interpolation::linear &&
                               (speed == std::ranges::min(insertion_speeds) ||
                                speed == std::ranges::max(insertion_speeds));
        scenes::Random random(seed);
        Insertions found;
        found.punctures.resize(five_tissues().layers.size());
        const Cells where{{"body", phantom.name},
                          {"field", std::string(name_of(interpolation))},
                          {"speed_mm_s", speed}};
        for (int i = 0; i < lines; ++i) {
            const HandLine line = phantom.line(random);
            const double start = random.uniform(5, 6);
            double written = -1;
            const auto visit = [&](double depth, double force, double wanted) {
                if (!has_curve || i > 0 || depth < written + curve_resolution) return;
                written = depth;
                table.add(
                    joined({{"part", "insertion curve"}}, where,
                           {{"depth_mm", depth}, {"force_n", force}, {"closed_form_n", wanted}}));
            };
            InsertionRun(field, line).run(start, speed, found, visit);
        }
        table.add(joined({{"part", "insertion"}}, where,
                         {{"runs", double(lines)},
                          {"ticks", double(found.ticks)},
                          {"rms_n", std::sqrt(found.squares / double(found.ticks))},
                          {"worst_n", found.worst}}));
        add_punctures(table, where, found);
    }
}

std::vector<Claim> insertion_claims(const Table& table) {
    const Table runs = table.where("part", "insertion");
    const Table punctures = table.where("part", "puncture");
    const double rms = largest(runs.numbers("rms_n"));
    const auto offs = punctures.numbers("extrapolated_off_percent");
    const bool all_gave_way = std::ranges::none_of(offs, [](double v) { return std::isnan(v); });
    double all = 0, expected = 0;
    for (const double count : punctures.numbers("punctures")) all += count;
    for (const double lines : runs.numbers("runs")) expected += 4 * lines;
    return {{fmt::format("straight in, the force is that of the closed form to {:g} N RMS, at "
                         "every speed, on either body and field",
                         most_force_error),
             !runs.rows().empty() && rms <= most_force_error, fmt::format("largest {:.2g} N", rms)},
            {fmt::format("every surface gives way at its puncture force to {:g} %: forces "
                         "extended along the spring to where it did",
                         most_off_share),
             all_gave_way && all == expected && largest(offs) <= most_off_share,
             fmt::format("{:.0f} of {:.0f} punctures, the worst {:.2g} % off", all, expected,
                         largest(offs))}};
}

Table insertion_summary(const Table& table) {
    Table summary;
    const Table runs = table.where("part", "insertion");
    for (std::size_t i = 0; i < runs.rows().size(); ++i) {
        const Table punctures = table.where("part", "puncture")
                                    .where("body", runs.text(i, "body"))
                                    .where("field", runs.text(i, "field"))
                                    .where("speed_mm_s", runs.number(i, "speed_mm_s"));
        double least = 1, most = 0;
        for (const auto& row : punctures.rows_of({"greatest_sampled_mean_n", "puncture_force_n"})) {
            least = std::min(least, row[0] / row[1]);
            most = std::max(most, row[0] / row[1]);
        }
        summary.add({{"body", runs.text(i, "body")},
                     {"field", runs.text(i, "field")},
                     {"speed [mm/s]", runs.number(i, "speed_mm_s")},
                     {"RMS error [N]", runs.number(i, "rms_n")},
                     {"puncture force, worst error [%]",
                      largest(punctures.numbers("extrapolated_off_percent"))},
                     {"greatest force sampled, mean [% of the puncture force]",
                      fmt::format("{:.0f} to {:.0f}", 100 * least, 100 * most)}});
    }
    return summary;
}

std::string insertion_sentences(const Table& table) {
    const Table punctures = table.where("part", "puncture").where("speed_mm_s", 1000.0);
    double least = 1;
    std::string which;
    for (std::size_t i = 0; i < punctures.rows().size(); ++i) {
        const double share = punctures.number(i, "greatest_sampled_mean_n") /
                             punctures.number(i, "puncture_force_n");
        if (share >= least) continue;
        least = share;
        which = punctures.text(i, "layer");
    }
    return fmt::format(
        "A hand goes straight through skin, fat, fascia and muscle onto bone, in bodies whose "
        "density is the depth: flat, and as concentric balls sampled every 0.125 mm. Compared with "
        "the closed form, each surface a spring until its puncture force, the force is off by at "
        "most {:.2g} N RMS, from 5 mm/s to 1 m/s. Extended along the spring to where the surface "
        "gave way, it is the puncture force to {:.2g} %. The greatest force that is sampled is "
        "less: at 1 m/s and {:g} Hz the hand moves a millimetre a tick, and the last force before "
        "a puncture is on average only {:.0f} % of the puncture force for {}, which is what a "
        "hand that fast feels.",
        largest(table.where("part", "insertion").numbers("rms_n")),
        largest(table.where("part", "puncture").numbers("extrapolated_off_percent")), layers_rate,
        100 * least, which);
}

}  // namespace palpate::evaluation
