// Finds labels, masks them, and matches them with layers.
#include "apps/viewer/model/overlay.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "apps/viewer/model/transfer.hpp"
#include "palpate/run/statistics.hpp"

namespace palpate::viewer {
namespace {

/// A map without names has no more values than this.
constexpr std::size_t most_unnamed = 64;
/// Nor can so many be shown.
constexpr std::size_t most_labels = 512;

/// The place of each whole number but 0. Empty if samples are not whole, or differ too much.
template <class T>
std::map<int, SampleBox> boxes_of(const Volume& volume, std::size_t most) {
    std::map<int, SampleBox> boxes;
    const auto samples = volume.samples<T>();
    const Index3 size = volume.geometry().size;
    std::size_t n = 0;
    for (int k = 0; k < size[2]; ++k) {
        for (int j = 0; j < size[1]; ++j) {
            for (int i = 0; i < size[0]; ++i, ++n) {
                const double value = static_cast<double>(samples[n]);
                if (value == 0) continue;
                if (value != std::round(value) || std::abs(value) > 1e6) return {};
                const Index3 at(i, j, k);
                SampleBox& box = boxes[static_cast<int>(value)];
                box = box.empty() ? SampleBox{at, at}
                                  : SampleBox{box.low.cwiseMin(at), box.high.cwiseMax(at)};
                if (boxes.size() > most) return {};
            }
        }
    }
    return boxes;
}

std::vector<Label> labels_of(const Volume& volume, const std::vector<io::LabelName>& names) {
    const std::size_t most = names.empty() ? most_unnamed : most_labels;
    const auto boxes =
        with_type(volume.type(), [&](auto zero) { return boxes_of<decltype(zero)>(volume, most); });
    std::vector<Label> labels;
    for (const auto& [value, box] : boxes) {
        Label label{value, "Label " + std::to_string(value), label_colour(value), box};
        const auto named = std::ranges::find(names, value, &io::LabelName::value);
        if (named != names.end()) {
            if (!named->name.empty()) label.name = named->name;
            label.colour = {named->colour[0], named->colour[1], named->colour[2]};
        }
        labels.push_back(std::move(label));
    }
    return labels;
}

/// Once along an axis, 1 2 1.
void smooth_along(std::vector<float>& values, const Index3& size, int axis) {
    const std::array<std::ptrdiff_t, 3> strides{1, size[0],
                                                static_cast<std::ptrdiff_t>(size[0]) * size[1]};
    const std::ptrdiff_t stride = strides[static_cast<std::size_t>(axis)];
    const std::vector<float> before = values;
    const auto count = static_cast<std::ptrdiff_t>(values.size());
    for (std::ptrdiff_t i = 0; i < count; ++i) {
        const auto at = static_cast<int>(i / stride % size[axis]);
        const float low = before[static_cast<std::size_t>(at > 0 ? i - stride : i)];
        const float high = before[static_cast<std::size_t>(at + 1 < size[axis] ? i + stride : i)];
        values[static_cast<std::size_t>(i)] =
            0.25F * (low + high) + 0.5F * before[static_cast<std::size_t>(i)];
    }
}

}  // namespace

Overlay make_overlay(const run::LoadedVolume& loaded, const run::Source& source) {
    constexpr int bins = 256;
    Overlay overlay{source, loaded.volume, labels_of(loaded.volume, loaded.values.labels)};
    overlay.time_steps = loaded.time_steps;
    const double low = loaded.volume.minimum(), high = loaded.volume.maximum();
    const run::Histogram histogram = run::histogram_of(loaded.volume, bins);
    const auto levels = run::suggested_isovalues(histogram);
    overlay.level = levels.empty() ? 0.5 * (low + high) : levels.front();
    overlay.dark = low;
    overlay.bright = high > low ? high : low + 1;
    if (const auto& window = loaded.values.window) {
        overlay.dark = window->centre - 0.5 * window->width;
        overlay.bright = window->centre + 0.5 * window->width;
    }
    return overlay;
}

Volume label_mask(const Overlay& overlay, const Label& label) {
    constexpr int more = 3, rounds = 2;
    const Geometry& whole = overlay.volume.geometry();
    const Index3 low = label.box.low - Index3::Constant(more);
    Geometry part = whole;
    part.size = label.box.high - low + Index3::Constant(more + 1);
    part.origin = physical_from_index(whole, low.cast<double>());
    std::vector<float> mask(static_cast<std::size_t>(sample_count(part)), 0);
    for (int k = label.box.low[2]; k <= label.box.high[2]; ++k) {
        for (int j = label.box.low[1]; j <= label.box.high[1]; ++j) {
            for (int i = label.box.low[0]; i <= label.box.high[0]; ++i) {
                const Index3 in = Index3(i, j, k) - low;
                if (overlay.volume.sample(Index3(i, j, k)) != label.value) continue;
                mask[(static_cast<std::size_t>(in[2]) * part.size[1] + in[1]) * part.size[0] +
                     in[0]] = 1;
            }
        }
    }
    const std::vector<float> sharp = mask;
    for (int i = 0; i < rounds; ++i) {
        for (int axis = 0; axis < 3; ++axis) smooth_along(mask, part.size, axis);
    }
    // A vessel that is a sample wide would be smoothed away.
    constexpr float kept = 0.75F;
    for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = std::max(mask[i], kept * sharp[i]);
    return Volume(part, std::move(mask));
}

namespace {

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
            const Label& label = overlay->labels[i];
            if (label.value != layer.level || label.colour == colour_of(layer)) continue;
            if (!coloured) coloured = std::make_shared<Overlay>(*overlay);
            coloured->labels[i].colour = colour_of(layer);
        }
    }
    return coloured ? coloured : overlay;
}

}  // namespace palpate::viewer
