// Layers from label volumes.
#include "palpate/run/labels.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "palpate/io/error.hpp"
#include "palpate/run/beside.hpp"
#include "palpate/stream/store.hpp"

namespace palpate::run {
namespace {

/// [N] at which a surface gives way where no layers say it.
constexpr double usual_puncture_force = 1.5;

/// The numbers above 0 that the volume has, no more than one beyond those that can be layers.
std::set<int> numbers_in(const Volume& volume) {
    std::set<int> numbers;
    with_type(volume.type(), [&](auto zero) {
        const auto* samples = static_cast<const decltype(zero)*>(volume.data());
        const auto count = sample_count(volume.geometry());
        auto last = zero;
        for (std::int64_t i = 0; i < count; ++i) {
            if (samples[i] == last) continue;
            last = samples[i];
            if (last > 0) numbers.insert(static_cast<int>(last));
            if (numbers.size() > Layers::most_layers) return;
        }
    });
    return numbers;
}

/// The grid of the store that is read as these labels. Null: they are whole.
const Geometry* grid_read_in_parts(const LoadedVolume& labels) {
    if (!labels.streamed) return nullptr;
    const auto& [store, loader, opened] = *labels.streamed;
    const Geometry& grid = stream::level_of(*store, loader.level).geometry;
    return grid.size == labels.volume.geometry().size ? nullptr : &grid;
}

/// Numbers of 32 bits and more are kept as float32, which tells whole numbers apart up to 2^24.
void require_whole_numbers(const LoadedVolume& labels) {
    if (grid_read_in_parts(labels)) {
        throw std::invalid_argument(labels.name +
                                    ": only an overview of it is in memory, and labels are needed "
                                    "whole: convert it to a file such as .nrrd");
    }
    if (labels.time_steps > 1) {
        throw std::invalid_argument(labels.name +
                                    ": has several frames (moments, or segments that overlap), and "
                                    "labels are one volume: save one of them");
    }
    if (labels.volume.type() != SampleType::float32) return;
    const auto* const samples = static_cast<const float*>(labels.volume.data());
    const auto count = sample_count(labels.volume.geometry());
    const auto wrong = std::find_if(samples, samples + count, [](float value) {
        return !(std::abs(value) < 0x1p24F) || value != std::floor(value);
    });
    if (wrong == samples + count) return;
    throw std::invalid_argument(labels.name + ": labels are whole numbers below 16777216, and " +
                                std::to_string(*wrong) + " is not");
}

std::string names_in(const LoadedVolume& labels) {
    std::string names;
    for (const io::LabelName& label : labels.values.labels) {
        names += (names.empty() ? "" : ", ") + label.name;
    }
    return names.empty() ? "its labels have no names" : "it has " + names;
}

io::LabelName unnamed(int number) {
    return {number, "label " + std::to_string(number), Layer{}.colour};
}

Layers a_layer_for_each(const LoadedVolume& labels) {
    const std::set<int> numbers = numbers_in(labels.volume);
    if (numbers.empty()) throw std::invalid_argument(labels.name + ": has no label above 0");
    if (numbers.size() > Layers::most_layers) {
        throw std::invalid_argument(labels.name +
                                    ": has more than 16 labels: choose some in a file of layers");
    }
    std::vector<io::LabelName> names;
    for (const int number : numbers) {
        const auto& known = labels.values.labels;
        const auto named = std::ranges::find(known, number, &io::LabelName::value);
        names.push_back(named != known.end() ? *named : unnamed(number));
    }
    return layers_of(names).layers;
}

/// Numbers in place of levels, by name.
void number_by_name(Layers& layers, const LoadedVolume& labels) {
    for (Layer& layer : layers.layers) {
        const auto& known = labels.values.labels;
        const auto named = std::ranges::find(known, layer.name, &io::LabelName::name);
        if (named == known.end()) {
            throw std::invalid_argument(labels.name + ": has no label '" + layer.name + "'; " +
                                        names_in(labels));
        }
        layer.level = named->value;
    }
}

void attach(Layers& layers, const LoadedVolume& labels) {
    layers.by_label = true;
    layers.label_volume = labels.name;
    layers.labels = numbered_labels(labels.volume, layers.layers, level_count(layers));
}

}  // namespace

LoadedVolume load_labels(const std::string& name, std::uint64_t memory,
                         const io::Progress& progress) {
    constexpr std::uint64_t labels_part = 4;
    Source source = source_from({{"volume", name}});
    source.most_bytes = memory / labels_part;
    LoadedVolume labels = load(source, progress);
    const Geometry* const grid = grid_read_in_parts(labels);
    if (!grid) return labels;
    const auto bytes = static_cast<double>(sample_count(*grid)) *
                       static_cast<double>(size_of(labels.volume.type()));
    if (memory > 0 && bytes > static_cast<double>(source.most_bytes)) {
        throw io::InputError(name + ": its samples need " +
                             std::to_string(std::llround(bytes / 1e6)) +
                             " MB, more than a quarter of the memory; allow more memory");
    }
    const StreamedVolume& store = *labels.streamed;
    labels.volume = stream::read_level(*store.store, store.loader.level, progress);
    return labels;
}

io::LayersFile layers_of(std::span<const io::LabelName> labels) {
    io::LayersFile file;
    file.layers.name = "Labels";
    file.layers.by_label = true;
    for (const io::LabelName& label : labels) {
        Layer layer;
        layer.name = label.name;
        layer.level = label.value;
        layer.colour = label.colour;
        layer[HapticProperty::puncture_force] = usual_puncture_force;
        file.layers.layers.push_back(layer);
    }
    return file;
}

io::LayersFile layers_by_label(const LoadedVolume& labels,
                               const std::optional<io::LayersFile>& like) {
    require_whole_numbers(labels);
    io::LayersFile file;
    if (like) {
        file = *like;
        if (!file.layers.by_label) number_by_name(file.layers, labels);
    } else {
        file.layers = a_layer_for_each(labels);
    }
    attach(file.layers, labels);
    return file;
}

std::shared_ptr<const Layers> with_labels(std::shared_ptr<const Layers> layers,
                                          const std::filesystem::path& recording,
                                          const LoadedVolume& volume) {
    if (!layers || !layers->by_label || layers->labels) return layers;
    std::filesystem::path path = layers->label_volume;
    std::error_code error;
    if (path.is_relative() && !std::filesystem::exists(path, error)) {
        path = recording.parent_path() / path;
    }
    const bool is_bounded = volume.streamed && volume.streamed->loader.whole_process;
    Layers complete = *layers;
    try {
        const LoadedVolume labels =
            load_labels(path.string(), is_bounded ? volume.streamed->loader.memory : 0);
        require_whole_numbers(labels);
        attach(complete, labels);
        complete.labels = labels_beside(complete.labels, volume);
    } catch (const std::invalid_argument& e) {
        throw io::InputError(recording.string() + ": its labels: " + e.what());
    }
    complete.label_volume = layers->label_volume;
    return std::make_shared<const Layers>(std::move(complete));
}

}  // namespace palpate::run
