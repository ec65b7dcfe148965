// Reads and writes layer files, and finds those that come with Palpate.
#include "palpate/io/layers_file.hpp"

#include <algorithm>
#include <system_error>

#include "io/bundled.hpp"
#include "io/json_text.hpp"
#include "io/layers_json.hpp"
#include "palpate/io/csv.hpp"
#include "palpate/io/output.hpp"
#include "palpate/names.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;

constexpr int format = 1;

/// Takes a member of text out of the file's object.
std::string text_member(Json& json, const char* name) {
    const auto found = json.find(name);
    if (found == json.end()) return {};
    if (!found->is_string()) {
        throw std::invalid_argument(std::string("'") + name + "' must be text");
    }
    std::string text = found->get<std::string>();
    json.erase(found);
    return text;
}

/// The side does not matter to a file: levels may rise or fall.
void check_on_either_side(const Layers& layers) {
    const auto& list = layers.layers;
    const bool falls = level_count(layers) > 1 && list[1].level < list[0].level;
    check(layers, falls ? Solid::below : Solid::above);
}

fs::path preset_folder() {
    if (const auto found = bundled("layers")) return *found;
    throw InputError("the built-in layers were not found; reinstall Palpate, or name a file");
}

}  // namespace

LayersFile layers_from_text(std::string_view text, const std::string& name) {
    try {
        Json json = parsed_json(text, true);
        if (!json.is_object() || !json.contains("palpate_layers") ||
            json["palpate_layers"] != format) {
            throw std::invalid_argument("no layers: it must begin with \"palpate_layers\": 1");
        }
        json.erase("palpate_layers");
        LayersFile file;
        file.units = text_member(json, "units");
        file.about = text_member(json, "about");
        file.layers = layers_from_json(json);
        check_on_either_side(file.layers);
        return file;
    } catch (const nlohmann::json::exception& e) {
        throw InputError(name + ": no valid JSON: " + e.what());
    } catch (const std::invalid_argument& e) {
        throw InputError(name + ": " + e.what());
    }
}

LayersFile read_layers(const fs::path& path, const OnProgress& progress) {
    return layers_from_text(read_text(path, progress), path.string());
}

std::string text_of(const LayersFile& file) {
    Json json;
    json["palpate_layers"] = format;
    if (!file.units.empty()) json["units"] = file.units;
    if (!file.about.empty()) json["about"] = file.about;
    json.update(to_json(file.layers));
    json.erase("label_volume");  // of a session, not of the set
    return json.dump(2) + '\n';
}

void write_layers(const fs::path& path, const LayersFile& file) {
    PendingFile out(path);
    out.write(text_of(file));
    out.commit();
}

Layers layers_for(const LayersFile& file, const Volume& volume) {
    Layers layers = file.layers;
    if (file.units != "%") return layers;
    const double low = volume.minimum(), per_cent = 0.01 * (volume.maximum() - volume.minimum());
    for (std::size_t i = 0; i < level_count(layers); ++i) {
        layers.layers[i].level = low + layers.layers[i].level * per_cent;
    }
    for (PropertyCurves& curves : layers.curves) {
        for (Curve::Knot& knot : curves.density.knots) knot.at = low + knot.at * per_cent;
        for (Curve::Knot& knot : curves.gradient.knots) knot.at *= per_cent;
    }
    return layers;
}

std::vector<std::string> layers_names() {
    std::vector<std::string> names;
    const auto folder = bundled("layers");
    if (!folder) return names;
    for (const auto& entry : fs::directory_iterator(*folder)) {
        if (entry.path().extension() == ".json") names.push_back(entry.path().stem().string());
    }
    std::ranges::sort(names);
    return names;
}

std::vector<LayersPreset> layers_presets() {
    const fs::path folder = preset_folder();
    std::vector<LayersPreset> presets;
    for (const std::string& name : layers_names()) {
        presets.push_back({name, read_layers(folder / (name + ".json"))});
    }
    return presets;
}

LayersFile layers_named(const std::string& file_or_name, const OnProgress& progress) {
    std::error_code error;
    if (file_or_name.find_first_of("./") != std::string::npos || fs::exists(file_or_name, error)) {
        return read_layers(file_or_name, progress);
    }
    for (LayersPreset& preset : layers_presets()) {
        if (preset.name == file_or_name) return std::move(preset.file);
    }
    throw InputError(io::quoted(file_or_name) + ": no layers of this name, and no such file: " +
                     use_one_of(layers_names(), file_or_name));
}

}  // namespace palpate::io
