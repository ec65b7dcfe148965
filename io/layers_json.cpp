// Layers to JSON and back. People write these files, so a member that there is not is an error.
#include "io/layers_json.hpp"

#include <optional>
#include <stdexcept>

#include "io/json_members.hpp"
#include "palpate/names.hpp"

namespace palpate::io {
namespace {

constexpr auto& property_names = names_of<HapticProperty>.names;
static_assert(property_names.size() == haptic_property_count);

/// An object whose members are taken out one by one; what is left at the end is an error.
class Members {
  public:
    Members(const Json& json, std::string where) : json_(json), where_(std::move(where)) {
        if (!json.is_object()) wrong_member(where_, "an object");
    }
    template <class T>
    bool take(const std::string& name, T& value) {
        const auto found = json_.find(name);
        if (found == json_.end()) return false;
        JsonReader::get(*found, full(name), value);
        json_.erase(found);
        return true;
    }
    std::optional<Json> take(const std::string& name) {
        const auto found = json_.find(name);
        if (found == json_.end()) return std::nullopt;
        const Json json = *found;
        json_.erase(found);
        return json;
    }
    std::string full(const std::string& name) const {
        return where_.empty() ? name : where_ + '.' + name;
    }
    void finish() const {
        if (json_.empty()) return;
        throw std::invalid_argument("there is no member '" + full(json_.begin().key()) + "'");
    }

  private:
    Json json_;
    std::string where_;
};

Json json_of(const Curve& curve) {
    Json list = Json::array();
    for (const Curve::Knot& knot : curve.knots) {
        list.push_back({number_to_json(knot.at), number_to_json(knot.value)});
    }
    return list;
}

Curve curve_from(const Json& json, const std::string& name) {
    const std::string wanted = "a list of pairs of numbers, as in [[0, 0.1], [300, 0.8]]";
    if (!json.is_array()) wrong_member(name, wanted);
    Curve curve;
    for (const Json& pair : json) {
        if (!pair.is_array() || pair.size() != 2) wrong_member(name, wanted);
        curve.knots.push_back({number_from_json(pair[0], name), number_from_json(pair[1], name)});
    }
    return curve;
}

PropertyCurves curves_from(const Json& json, const std::string& name) {
    Members members(json, name);
    PropertyCurves curves;
    if (const auto density = members.take("density")) {
        curves.density = curve_from(*density, members.full("density"));
    }
    if (const auto gradient = members.take("gradient")) {
        curves.gradient = curve_from(*gradient, members.full("gradient"));
    }
    members.finish();
    return curves;
}

Json json_of(const Layer& layer, const char* level) {
    Json json;
    json["name"] = layer.name;
    json[level] = number_to_json(layer.level);
    json["colour"] = layer.colour;
    json["opacity"] = layer.opacity;
    for (std::size_t p = 0; p < haptic_property_count; ++p) {
        if (layer.own[p]) json[property_names[p]] = number_to_json(*layer.own[p]);
    }
    return json;
}

struct ReadLayer {
    Layer layer;
    bool label = false;  // its level is given as a label
};

ReadLayer layer_from(const Json& json, const std::string& where) {
    Members members(json, where);
    Layer layer;
    members.take("name", layer.name);
    const bool label = members.take("label", layer.level);
    const bool level = members.take("level", layer.level);
    if (!label && !level) wrong_member(members.full("level"), "given");
    if (label && level) {
        throw std::invalid_argument("'" + where + "' has a level and a label: give one of them");
    }
    Vec3 colour(layer.colour[0], layer.colour[1], layer.colour[2]);
    members.take("colour", colour);
    layer.colour = {colour[0], colour[1], colour[2]};
    members.take("opacity", layer.opacity);
    for (std::size_t p = 0; p < haptic_property_count; ++p) {
        double value = 0;
        if (members.take(property_names[p], value)) layer.own[p] = value;
    }
    members.finish();
    return {layer, label};
}

/// Levels first, then labels.
void take_layers(const Json& list, Layers& layers) {
    if (!list.is_array()) wrong_member("layers", "a list");
    for (const Json& one : list) {
        const std::size_t number = layers.layers.size();
        const ReadLayer read = layer_from(one, "layers[" + std::to_string(number) + "]");
        layers.layers.push_back(read.layer);
        if (read.label) {
            if (!layers.by_label) layers.levels_beside_labels = number;
            layers.by_label = true;
        } else if (layers.by_label) {
            throw std::invalid_argument(
                "layers: those with a level come before those with a label");
        }
    }
}

Needle needle_from(const Json& json) {
    Members members(json, "needle");
    Needle needle;
    for_each_setting<Needle>([&](const auto& one) { members.take(one.key, needle.*one.member); });
    members.finish();
    return needle;
}

}  // namespace

Json to_json(const Layers& layers) {
    Json json;
    json["name"] = layers.name;
    Json& list = json["layers"] = Json::array();
    const bool both = layers.by_label && layers.levels_beside_labels > 0;
    for (std::size_t i = 0; i < layers.layers.size(); ++i) {
        list.push_back(json_of(layers.layers[i], both && is_label(layers, i) ? "label" : "level"));
    }
    Json curves = Json::object();
    for (std::size_t p = 0; p < haptic_property_count; ++p) {
        const PropertyCurves& of = layers.curves[p];
        if (!of.density.knots.empty()) curves[property_names[p]]["density"] = json_of(of.density);
        if (!of.gradient.knots.empty()) {
            curves[property_names[p]]["gradient"] = json_of(of.gradient);
        }
    }
    if (!curves.empty()) json["curves"] = curves;
    json["closing"] = layers.closing;
    if (layers.by_label && !both) json["by_label"] = true;
    if (!layers.label_volume.empty()) json["label_volume"] = layers.label_volume;
    if (layers.needle) json["needle"] = JsonWriter::of(*layers.needle);
    return json;
}

Layers layers_from_json(const Json& json) {
    Members members(json, "");
    Layers layers;
    members.take("name", layers.name);
    if (const auto list = members.take("layers")) take_layers(*list, layers);
    if (const auto all = members.take("curves")) {
        Members curves(*all, "curves");
        for (std::size_t p = 0; p < haptic_property_count; ++p) {
            if (const auto one = curves.take(property_names[p])) {
                layers.curves[p] = curves_from(*one, curves.full(property_names[p]));
            }
        }
        curves.finish();
    }
    members.take("closing", layers.closing);
    bool all_labels = false;
    members.take("by_label", all_labels);
    if (all_labels) {
        layers.by_label = true;
        layers.levels_beside_labels = 0;
    }
    members.take("label_volume", layers.label_volume);
    if (const auto needle = members.take("needle")) layers.needle = needle_from(*needle);
    members.finish();
    return layers;
}

}  // namespace palpate::io
