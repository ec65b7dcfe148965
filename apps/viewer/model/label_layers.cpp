// Matches layers and labels.
#include "apps/viewer/model/label_layers.hpp"

#include <algorithm>

namespace palpate::viewer {
namespace {

/// Of the file's name alone.
std::string file_name(const Overlay& labels) {
    return std::filesystem::path(run::name_of(labels.source)).filename().string();
}

}  // namespace

io::LayersFile layers_of(const Overlay& labels, const std::vector<int>& hidden) {
    std::vector<io::LabelName> names;
    for (const Label& label : labels.labels) {
        if (std::ranges::count(hidden, label.value) > 0) continue;
        names.push_back(
            {label.value, label.name, {label.colour.red, label.colour.green, label.colour.blue}});
    }
    io::LayersFile file = run::layers_of(names);
    file.layers.name = "Labels of " + file_name(labels);
    return file;
}

std::optional<io::LayersFile> by_name(const io::LayersFile& file, const Overlay& labels) {
    if (file.layers.by_label || file.layers.layers.empty()) return std::nullopt;
    io::LayersFile named = file;
    for (Layer& layer : named.layers.layers) {
        const auto label = std::ranges::find(labels.labels, layer.name, &Label::name);
        if (label == labels.labels.end()) return std::nullopt;
        layer.level = label->value;
    }
    named.layers.by_label = true;
    named.layers.name += ", by label";
    return named;
}

std::string missing_labels(const Layers& layers, const Overlay& labels) {
    std::string missing;
    for (std::size_t i = level_count(layers); i < layers.layers.size(); ++i) {
        const Layer& layer = layers.layers[i];
        const bool there = std::ranges::any_of(
            labels.labels, [&](const Label& label) { return label.value == layer.level; });
        if (there) continue;
        missing += (missing.empty() ? "" : ", ") + std::to_string(static_cast<int>(layer.level)) +
                   " (" + layer.name + ")";
    }
    return missing;
}

Layers placed(const Layers& layers, const Overlay& labels) {
    run::LoadedVolume loaded{labels.volume, labels.source, run::name_of(labels.source)};
    loaded.time_steps = labels.time_steps;
    io::LayersFile like;
    like.layers = layers;
    like.layers.by_label = true;
    return run::layers_by_label(loaded, like).layers;
}

std::shared_ptr<const Overlay> in_colours_of(const std::shared_ptr<const Overlay>& overlay,
                                             const SharedLayers& layers) {
    if (!overlay || !layers || !layers->by_label) return overlay;
    std::shared_ptr<Overlay> coloured;
    for (std::size_t at = level_count(*layers); at < layers->layers.size(); ++at) {
        const Layer& layer = layers->layers[at];
        for (std::size_t i = 0; i < overlay->labels.size(); ++i) {
            const Colour colour{layer.colour[0], layer.colour[1], layer.colour[2]};
            const Label& label = overlay->labels[i];
            if (label.value != layer.level || label.colour == colour) continue;
            if (!coloured) coloured = std::make_shared<Overlay>(*overlay);
            coloured->labels[i].colour = colour;
        }
    }
    return coloured ? coloured : overlay;
}

}  // namespace palpate::viewer
