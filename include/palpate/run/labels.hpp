// Layers by position: the tissue at each place comes from a label volume (a segmentation) on its
// own grid.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "palpate/io/layers_file.hpp"
#include "palpate/run/source.hpp"

namespace palpate::run {

/// A label volume by its name, always whole: the mean of two labels is none. Its samples may take a
/// quarter of `memory` [bytes], the limit of the program (0: none). Throws as load().
LoadedVolume load_labels(const std::string& name, std::uint64_t memory,
                         const io::Progress& progress = {});

/// A layer by label for each of these, with its name and colour, and a puncture force of 1.5 N.
/// layers_by_label() adds the label volume.
io::LayersFile layers_of(std::span<const io::LabelName> labels);

/// Layers by the labels of this volume. With `like`, the layers are those of `like`. If `like` is
/// by label, its layers are matched by the numbers that they have as levels, and otherwise by the
/// names in the label volume. Without `like`, there is a layer for each label, with its name and
/// colour, and a puncture force of 1.5 N. Throws std::invalid_argument, naming the volume, for
/// labels that it does not have, for more than 16, and for an overview of a store.
io::LayersFile layers_by_label(const LoadedVolume& labels,
                               const std::optional<io::LayersFile>& like = std::nullopt);

/// Recorded layers, with their label volume, if they have one, read again: from the working folder,
/// or else from the folder of the recording. It lies beside `volume`, which is touched. Throws
/// io::InputError.
std::shared_ptr<const Layers> with_labels(std::shared_ptr<const Layers> layers,
                                          const std::filesystem::path& recording,
                                          const LoadedVolume& volume);

}  // namespace palpate::run
