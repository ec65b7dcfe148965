// Colour maps, presets, and interpolation between control points.
#include "apps/viewer/model/transfer.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace palpate::viewer {
namespace {

struct ColourMap {
    std::string name;
    std::vector<Colour> colours;
};

std::vector<ColourMap> all_maps() {
    return {{"grey", {{0, 0, 0}, {1, 1, 1}}},
            {"hot", {{0, 0, 0}, {0.9, 0, 0}, {1, 0.82, 0}, {1, 1, 1}}},
            {"bone", {{0, 0, 0}, {0.32, 0.32, 0.44}, {0.65, 0.78, 0.78}, {1, 1, 1}}},
            // After matplotlib's, at eighths.
            {"viridis",
             {{0.267, 0.005, 0.329},
              {0.279, 0.175, 0.483},
              {0.230, 0.322, 0.546},
              {0.173, 0.449, 0.558},
              {0.128, 0.567, 0.551},
              {0.158, 0.684, 0.502},
              {0.369, 0.789, 0.383},
              {0.678, 0.864, 0.190},
              {0.993, 0.906, 0.144}}},
            // After Moreland 2009, at quarters.
            {"cool-warm",
             {{0.230, 0.299, 0.754},
              {0.552, 0.690, 0.996},
              {0.865, 0.865, 0.865},
              {0.959, 0.598, 0.477},
              {0.706, 0.016, 0.150}}},
            {"spectrum", {{0, 0, 0.5}, {0, 0, 1}, {0, 1, 1}, {1, 1, 0}, {1, 0, 0}, {0.5, 0, 0}}}};
}

std::uint32_t packed(const Colour& c) {
    const auto byte = [](double part) {
        return static_cast<std::uint32_t>(std::lround(255 * std::clamp(part, 0.0, 1.0)));
    };
    return 0xff000000U | byte(c.red) << 16 | byte(c.green) << 8 | byte(c.blue);
}

}  // namespace

std::vector<std::string> colour_map_names() {
    std::vector<std::string> names;
    for (const ColourMap& map : all_maps()) names.push_back(map.name);
    return names;
}

ColourTable colour_table(const std::string& name) {
    const auto maps = all_maps();
    const auto found = std::ranges::find(maps, name, &ColourMap::name);
    if (found == maps.end()) throw std::invalid_argument("no colour map '" + name + "'");
    const auto& colours = found->colours;
    ColourTable table{};
    for (std::size_t i = 0; i < table.size(); ++i) {
        const double at = double(i) / 255 * double(colours.size() - 1);
        const auto before = std::min(static_cast<std::size_t>(at), colours.size() - 2);
        table[i] = packed(mixed(colours[before], colours[before + 1], at - double(before)));
    }
    return table;
}

pictures::Colour label_colour(int value) {
    // Hues a golden section apart are far from each other, however many there are.
    const double turn = std::abs(0.618034 * value), hue = 6 * (turn - std::floor(turn));
    const auto channel = [&](double at) {
        const double away = std::abs(std::fmod(hue + at, 6.0) - 3);
        return 0.25 + 0.65 * std::clamp(away - 1, 0.0, 1.0);
    };
    return {channel(0), channel(4), channel(2)};
}

namespace {

/// The levels that presets refer to [data units]. `outer` and `inner` divide the data into three
/// classes: in CT of a head air, soft tissue and bone.
struct Levels {
    double low, outer, inner, high;  // low < outer < inner < high
    bool hounsfield;
};

}  // namespace

bool looks_like_hounsfield(const Volume& volume) {
    constexpr double least = -4096, air = -500;  // what scanners write outside of their round view
    return (volume.type() == SampleType::int16 || volume.type() == SampleType::float32) &&
           volume.minimum() >= least && volume.minimum() <= air && volume.maximum() > 0;
}

