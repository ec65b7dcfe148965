// Layers as JSON files (schema, units and sources of the built-in sets: docs/layers.md).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/io/error.hpp"
#include "palpate/layers.hpp"
#include "palpate/progress.hpp"

namespace palpate::io {

struct LayersFile {
    Layers layers;
    /// Unit of the levels and of the curves' axis: "HU", ... "%" is percent of the data's range.
    /// Empty: the data's own.
    std::string units;
    std::string about;  ///< for people: the purpose, and the source of the numbers
};

/// Throws InputError if there is no such file, for text that is not JSON, for members that are
/// unknown or of the wrong kind, and for layers that check() refuses. The order of the levels
/// decides for which solid side they are checked. `progress`: as for read_text().
LayersFile read_layers(const std::filesystem::path& path, const OnProgress& progress = {});
/// The same from text that errors call `name`.
LayersFile layers_from_text(std::string_view text, const std::string& name);
/// Text that reads back as the same layers, bit for bit.
std::string text_of(const LayersFile& file);
/// Throws OutputError.
void write_layers(const std::filesystem::path& path, const LayersFile& file);

/// With percents in the units of this volume.
Layers layers_for(const LayersFile& file, const Volume& volume);

/// A set that comes with Palpate.
struct LayersPreset {
    std::string name;  ///< the name that selects it: "ct-soft-tissue-and-bone"
    LayersFile file;
};
/// All built-in sets, by name. Throws InputError if their folder is not found.
std::vector<LayersPreset> layers_presets();
/// Only their names. Empty if their folder is not found.
std::vector<std::string> layers_names();
/// A file, or the name of a built-in set. Throws InputError.
LayersFile layers_named(const std::string& file_or_name, const OnProgress& progress = {});

}  // namespace palpate::io
