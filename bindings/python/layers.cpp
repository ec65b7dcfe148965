// Layers: haptic transfer functions.
#include "palpate/layers.hpp"

#include "bindings/python/bindings.hpp"
#include "bindings/python/progress.hpp"
#include "bindings/python/record.hpp"
#include "palpate/io/layers_file.hpp"
#include "palpate/run/beside.hpp"
#include "palpate/run/labels.hpp"

namespace palpate::python {
namespace {

using Knots = std::vector<std::pair<double, double>>;
/// By property: knots over density and over the gradient's magnitude.
using Curves = std::map<std::string, std::pair<Knots, Knots>>;

Knots knots_of(const Curve& curve) {
    Knots knots;
    for (const Curve::Knot& knot : curve.knots) knots.emplace_back(knot.at, knot.value);
    return knots;
}
Curve curve_from(const Knots& knots) {
    Curve curve;
    for (const auto& [at, value] : knots) curve.knots.push_back({at, value});
    return curve;
}

Curves curves_of(const io::LayersFile& file) {
    Curves curves;
    for (const std::string& name : all_names<HapticProperty>()) {
        const PropertyCurves& of = file.layers[named<HapticProperty>(name)];
        if (of.density.knots.empty() && of.gradient.knots.empty()) continue;
        curves[name] = {knots_of(of.density), knots_of(of.gradient)};
    }
    return curves;
}
void set_curves(io::LayersFile& file, const Curves& curves) {
    Layers layers = file.layers;
    layers.curves = {};
    for (const auto& [name, knots] : curves) {
        layers[named<HapticProperty>(name)] = {curve_from(knots.first), curve_from(knots.second)};
    }
    file.layers = layers;
}

std::map<std::string, double> properties_of(const Layer& layer) {
    std::map<std::string, double> own;
    for (const std::string& name : all_names<HapticProperty>()) {
        if (const auto value = layer[named<HapticProperty>(name)]) own[name] = *value;
    }
    return own;
}
void set_properties(Layer& layer, const std::map<std::string, double>& own) {
    Layer changed = layer;
    changed.own = {};
    for (const auto& [name, value] : own) changed[named<HapticProperty>(name)] = value;
    layer = changed;
}

constexpr auto closing = setting(&Layers::closing, "closing", "mm, physical",
                                 "Distance at which a punctured surface closes behind the SCP")
                             .within(ranges::positive);

void bind_layers_class(py::module_& module) {
    using F = io::LayersFile;
    py::class_<F> layers =
        Record<F>(module, "Layers",
                  "A haptic transfer function: surfaces from outside in, each with its own feel\n"
                  "(docs/layers.md). Lists and dicts are copies: assign them to change them.")
            .part("name", "", &F::layers, &Layers::name)
            .field("units", &F::units, "Of levels: 'HU', '%' of the data's range; '': the data's.")
            .field("about", &F::about, "For people: what it is for, where its numbers come from.")
            .part("layers", "A list of Layer.", &F::layers, &Layers::layers)
            .property("curves", &curves_of, &set_curves,
                      "{property: (knots over density, knots over gradient)}, a knot (at, value).")
            .property(
                closing.name, [](const F& file) { return file.layers.closing; },
                [](F& file, double value) {
                    check_range(closing, value);
                    file.layers.closing = value;
                },
                text_of(closing).c_str())
            .part("needle", "Needle or None.", &F::layers, &Layers::needle)
            .done();
    layers.def_property_readonly("by_label", member_of(&F::layers, &Layers::by_label),
                                 "Places come from a label volume.");
    layers.def_property_readonly(
        "level_count", [](const F& file) { return level_count(file.layers); },
        "So many of the layers, the first ones, are levels of the density.");
    layers.def(py::pickle(
        [](const F& file) {
            if (file.layers.by_label) {
                throw py::type_error(
                    "layers by label are not pickled: make them from their labels again");
            }
            return py::make_tuple(io::text_of(file));
        },
        [](const py::tuple& state) {
            return io::layers_from_text(state[0].cast<std::string>(), "pickle");
        }));
    layers.def(
        "check", [](const F& file, Solid solid) { check(file.layers, solid); },
        py::arg("solid") = Solid::above, "Raises ValueError, naming layer or curve.");
    layers.def_property_readonly(
        "text", [](const F& file) { return io::text_of(file); }, "As JSON.");
    layers.def(
        "write",
        [](const F& file, const std::filesystem::path& path) { io::write_layers(path, file); },
        py::arg("path"), "As JSON. Raises OutputError.");
}

io::LayersFile layers_by_label(const run::LoadedVolume& labels,
                               const std::optional<io::LayersFile>& like,
                               const std::optional<run::LoadedVolume>& beside) {
    io::LayersFile file = run::layers_by_label(labels, like);
    if (!beside) return file;
    file.layers.labels = run::labels_beside(file.layers.labels, *beside);
    warn(run::warning_beside(file.layers.label_volume, file.layers.labels->geometry(), *beside), 2);
    return file;
}

}  // namespace

void bind_layers(py::module_& module) {
    Record<Layer>(module, "Layer", "A surface and what lies behind it.")
        .field("name", &Layer::name, "")
        .field("level", &Layer::level,
               {"Isovalue [data units]; by label: the label's number.", ranges::finite})
        .field("colour", &Layer::colour, {"Red, green and blue, 0 to 1.", ranges::part})
        .field("opacity", &Layer::opacity, {"0 to 1", ranges::part})
        .property(
            "properties", &properties_of, &set_properties,
            "{name: value}: stiffness [N/mm], static_friction, dynamic_friction, damping and\n"
            "viscosity [N s/mm], puncture_force [N], drag [N/mm per mm].")
        .done();
    Record<Needle>(module, "Needle", "A hand that holds a needle.").settings().done();
    bind_layers_class(module);
    module.def(
        "layers_named",
        [](const std::filesystem::path& name) {
            const GilReleased unlocked;
            return io::layers_named(name.string(), ctrl_c());
        },
        py::arg("name"), "Layers from a JSON file, or a built-in set by name. Raises InputError.");
    module.def(
        "layers_from_text",
        [](const std::string& text) { return io::layers_from_text(text, "layers"); },
        py::arg("text"), "Layers from the text of a JSON file. Raises InputError.");
    module.def(
        "layers_presets",
        [] {
            std::vector<std::string> names;
            for (const io::LayersPreset& preset : io::layers_presets())
                names.push_back(preset.name);
            return names;
        },
        "The names of the built-in sets.");
    module.def(
        "layers_by_label", &layers_by_label, py::arg("labels"), py::arg("like") = py::none(),
        py::kw_only(), py::arg("beside") = py::none(),
        "Layers whose places are the labels of a LoadedVolume (a segmentation), with the\n"
        "feel of `like` where it is given. beside: the LoadedVolume that is touched. Labels\n"
        "without orientation or spacing get those that were given to its load(), as a Run\n"
        "does. Warns if only one of the two has an orientation or a spacing.");
}

}  // namespace palpate::python
