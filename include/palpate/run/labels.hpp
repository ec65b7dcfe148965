// Layers by place: which tissue is where, from a label volume (a segmentation) on its own grid.
#pragma once

#include <filesystem>
#include <optional>
#include <span>

#include "palpate/io/layers_file.hpp"
#include "palpate/run/source.hpp"

namespace palpate::run {

/// A layer by label for each of these, with its name and colour, which gives way at 1.5 N. Their
/// places are still to come: layers_by_label().
io::LayersFile layers_of(std::span<const io::LabelName> labels);

/// Layers whose places are the labels of this volume. With `like`, its layers: by the numbers that
/// they have as levels if it is by label, else by the names that the label volume gives. Without, a
/// layer for each label, with its name and colour, which gives way at 1.5 N. Throws
/// std::invalid_argument, naming the volume, for labels that it does not have, and for more
/// than 16.
io::LayersFile layers_by_label(const LoadedVolume& labels,
                               const std::optional<io::LayersFile>& like = std::nullopt);

/// Layers as they were recorded, with the label volume read again if they have one: its name is
/// looked for from the working folder, then beside the recording. Throws io::InputError.
std::shared_ptr<const Layers> with_labels(std::shared_ptr<const Layers> layers,
                                          const std::filesystem::path& recording);

}  // namespace palpate::run