namespace {

/// Whether a is less than b by more than rounding errors.
bool apart(double a, double b, double range) {
    return b - a > 1e-6 * range && b > a;
}

Levels levels_of(const run::Histogram& histogram, const Volume& volume) {
    const double low = volume.minimum();
    // A constant volume still has two ends, even where 1 is lost beside the value.
    const double high =
        std::max(low + volume.range(), std::nextafter(low, std::numeric_limits<double>::max()));
    const double range = high - low;
    double outer = low + range / 3;
    double inner = low + 2 * range / 3;
    const std::vector<double> suggested = run::suggested_isovalues(histogram);
    if (!suggested.empty() && apart(low, suggested.front(), range) &&
        apart(suggested.front(), high, range)) {
        outer = suggested.front();
        inner = 0.5 * (outer + high);
    }
    if (suggested.size() > 1 && apart(outer, suggested.back(), range) &&
        apart(suggested.back(), high, range)) {
        inner = suggested.back();
    }
    return {low, outer, inner, high, looks_like_hounsfield(volume)};
}

using Points = std::vector<ControlPoint>;

enum class For : std::uint8_t { ct, others, all };
struct Preset {
    const char* name;
    For data;
    Points relative;  ///< levels from 0, the least, over 1, `outer`, and 2, `inner`, to 3
    Points hounsfield = {};
};

std::vector<Preset> all_presets() {
    constexpr Colour skin{0.91, 0.73, 0.62}, muscle{0.72, 0.33, 0.25}, fat{0.93, 0.82, 0.58},
        meat{0.85, 0.45, 0.36}, bone = pictures::bone, ivory{0.99, 0.97, 0.90}, black{0, 0, 0},
                                white{1, 1, 1};
    const Points dense{{0, muscle, 0},    {1.75, muscle, 0},  {1.92, muscle, 0.06},
                       {2.05, bone, 0.4}, {2.4, ivory, 0.75}, {3, white, 0.9}},
        ct_bone{{-1024, muscle, 0}, {130, muscle, 0},   {230, muscle, 0.06},
                {350, bone, 0.35},  {700, ivory, 0.75}, {2000, white, 0.9}},
        outer{{0, skin, 0},     {0.6, skin, 0},  {1, skin, 0.35},
              {1.3, skin, 0.8}, {2, skin, 0.85}, {3, ivory, 0.95}},
        ct_skin{{-1024, skin, 0},  {-600, skin, 0},   {-350, skin, 0.35},
                {-150, skin, 0.8}, {250, skin, 0.85}, {600, ivory, 0.95}},
        soft{{0, fat, 0},         {0.8, fat, 0},    {1.1, fat, 0.04},
             {1.5, muscle, 0.22}, {1.9, meat, 0.3}, {3, ivory, 0.6}},
        ct_soft{{-1024, fat, 0},    {-200, fat, 0},   {-100, fat, 0.03}, {0, muscle, 0.08},
                {60, muscle, 0.25}, {150, meat, 0.3}, {300, bone, 0.3},  {1500, ivory, 0.6}},
        mr{{0, black, 0},
           {0.7, {0.16, 0.10, 0.09}, 0},
           {1.3, {0.55, 0.40, 0.36}, 0.12},
           {2, {0.84, 0.74, 0.68}, 0.3},
           {3, white, 0.65}},
        // Fluorescence: light in the dark, the more the brighter.
        microscopy{{0, {0, 0.02, 0.10}, 0},
                   {0.6, {0, 0.12, 0.28}, 0},
                   {1.2, {0.02, 0.48, 0.46}, 0.10},
                   {2, {0.32, 0.82, 0.36}, 0.4},
                   {3, {0.98, 0.98, 0.72}, 0.8}};
    return {{"CT bone", For::ct, dense, ct_bone},
            {"CT skin", For::ct, outer, ct_skin},
            {"CT soft tissue", For::ct, soft, ct_soft},
            {"Dense parts", For::others, dense, ct_bone},
            {"Outer surface", For::others, outer, ct_skin},
            {"Soft parts", For::others, soft, ct_soft},
            {"MR", For::others, mr},
            {"Microscopy", For::others, microscopy},
            {"Grey", For::all, {{0, black, 0}, {3, white, 0.5}}}};
}

Points points_of(const Preset& preset, const Levels& l) {
    if (l.hounsfield && !preset.hounsfield.empty()) return preset.hounsfield;
    const double ends[] = {l.low, l.outer, l.inner, l.high};
    Points points = preset.relative;
    for (ControlPoint& point : points) {
        const int part = std::min(static_cast<int>(point.level), 2);
        point.level = std::lerp(ends[part], ends[part + 1], point.level - part);
    }
    return points;
}

ControlPoint between(const ControlPoint& a, const ControlPoint& b, double level) {
    const double part = (level - a.level) / (b.level - a.level);
    return {level, mixed(a.colour, b.colour, part), std::lerp(a.opacity, b.opacity, part)};
}

/// The function restricted to the range of the data, so that an editor can show every point. Points
/// that coincide after rounding become one.
Points over_the_data(const Points& points, const Levels& l) {
    TransferFunction whole;
    for (const ControlPoint& point : points) {
        if (whole.points.empty() || point.level > whole.points.back().level) {
            whole.points.push_back(point);
        }
    }
    Points inside{sampled(whole, l.low)};
    for (const ControlPoint& point : whole.points) {
        if (point.level > inside.back().level && point.level < l.high) inside.push_back(point);
    }
    inside.push_back(sampled(whole, l.high));
    return inside;
}

double middle_of(const run::Histogram& histogram, std::size_t bin) {
    const auto bins = static_cast<double>(histogram.counts.size());
    return std::lerp(histogram.low, histogram.high, (double(bin) + 0.5) / bins);
}

double share_above(const run::Histogram& histogram, double level) {
    double above = 0;
    double all = 0;
    for (std::size_t i = 0; i < histogram.counts.size(); ++i) {
        all += static_cast<double>(histogram.counts[i]);
        if (middle_of(histogram, i) > level) above += static_cast<double>(histogram.counts[i]);
    }
    return all > 0 ? above / all : 0;
}

/// CT stored as Hounsfield units + 1000 or + 1024: most of what is not air is near water.
bool looks_like_shifted_hounsfield(const run::Histogram& histogram, const Levels& l) {
    if (!histogram.whole_numbers || l.low < -1 || l.high < 1500 || l.high > 4200) return false;
    double peak = 0;
    std::int64_t most = -1;
    for (std::size_t i = 0; i < histogram.counts.size(); ++i) {
        const double middle = middle_of(histogram, i);
        if (middle <= l.outer || histogram.counts[i] <= most) continue;
        most = histogram.counts[i];
        peak = middle;
    }
    return peak > 850 && peak < 1250;
}

bool is_ct(const run::Histogram& histogram, const Levels& levels) {
    return levels.hounsfield || looks_like_shifted_hounsfield(histogram, levels);
}

}  // namespace

