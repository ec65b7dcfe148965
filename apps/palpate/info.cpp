// palpate info: describes a volume and suggests isovalues.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/options/source_options.hpp"
#include "apps/palpate/commands.hpp"
#include "apps/palpate/outputs.hpp"
#include "apps/palpate/progress.hpp"
#include "palpate/filters/dequantize.hpp"
#include "palpate/io/error.hpp"
#include "palpate/io/orientation.hpp"
#include "palpate/run/statistics.hpp"

namespace palpate::app {
namespace {

constexpr int fine_bins = 256;  // for the suggestions and JSON
constexpr int text_bins = 16;
constexpr int bar_width = 40;

/// Side of the body to which each index axis runs: "L P S" for an axis-aligned LPS grid.
std::string orientation(const Geometry& geometry) {
    const std::string letters = io::orientation_of(geometry);
    return fmt::format("{}", fmt::join(letters, " "));
}

bool is_oblique(const Geometry& geometry) {
    return ((geometry.direction.cwiseAbs().array() > 1e-6) &&
            (geometry.direction.cwiseAbs().array() < 1 - 1e-6))
        .any();
}

std::string size_text(std::size_t bytes) {
    const auto b = static_cast<double>(bytes);
    if (b < 1e3) return fmt::format("{} bytes", bytes);
    if (b < 1e6) return fmt::format("{:.1f} kB", b / 1e3);
    return b < 1e10 ? fmt::format("{:.1f} MB", b / 1e6) : fmt::format("{:.1f} GB", b / 1e9);
}

nlohmann::ordered_json json_of(const std::optional<filters::Terraces>& terraces) {
    if (!terraces) return nullptr;
    const std::string suggestion = dequantize_suggestion(terraces);
    nlohmann::ordered_json json{{"level", terraces->level},
                                {"mask", terraces->mask},
                                {"labels", terraces->labels},
                                {"share", terraces->share},
                                {"tilt_degrees", terraces->tilt}};
    if (!suggestion.empty()) json["suggestion"] = suggestion;
    return json;
}

/// "CT in HU, to be shown from -160 to 240"; empty where the file does not say.
std::string text_of(const io::ValueInfo& values) {
    std::string text = values.modality;
    if (!values.units.empty())
        text += fmt::format("{}in {}", text.empty() ? "" : " ", values.units);
    if (values.window) {
        const auto [centre, width] = *values.window;
        text += fmt::format("{}to be shown from {:g} to {:g}", text.empty() ? "" : ", ",
                            centre - 0.5 * width, centre + 0.5 * width);
    }
    return text;
}

nlohmann::ordered_json json_of(const io::ValueInfo& values) {
    nlohmann::ordered_json json{
        {"modality", values.modality},
        {"units", values.units},
        {"window", nullptr},
        {"padding", values.padding ? nlohmann::ordered_json(*values.padding) : nullptr}};
    if (values.window) {
        json["window"] = {{"centre", values.window->centre}, {"width", values.window->width}};
    }
    return json;
}

/// Memory of all samples of the grid.
std::size_t bytes_of(const Samples& samples) {
    return static_cast<std::size_t>(sample_count(samples.geometry())) * size_of(samples.type());
}

/// Size and spacing of each level of a store, the finest first. Empty for other volumes.
nlohmann::ordered_json levels_json(const run::LoadedVolume& loaded) {
    auto levels = nlohmann::ordered_json::array();
    if (!loaded.streamed) return levels;
    for (const stream::Level& level : loaded.streamed->store->info().levels) {
        const Geometry& g = level.geometry;
        levels.push_back({{"size", {g.size[0], g.size[1], g.size[2]}},
                          {"spacing_mm", {g.spacing[0], g.spacing[1], g.spacing[2]}}});
    }
    return levels;
}

nlohmann::ordered_json channels_json(const run::LoadedVolume& loaded) {
    auto channels = nlohmann::ordered_json::array();
    if (loaded.streamed) channels = loaded.streamed->store->info().channels;
    return channels;
}

void print_levels(const stream::Store& store) {
    const std::vector<stream::Level>& levels = store.info().levels;
    for (std::size_t i = 0; levels.size() > 1 && i < levels.size(); ++i) {
        const Geometry& g = levels[i].geometry;
        fmt::print("level {:<6} {} x {} x {}, spacing {:g} x {:g} x {:g} mm\n", i, g.size[0],
                   g.size[1], g.size[2], g.spacing[0], g.spacing[1], g.spacing[2]);
    }
}

void print_channels(const stream::StoreInfo& info) {
    std::string names;
    for (const std::string& name : info.channels) names += (names.empty() ? "" : ", ") + name;
    if (!names.empty()) fmt::print("channels     {} ({} was taken)\n", names, info.channel);
}

nlohmann::ordered_json json_of(const run::LoadedVolume& loaded, const run::Histogram& histogram,
                               const std::vector<double>& suggested,
                               const std::optional<filters::Terraces>& terraces) {
    const auto samples = run::start_samples(loaded);
    const Geometry& g = samples->geometry();
    const auto list = [](const auto& v) { return nlohmann::json::array({v[0], v[1], v[2]}); };
    nlohmann::json direction = nlohmann::json::array();
    for (int axis = 0; axis < 3; ++axis) direction.push_back(list(Vec3(g.direction.col(axis))));
    return {{"name", io::without_secrets(loaded.name)},
            {"format", loaded.format},
            {"size", list(g.size)},
            {"type", name_of(samples->type())},
            {"levels", levels_json(loaded)},
            {"channels", channels_json(loaded)},
            {"spacing_mm", list(g.spacing)},
            {"origin_mm", list(g.origin)},
            {"direction", direction},
            {"orientation", g.oriented ? nlohmann::ordered_json(orientation(g)) : nullptr},
            {"spacing_known", g.measured},
            {"values", json_of(loaded.values)},
            {"minimum", samples->minimum()},
            {"maximum", samples->maximum()},
            {"mean", histogram.mean},
            {"standard_deviation", histogram.deviation},
            {"memory_bytes", bytes_of(*samples)},
            {"time_steps", loaded.time_steps},
            {"frame_times_s", loaded.sequence.times},
            {"histogram",
             {{"low", histogram.low}, {"high", histogram.high}, {"counts", histogram.counts}}},
            {"suggested_isovalues", suggested},
            {"terraces", json_of(terraces)},
            {"notes", loaded.notes}};
}

void print_histogram(const run::Histogram& fine) {
    // Bars on a logarithmic scale: air outnumbers everything else in most scans.
    const std::size_t group = (fine.counts.size() + text_bins - 1) / text_bins;
    const double width = (fine.high - fine.low) / static_cast<double>(fine.counts.size());
    std::vector<std::int64_t> coarse;
    for (std::size_t i = 0; i < fine.counts.size(); i += group) {
        std::int64_t sum = 0;
        for (std::size_t j = i; j < std::min(i + group, fine.counts.size()); ++j) {
            sum += fine.counts[j];
        }
        coarse.push_back(sum);
    }
    const double most = std::log1p(static_cast<double>(*std::ranges::max_element(coarse)));
    fmt::print("histogram (bars logarithmic)\n");
    for (std::size_t i = 0; i < coarse.size(); ++i) {
        const double low = fine.low + width * static_cast<double>(i * group);
        const auto bar =
            static_cast<int>(std::lround(bar_width * std::log1p(double(coarse[i])) / most));
        fmt::print("  from {:<10.6g} {:<{}} {}\n", low, std::string(std::size_t(bar), '#'),
                   bar_width, coarse[i]);
    }
}

void print_text(const run::LoadedVolume& loaded, const run::Histogram& histogram,
                const std::vector<double>& suggested,
                const std::optional<filters::Terraces>& terraces) {
    const auto samples = run::start_samples(loaded);
    const Geometry& g = samples->geometry();
    const Vec3 extent = g.size.cast<double>().cwiseProduct(g.spacing);
    fmt::print("{}\n", io::without_secrets(loaded.name));
    fmt::print("format       {}\n", loaded.format);
    fmt::print("size         {} x {} x {} samples, {}\n", g.size[0], g.size[1], g.size[2],
               name_of(samples->type()));
    if (loaded.streamed) {
        print_levels(*loaded.streamed->store);
        print_channels(loaded.streamed->store->info());
    }
    if (loaded.time_steps > 1) fmt::print("time steps   {}\n", loaded.time_steps);
    const std::vector<double>& times = loaded.sequence.times;
    if (!times.empty()) {
        fmt::print("frames       from {:g} to {:g} s, period {:g} s\n", times.front(), times.back(),
                   loaded.sequence.period);
    }
    fmt::print("spacing      {:g} x {:g} x {:g} mm{}\n", g.spacing[0], g.spacing[1], g.spacing[2],
               g.measured ? "" : ", assumed: the file gives none (--spacing)");
    fmt::print("extent       {:g} x {:g} x {:g} mm\n", extent[0], extent[1], extent[2]);
    fmt::print("origin       {:g}, {:g}, {:g} mm (LPS)\n", g.origin[0] + 0.0, g.origin[1] + 0.0,
               g.origin[2] + 0.0);  // no -0
    fmt::print("orientation  {}{}\n",
               g.oriented ? "axes run towards " + orientation(g)
                          : "not known: the file gives none (--orientation)",
               g.oriented && is_oblique(g) ? " (oblique)" : "");
    const std::string values = text_of(loaded.values);
    if (!values.empty()) fmt::print("values       {}\n", values);
    if (loaded.values.padding) {
        fmt::print("padding      {:g}: not measured, left out of mean, isovalues and histogram\n",
                   *loaded.values.padding);
    }
    fmt::print("range        {:g} to {:g}, mean {:.4g}, standard deviation {:.4g}\n",
               samples->minimum(), samples->maximum(), histogram.mean, histogram.deviation);
    fmt::print("memory       {}\n", size_text(bytes_of(*samples)));
    std::string levels;
    for (const double level : suggested) {
        const double part = (level - loaded.volume.minimum()) / loaded.volume.range();
        levels += fmt::format("{}{:.6g} ({:.0f}%)", levels.empty() ? "" : ", ", level, 100 * part);
    }
    fmt::print("isovalues    {}\n",
               levels.empty() ? "none: the data are constant" : "try " + levels);
    const std::string suggestion = dequantize_suggestion(terraces);
    if (!suggestion.empty()) fmt::print("terraces     try {}\n", suggestion);
    print_histogram(histogram);
}

}  // namespace

void add_info(CLI::App& app) {
    auto options = std::make_shared<SourceOptions>();
    auto json = std::make_shared<bool>(false);
    CLI::App* command = app.add_subcommand("info", "Describe a volume and suggest isovalues");
    command->footer(
        "Examples:\n  palpate info head.nrrd\n  palpate info dicom-folder --json\n"
        "  palpate info samples.raw --dims 256x256x113 --type uint16 --spacing 1,1,2");
    options->add_to(*command, SourceOptions::For::description);
    command->add_flag("--json", *json, "Print JSON");
    command->callback([options, json] {
        run::LoadedVolume loaded = load_for_terminal(*options);
        loaded.values.padding =
            run::padding_of(loaded.volume, loaded.values.padding, stop_if_interrupted);
        const run::Histogram histogram =
            run::histogram_of(loaded.volume, fine_bins, loaded.values.padding, stop_if_interrupted);
        std::vector<double> suggested = run::suggested_isovalues(histogram);
        const std::optional<double>& own = loaded.isovalue;  // a tiny grid may miss its range
        if (own && *own > loaded.volume.minimum() && *own < loaded.volume.maximum()) {
            suggested.insert(suggested.begin(), *own);
        }
        std::optional<filters::Terraces> terraces;
        if (!loaded.streamed) terraces = filters::terraces_of(loaded.volume, stop_if_interrupted);
        if (*json) {
            print_json(json_of(loaded, histogram, suggested, terraces));
        } else {
            print_text(loaded, histogram, suggested, terraces);
        }
    });
}

}  // namespace palpate::app
