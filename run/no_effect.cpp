// Options and arguments that change nothing. See the header.
#include "palpate/run/no_effect.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include "palpate/io/address.hpp"

namespace palpate::run {
namespace {

/// Whether a surface gives way when it is pressed hard enough.
bool gives_way(const Layers& layers) {
    constexpr auto force = HapticProperty::puncture_force;
    const PropertyCurves& curves = layers[force];
    const auto finite = [](const Layer& layer) {
        return layer[force] && std::isfinite(*layer[force]);
    };
    return !curves.density.knots.empty() || !curves.gradient.knots.empty() ||
           std::ranges::any_of(layers.layers, finite);
}

}  // namespace

std::string no_effect_text(const std::vector<std::string>& given, const std::string& why) {
    std::string text;
    for (const std::string& name : given) text += (text.empty() ? "" : ", ") + name;
    if (given.empty()) return text;
    return text + (given.size() == 1 ? " does" : " do") + " nothing: " + why;
}

std::vector<NoEffect> without_effect(const Source& source) {
    const std::string name = name_of(source);
    const auto* file = std::get_if<FileSource>(&source.from);
    const auto* store = std::get_if<StoreSource>(&source.from);
    std::vector<NoEffect> found;
    if (!store) {
        found.push_back({{"level", "channel", "memory", "coarse_first", "all_times", "cache",
                          "cache_size", "forbidden_is_missing"},
                         name + " is read as a whole"});
    } else if (!io::is_web_address(store->address)) {
        found.push_back(
            {{"cache", "cache_size", "forbidden_is_missing"}, name + " is on this machine"});
    } else if (store->options.cache_folder.empty()) {
        found.push_back({{"cache_size"}, name + " is read without a cache"});
    }
    if (file ? !file->raw : store && !store->options.raw) {
        found.push_back({{"skip", "byte_order"}, name + " is read as its header describes it"});
    }
    return found;
}

std::vector<NoEffect> without_effect(const LoadedVolume& loaded) {
    std::vector<NoEffect> found;
    if (loaded.sequence.count() < 2) {
        const bool is_part = loaded.time_steps > 1 && loaded.source.frame;
        found.push_back({{"frame_interval", "playback", "once", "sequence_memory"},
                         loaded.name + (is_part ? ": a single frame of it is no sequence"
                                                : " is not a sequence")});
    }
    if (loaded.time_steps < 2)
        found.push_back({{"time_step"}, loaded.name + " has a single frame"});
    if (!loaded.streamed) found.push_back({{"wait"}, loaded.name + " is in memory"});
    if (!loaded.format.starts_with("DICOM")) {
        found.push_back({{"series"}, loaded.name + " is not a DICOM series"});
    }
    return found;
}

std::vector<NoEffect> without_effect(const Samples& samples) {
    if (samples.frames().size() > 1) return {};
    return {{{"time", "Moment", "Speed"}, "these samples are not a sequence"}};
}

std::vector<NoEffect> without_effect(const RenderSetup& setup) {
    std::vector<NoEffect> found;
    if (std::holds_alternative<io::PointSpec>(setup.tool)) {
        found.push_back({{"tool_spacing"}, "a point has no size: choose another tool"});
    }
    if (std::holds_alternative<io::PointsSpec>(setup.tool)) {
        found.push_back({{"tool_spacing"}, "the points of this tool are given"});
    }
    if (std::holds_alternative<RangesSetup>(setup.penetrability)) {
        found.push_back({{"isovalue", "minimum"}, "each range has levels of its own"});
    }
    const auto* threshold = std::get_if<ThresholdSetup>(&setup.penetrability);
    if (threshold && threshold->minimum) {
        found.push_back({{"isovalue"}, "the levels begin at the minimum"});
    }
    const auto& [distance, peak] = setup.force.magnet;
    if (distance == 0 || peak == 0) {
        found.push_back({{"magnet"}, distance == 0 ? "its distance is 0" : "its peak is 0"});
    }
    if (setup.force.texture.amplitude == 0) found.push_back({{"texture"}, "its amplitude is 0"});
    if (setup.layers && !gives_way(setup.layers->layers)) {
        found.push_back({{"closing"}, "no layer has a puncture force, so none gives way"});
    }
    return found;
}

std::vector<NoEffect> without_effect_in_replay(const RenderSetup& setup) {
    std::vector<NoEffect> found = without_effect(setup);
    if (std::holds_alternative<io::PointSpec>(setup.tool)) {
        found.push_back(
            {{"rotational_stiffness", "rotational_damping", "torque_limit", "torque_rate_limit"},
             "a point does not turn: choose another tool"});
    }
    found.push_back({{"stale_after"}, "no time between two positions counts as a pause"});
    return found;
}

void refuse_without_effect(const std::vector<NoEffect>& all, const Given& given) {
    for (const auto& [names, why] : all) {
        std::vector<std::string> useless;
        std::ranges::copy_if(names, std::back_inserter(useless), [&](const std::string& name) {
            const auto found = given.find(name);
            return found != given.end() && found->second;
        });
        if (!useless.empty()) throw std::invalid_argument(no_effect_text(useless, why));
    }
}

}  // namespace palpate::run
