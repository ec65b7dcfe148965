// Layers as files: what is written reads back, what is wrong is said, and what comes with Palpate
// is sound.
#include "palpate/io/layers_file.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <limits>

#include "io/recording/settings_json.hpp"
#include "support/fields.hpp"
#include "support/scratch_folder.hpp"

using namespace palpate;
using namespace palpate::io;

namespace {

std::string refusal_of(const std::string& members) {
    try {
        layers_from_text("{\"palpate_layers\": 1" + (members.empty() ? "" : ", " + members) + "}",
                         "f.json");
    } catch (const InputError& e) {
        return e.what();
    }
    return "accepted";
}

LayersFile everything() {
    LayersFile file;
    file.units = "HU";
    file.about = "a \"test\"";
    file.layers.name = "all";
    Layer layer;
    layer.name = "skin, outer";
    layer.level = -300.1;
    layer.colour = {0.1, 0.2, 0.3};
    layer.opacity = 0.7;
    for (std::size_t p = 0; p < layer.own.size(); ++p) layer.own[p] = 0.1 * double(p) + 1e-17;
    file.layers.layers = {layer};
    layer = {};
    layer.name = "bone";
    layer.level = 250;
    layer[HapticProperty::puncture_force] = std::numeric_limits<double>::infinity();
    file.layers.layers.push_back(layer);
    file.layers[HapticProperty::stiffness].density.knots = {{-1, 0.1}, {2, 0.3}};
    file.layers[HapticProperty::drag].gradient.knots = {{0, 0}, {7, 1}};
    file.layers.closing = 0.25;
    file.layers.needle = Needle{.lateral_stiffness = 0.7, .static_ratio = 1.9, .stick_speed = 3};
    return file;
}

}  // namespace

TEST(LayersFile, reads_back_what_was_written) {
    const support::ScratchFolder folder;
    const auto path = folder.path() / "layers.json";
    const LayersFile file = everything();
    write_layers(path, file);
    const LayersFile again = read_layers(path);
    EXPECT_EQ(text_of(again), text_of(file));
    EXPECT_EQ(again.units, "HU");
    EXPECT_EQ(again.about, "a \"test\"");
    ASSERT_EQ(again.layers.layers.size(), 2U);
    EXPECT_EQ(again.layers.layers[0].own, file.layers.layers[0].own);
    EXPECT_EQ(again.layers.layers[1][HapticProperty::puncture_force],
              std::numeric_limits<double>::infinity());
    EXPECT_FALSE(again.layers.layers[1][HapticProperty::stiffness]);
    EXPECT_EQ(again.layers[HapticProperty::drag].gradient(3.5), 0.5);
    EXPECT_EQ(again.layers.needle->stick_speed, 3);
}

TEST(LayersFile, may_have_comments_and_say_little) {
    const LayersFile file = layers_from_text(
        "{ // mine\n\"palpate_layers\": 1, \"layers\": [{\"name\": \"a\", "
        "\"level\": 3}] }",
        "f.json");
    EXPECT_EQ(file.layers.layers[0].level, 3);
    EXPECT_FALSE(file.layers.needle);
}

TEST(LayersFile, says_what_is_wrong) {
    EXPECT_EQ(refusal_of(""), "accepted");
    EXPECT_EQ(refusal_of("\"layer\": []"), "f.json: there is no member 'layer'");
    EXPECT_EQ(refusal_of("\"layers\": 3"), "f.json: 'layers' must be a list");
    EXPECT_EQ(refusal_of("\"layers\": [{\"name\": \"a\"}]"),
              "f.json: 'layers[0].level' must be given");
    EXPECT_EQ(refusal_of("\"layers\": [{\"name\": \"a\", \"level\": 1, \"stifness\": 1}]"),
              "f.json: there is no member 'layers[0].stifness'");
    EXPECT_EQ(refusal_of("\"layers\": [{\"name\": \"a\", \"level\": 1, \"stiffness\": \"much\"}]"),
              "f.json: 'layers[0].stiffness' must be a number, \"inf\" or \"-inf\"");
    EXPECT_EQ(refusal_of("\"layers\": [{\"name\": \"a\", \"level\": 1}, {\"name\": \"a\", "
                         "\"level\": 2}]"),
              "f.json: layer \"a\" is there twice");
    EXPECT_EQ(refusal_of("\"curves\": {\"drag\": {\"density\": [1, 2]}}"),
              "f.json: 'curves.drag.density' must be a list of pairs of numbers, as in [[0, 0.1], "
              "[300, 0.8]]");
    EXPECT_EQ(refusal_of("\"needle\": {\"length\": 3}"),
              "f.json: there is no member 'needle.length'");
    EXPECT_THROW(layers_from_text("{", "f.json"), InputError);
    EXPECT_THROW(layers_from_text("{}", "f.json"), InputError);
    EXPECT_THROW(layers_from_text("[]", "f.json"), InputError);
    EXPECT_THROW(read_layers("there is no such file.json"), InputError);
}