std::vector<std::string> preset_names(const run::Histogram& histogram, const Volume& volume) {
    const bool ct = is_ct(histogram, levels_of(histogram, volume));
    std::vector<std::string> names;
    for (const Preset& p : all_presets()) {
        if (p.data != (ct ? For::others : For::ct)) names.emplace_back(p.name);
    }
    return names;
}

TransferFunction preset(std::string_view name, const run::Histogram& histogram,
                        const Volume& volume) {
    for (const Preset& p : all_presets()) {
        if (name != p.name) continue;
        const Levels levels = levels_of(histogram, volume);
        return {p.name, over_the_data(points_of(p, levels), levels)};
    }
    throw std::invalid_argument(fmt::format("there is no transfer function '{}'; there are: {}",
                                            name,
                                            fmt::join(preset_names(histogram, volume), ", ")));
}

std::string suggested_preset(const run::Histogram& histogram, const Volume& volume) {
    const Levels levels = levels_of(histogram, volume);
    if (is_ct(histogram, levels)) return "CT bone";
    if (volume.minimum() == volume.maximum()) return "Grey";
    if (volume.type() != SampleType::uint8) return "MR";
    // Stained cells are a few bright voxels in the dark.
    return share_above(histogram, levels.outer) < 0.05 ? "Microscopy" : "Dense parts";
}

ControlPoint sampled(const TransferFunction& transfer, double level) {
    const Points& points = transfer.points;
    const auto after = std::ranges::upper_bound(points, level, {}, &ControlPoint::level);
    ControlPoint point;
    if (after == points.begin()) {
        point = points.front();
    } else if (after == points.end()) {
        point = points.back();
    } else {
        return between(*(after - 1), *after, level);
    }
    point.level = level;
    return point;
}

}  // namespace palpate::viewer