TEST(LayersFile, may_have_levels_before_labels) {
    const std::string levels_and_label =
        "\"layers\": [{\"name\": \"skin\", \"level\": 10}, {\"name\": \"bone\", \"level\": 80}, "
        "{\"name\": \"tumour\", \"label\": 3}]";
    LayersFile file = layers_from_text(
        "{\"palpate_layers\": 1, \"units\": \"%\", " + levels_and_label + "}", "f");
    for (int i = 0; i < 2; ++i) {
        EXPECT_TRUE(file.layers.by_label);
        EXPECT_EQ(level_count(file.layers), 2U);
        EXPECT_TRUE(is_label(file.layers, 2));
        EXPECT_EQ(file.layers.layers[2].level, 3);
        file = layers_from_text(text_of(file), "again");
    }
    const Volume volume = support::volume_of<std::int16_t>(
        support::grid({4, 4, 4}), [](const Index3& i) { return 100 + i[0] * 100; });
    const Layers layers = layers_for(file, volume);
    EXPECT_EQ(layers.layers[0].level, 130);
    EXPECT_EQ(layers.layers[2].level, 3) << "no percentage of a label";
    EXPECT_EQ(refusal_of("\"layers\": [{\"name\": \"a\", \"label\": 1}, {\"name\": \"b\", "
                         "\"level\": 1}]"),
              "f.json: layers: those with a level come before those with a label");
    EXPECT_EQ(refusal_of("\"layers\": [{\"name\": \"a\", \"label\": 1, \"level\": 1}]"),
              "f.json: 'layers[0]' has a level and a label: give one of them");
    const LayersFile all = layers_from_text(
        "{\"palpate_layers\": 1, \"layers\": [{\"name\": \"a\", \"label\": 7}]}", "f");
    EXPECT_TRUE(all.layers.by_label);
    EXPECT_EQ(level_count(all.layers), 0U);
}

TEST(LayersFile, in_percent_takes_the_units_of_a_volume) {
    LayersFile file = everything();
    file.units = "%";
    file.layers.layers[0].level = 10;
    file.layers[HapticProperty::drag].gradient.knots = {{50, 1}};
    const Volume volume = support::volume_of<std::int16_t>(
        support::grid({4, 4, 4}), [](const Index3& i) { return 100 + i[0] * 100; });
    const Layers layers = layers_for(file, volume);
    EXPECT_EQ(layers.layers[0].level, 130);
    EXPECT_EQ(layers.layers[1].level, 850);
    EXPECT_EQ(layers[HapticProperty::stiffness].density.knots[1].at, 106);
    EXPECT_EQ(layers[HapticProperty::drag].gradient.knots[0].at, 150);
    file.units = "HU";
    EXPECT_EQ(layers_for(file, volume).layers[0].level, 10);
}

TEST(LayersFile, of_the_built_in_sets_is_sound_and_says_where_its_numbers_come_from) {
    const std::vector<LayersPreset> presets = layers_presets();
    EXPECT_GE(presets.size(), 6U);
    for (const LayersPreset& preset : presets) {
        SCOPED_TRACE(preset.name);
        EXPECT_FALSE(preset.file.layers.name.empty());
        EXPECT_GE(preset.file.layers.layers.size(), 2U);
        EXPECT_TRUE(preset.file.about.find("not validated") != std::string::npos ||
                    preset.file.about.find("not measured") != std::string::npos);
        EXPECT_EQ(text_of(layers_named(preset.name)), text_of(preset.file));
        // As gentle as a desktop device needs it.
        for (const Layer& layer : preset.file.layers.layers) {
            ForceSettings force;
            force.stiffness = layer[HapticProperty::stiffness].value_or(0.5);
            force.viscosity = layer[HapticProperty::viscosity].value_or(0);
            EXPECT_NO_THROW(check(force, DeviceLimits{})) << layer.name;
        }
    }
    try {
        layers_named("no-such-set");
        FAIL();
    } catch (const InputError& e) {
        EXPECT_NE(std::string(e.what()).find("ct-soft-tissue-and-bone"), std::string::npos);
    }
}

TEST(LayersJson, keeps_layers_in_settings_and_commands) {
    RendererSettings settings;
    settings.layers = std::make_shared<Layers>(everything().layers);
    RendererSettings again;
    from_json(to_json(settings), again);
    ASSERT_TRUE(again.layers);
    EXPECT_EQ(to_json(again), to_json(settings));
    const Command use = command::UseLayers{settings.layers};
    Bodies none_yet;
    EXPECT_EQ(to_json(command_from_json(to_json(use, none_yet), none_yet), none_yet),
              to_json(use, none_yet));
    const Command none = command::UseLayers{};
    EXPECT_FALSE(
        std::get<command::UseLayers>(command_from_json(to_json(none, none_yet), none_yet)).layers);
    EXPECT_FALSE(to_json(RendererSettings{}).contains("layers"));
}
