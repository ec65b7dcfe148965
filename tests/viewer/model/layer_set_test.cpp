// Layers as they are shown and edited.
#include "apps/viewer/model/layer_set.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "apps/viewer/model/session_file.hpp"
#include "palpate/io/error.hpp"
#include "palpate/io/layers_file.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::viewer {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();

Layers skin_and_bone() {
    Layers layers;
    layers.name = "two";
    Layer skin;
    skin.name = "skin";
    skin.level = -300;
    skin.colour = {1, 0, 0};
    skin.opacity = 0.25;
    skin[HapticProperty::stiffness] = 0.3;
    skin[HapticProperty::puncture_force] = 1.2;
    Layer bone;
    bone.name = "bone";
    bone.level = 250;
    bone.colour = {0, 1, 0};
    bone[HapticProperty::stiffness] = 1.5;
    layers.layers = {skin, bone};
    return layers;
}

SharedLayers shared(const Layers& layers) {
    return std::make_shared<const Layers>(layers);
}

TEST(LayerSet, all_surfaces_are_in_the_look_before_those_beside_the_felt_one) {
    Look look;
    look.surfaces = {{7, {0, 0, 1}, 0.5, true}};
    const SharedLayers layers = shared(skin_and_bone());
    const Look scene = scene_look(look, layers), slices = slice_look(look, layers);
    EXPECT_EQ(scene.surface_colour, (Colour{1, 0, 0}));
    EXPECT_EQ(scene.surface_opacity, 0.25);
    ASSERT_EQ(scene.surfaces.size(), 2U);
    EXPECT_EQ(scene.surfaces[0], (SeenSurface{250, {0, 1, 0}, 1, true}));
    EXPECT_EQ(scene.surfaces[1], look.surfaces[0]);
    ASSERT_EQ(slices.surfaces.size(), 3U);
    EXPECT_EQ(slices.surfaces[0].level, -300);
    look.surface = false;
    EXPECT_FALSE(scene_look(look, layers).surfaces[0].shown);
    EXPECT_EQ(scene_look(look, nullptr), look);
    EXPECT_EQ(slice_look(look, shared({})), look);
}

TEST(LayerSet, words_name_what_is_touched_and_what_the_proxy_is_in) {
    Layers layers = skin_and_bone();
    const SharedLayers two = shared(layers);
    EXPECT_EQ(felt_words({-1, 0, 0}, two), "");
    EXPECT_EQ(felt_words({0, 0, 0}, two), "on skin");
    EXPECT_EQ(felt_words({1, 1, 0}, two), "on bone, in skin");
    EXPECT_EQ(felt_words({-1, 2, 0}, two), "in bone, skin");
    EXPECT_EQ(felt_words({0, 0, 0}, nullptr), "");
    EXPECT_EQ(felt_words({5, 9, 0}, two), "in bone, skin") << "of another set, still on its way";
}

TEST(LayerSet, a_level_stays_between_its_neighbours) {
    const Layers layers = skin_and_bone();
    const LevelRoom skin = room_of(layers, 0, 10), bone = room_of(layers, 1, 10);
    EXPECT_EQ(skin.low, -never);
    EXPECT_EQ(skin.high, 240);
    EXPECT_EQ(bone.low, -290);
    EXPECT_EQ(bone.high, never);
    EXPECT_EQ(room_of(layers, 0, 1000).high, -300) << "no room: it stays";
}

TEST(LayerSet, a_new_layer_lies_in_the_widest_room_and_keeps_the_order) {
    for (const Solid solid : {Solid::above, Solid::below}) {
        Layers layers = skin_and_bone();
        if (solid == Solid::below) std::ranges::reverse(layers.layers);
        while (layers.layers.size() < Layers::most_layers) {
            const auto [next, at] = with_another(layers, solid, -1000, 3000, "layer");
            EXPECT_EQ(next.layers.size(), layers.layers.size() + 1);
            EXPECT_NO_THROW(check(next, solid));
            EXPECT_EQ(next.layers[at].name.substr(0, 6), "layer ");
            layers = next;
        }
    }
    EXPECT_NO_THROW(check(first_layer(100, "layer"), Solid::above));
}

TEST(LayerSet, a_stiffness_that_the_device_cannot_render_is_known) {
    RendererSettings settings;
    Layers layers = skin_and_bone();
    EXPECT_FALSE(lowered_stiffness(layers, 0, settings));
    EXPECT_FALSE(lowered_stiffness(layers, 1, settings));
    layers.layers[1][HapticProperty::stiffness] = 50;
    const auto lowered = lowered_stiffness(layers, 1, settings);
    ASSERT_TRUE(lowered);
    EXPECT_NEAR(*lowered, greatest_stiffness(settings.device, 0), 1e-6);
    // Viscosity takes room: on either side of a surface.
    layers.layers[1][HapticProperty::stiffness] = 4.5;
    EXPECT_FALSE(lowered_stiffness(layers, 1, settings));
    layers.layers[0][HapticProperty::viscosity] = 1e-3;
    EXPECT_TRUE(lowered_stiffness(layers, 1, settings));
}

TEST(LayerSet, properties_come_from_the_layer_else_its_curve_else_the_settings) {
    RendererSettings settings;
    settings.force.stiffness = 0.7;
    Layers layers = skin_and_bone();
    using enum HapticProperty;
    EXPECT_EQ(property_at(layers, 0, stiffness, settings), 0.3);
    layers.layers[0][stiffness].reset();
    EXPECT_EQ(property_at(layers, 0, stiffness, settings), 0.7);
    layers[stiffness].density.knots = {{-300, 0.1}, {250, 0.9}};
    EXPECT_EQ(property_at(layers, 0, stiffness, settings), 0.1);
    EXPECT_EQ(property_at(layers, 1, puncture_force, settings), never);
    EXPECT_EQ(property_at(layers, 1, drag, settings), 0);
}

Layers three_labels() {
    Layers layers;
    layers.by_label = true;
    for (const int label : {2, 4, 9}) {
        Layer layer;
        layer.name = std::to_string(label);
        layer.level = label;
        layers.layers.push_back(layer);
    }
    Geometry geometry;
    geometry.size = {5, 1, 1};
    const Volume labels(geometry, std::vector<std::uint8_t>{0, 2, 4, 9, 7});
    layers.labels = numbered_labels(labels, layers.layers);
    layers.label_volume = "labels.nrrd";
    return layers;
}

std::vector<int> numbers(const Layers& layers) {
    const auto samples = layers.labels->volume().samples<std::uint8_t>();
    return {samples.begin(), samples.end()};
}

TEST(LayerSet, the_places_of_labels_follow_their_order) {
    const Layers layers = three_labels();
    EXPECT_EQ(numbers(layers), (std::vector{0, 1, 2, 3, 0}));
    const Layers moved = moved_layer(layers, 2, 0);
    EXPECT_EQ(moved.layers[0].level, 9);
    EXPECT_EQ(numbers(moved), (std::vector{0, 2, 3, 1, 0}));
    EXPECT_EQ(numbers(moved_layer(moved, 0, 2)), numbers(layers));
    EXPECT_EQ(numbers(without_layer(layers, 1)), (std::vector{0, 1, 0, 2, 0}));
    EXPECT_NO_THROW(check(moved, Solid::above));
}

TEST(LayerSet, outside_of_labels_is_no_layer_although_every_sample_is_in_one) {
    Layers layers = three_labels();
    Geometry geometry;
    geometry.size = {3, 1, 1};
    layers.labels =
        numbered_labels(Volume(geometry, std::vector<std::uint8_t>{2, 4, 9}), layers.layers);
    EXPECT_EQ(layers.labels->background(), 0);
    EXPECT_EQ(moved_layer(layers, 2, 0).labels->background(), 0);
}

TEST(LayerSet, labels_have_no_levels_to_see_and_do_not_nest) {
    const SharedLayers labels = shared(three_labels());
    EXPECT_TRUE(have_surfaces(labels));
    EXPECT_EQ(levels_in(labels), 0U);
    Look look;
    EXPECT_FALSE(scene_look(look, labels).surface);
    EXPECT_TRUE(scene_look(look, labels).surfaces.empty());
    EXPECT_EQ(slice_look(look, labels), look);
    EXPECT_EQ(felt_words({2, 2, 0}, labels), "on 9, in 4");
    EXPECT_EQ(felt_words({-1, 3, 0}, labels), "in 9");
    EXPECT_EQ(felt_words({2, 3, 0}, labels), "on 9, from inside");
    EXPECT_EQ(felt_words({-1, 0, 0}, labels), "");
}

TEST(LayerSet, levels_beside_labels_are_seen_and_nest_and_labels_do_not) {
    Layers layers = three_labels();
    const Layers only = layers;
    layers.levels_beside_labels = 2;
    layers.labels.reset();
    layers.layers = {only.layers[0], only.layers[1], only.layers[2]};
    layers.layers[0].level = 9;  // a level, though there is a label 9, too
    layers.layers[1].level = 50;
    Geometry geometry;
    geometry.size = {3, 1, 1};
    layers.labels = numbered_labels(Volume(geometry, std::vector<std::uint8_t>{0, 9, 4}),
                                    layers.layers, layers.levels_beside_labels);
    EXPECT_EQ(numbers(layers), (std::vector{0, 3, 0}));
    const SharedLayers both = shared(layers);
    EXPECT_EQ(levels_in(both), 2U);
    Look look;
    look.surface = true;
    EXPECT_TRUE(scene_look(look, both).surface);
    ASSERT_EQ(scene_look(look, both).surfaces.size(), 1U);
    EXPECT_EQ(scene_look(look, both).surfaces[0].level, 50);
    EXPECT_EQ(slice_look(look, both).surfaces.size(), 2U);
    EXPECT_EQ(felt_words({2, 2, 0}, both), "on 9, in 4, 2") << "two levels nest";
    EXPECT_EQ(felt_words({2, 3, 0}, both), "on 9, from inside");
    EXPECT_EQ(felt_words({-1, 3, 0}, both), "in 9");
    EXPECT_EQ(room_of(layers, 0, 1).high, 49) << "labels bound no level";
    const Layers less = without_layer(layers, 0);
    EXPECT_EQ(less.levels_beside_labels, 1U);
    EXPECT_EQ(numbers(less), (std::vector{0, 2, 0}));
    EXPECT_NO_THROW(check(less, Solid::above));
}

TEST(LayerSet, a_label_may_have_the_viscosity_of_any_other_beside_it) {
    RendererSettings settings;
    Layers layers = three_labels();
    layers.layers[0][HapticProperty::stiffness] = 4.5;
    EXPECT_FALSE(lowered_stiffness(layers, 0, settings));
    layers.layers[2][HapticProperty::viscosity] = 1e-3;
    EXPECT_TRUE(lowered_stiffness(layers, 0, settings));
}

TEST(LayerSet, by_label_a_session_keeps_the_name_of_the_label_volume_relative_to_its_folder) {
    const support::ScratchFolder folder;
    SessionFile session;
    session.source = run::source_named("synthetic:sphere:16x16x16");
    Layers layers = three_labels();
    layers.label_volume = (folder.path() / "labels.nrrd").string();
    session.settings.emplace();
    session.settings->layers = shared(layers);
    write_session(folder.path() / "s.json", session);
    std::filesystem::create_directory(folder.path() / "moved");
    std::filesystem::rename(folder.path() / "s.json", folder.path() / "moved" / "s.json");
    const SessionFile read = read_session(folder.path() / "moved" / "s.json");
    ASSERT_TRUE(lack_labels(read.settings->layers));
    EXPECT_EQ(read.settings->layers->label_volume,
              (folder.path() / "moved" / "labels.nrrd").string());
    EXPECT_EQ(read.settings->layers->layers.size(), 3U);
}

TEST(LayersHistory, labels_of_many_steps_take_bounded_memory) {
    LayersHistory history(3 * 5);
    Layers layers = three_labels();
    for (int i = 0; i < 7; ++i) {
        history.keep(shared(layers), false);
        history.keep(shared(layers), false);  // the same labels
        layers = moved_layer(layers, 2, 0);
    }
    int back = 0;
    while (history.undo(nullptr)) ++back;
    EXPECT_EQ(back, 6);
}

TEST(LayersHistory, goes_back_and_forward_and_a_drag_is_one_step) {
    LayersHistory history;
    const SharedLayers a = shared({}), b = shared(skin_and_bone()), c = shared({}), d = shared({});
    history.keep(a, false);  // a -> b
    history.keep(b, false);  // b -> c, a drag
    history.keep(c, true);   // c -> d, of the same drag
    EXPECT_EQ(history.undo(d), b);
    EXPECT_EQ(history.undo(b), a);
    EXPECT_FALSE(history.undo(a));
    EXPECT_EQ(history.redo(a), b);
    EXPECT_EQ(history.redo(b), d);
    EXPECT_FALSE(history.redo(d));
    history.keep(d, false);
    EXPECT_EQ(history.undo(c), d);
    history.keep(a, false);
    EXPECT_FALSE(history.can_redo()) << "another change ends what was undone";
    LayersHistory empty;
    EXPECT_FALSE(empty.undo(a));
}

Snapshot pressed(double time, double depth, double force, int touched, int inside) {
    Snapshot now;
    now.normal = Vec3(0, 0, 1);
    now.session.tick.time = time;
    now.session.tick.proxy.scp = Vec3(0, 0, 5);
    now.session.tick.proxy.hip = Vec3(0, 0, 5 - depth);
    now.session.tick.force = Vec3(0, 0, force);
    now.session.tick.layers = {static_cast<std::int8_t>(touched), static_cast<std::int8_t>(inside),
                               0};
    return now;
}

TEST(Stroke, has_force_by_depth_and_layer_from_the_first_contact) {
    Stroke stroke;
    EXPECT_FALSE(stroke.add(pressed(0, -1, 0, -1, 0)));
    EXPECT_TRUE(stroke.add(pressed(0.1, 0.5, 0.2, 0, 0)));
    EXPECT_TRUE(stroke.add(pressed(0.2, 2, 1.1, 0, 0)));
    EXPECT_FALSE(stroke.add(pressed(0.3, 2, 1.1, 0, 0))) << "a hand at rest";
    EXPECT_TRUE(stroke.add(pressed(0.4, 3, 0.1, 1, 1)));
    ASSERT_EQ(stroke.points().size(), 3U);
    EXPECT_EQ(stroke.points()[1].depth, 2);
    EXPECT_EQ(stroke.points()[1].force, 1.1);
    EXPECT_EQ(stroke.points()[2].layer, 1);
}

TEST(Stroke, another_begins_at_a_contact_after_the_hand_was_outside_for_a_while) {
    Stroke stroke;
    stroke.add(pressed(0, 1, 0.5, 0, 0));
    stroke.add(pressed(0.5, -3, 0, -1, 0));
    stroke.add(pressed(1, 1, 0.7, 0, 0));
    EXPECT_EQ(stroke.points().size(), 2U) << "a moment outside";
    for (double t = 1.1; t < 4; t += 0.1) stroke.add(pressed(t, -3, 0, -1, 0));
    EXPECT_EQ(stroke.points().size(), 2U) << "to be looked at";
    stroke.add(pressed(4.1, 1, 0.9, 0, 0));
    ASSERT_EQ(stroke.points().size(), 1U);
    EXPECT_EQ(stroke.points()[0].force, 0.9);
    EXPECT_TRUE(stroke.add(pressed(1, 1, 0.9, 0, 0))) << "time went back";
    EXPECT_EQ(stroke.points().size(), 1U);
}

TEST(Stroke, memory_is_bounded) {
    Stroke stroke;
    for (int i = 0; i < 30'000; ++i) stroke.add(pressed(1e-3 * i, i % 2 ? 1 : 2, 0.5, 0, 0));
    EXPECT_LE(stroke.points().size(), Stroke::most_points);
}

TEST(SessionFile, keeps_layers) {
    const support::ScratchFolder folder;
    SessionFile session;
    session.source.from = run::SyntheticSource{"sphere:32x32x32", SampleType::uint8};
    session.settings.emplace();
    Layers layers = skin_and_bone();
    layers.needle = Needle{0.25, 1.5, 2};
    layers[HapticProperty::stiffness].density.knots = {{0, 0.1}, {300, 1.0 / 3}};
    session.settings->layers = shared(layers);
    write_session(folder / "s.json", session);
    const SessionFile again = read_session(folder / "s.json");
    ASSERT_TRUE(again.settings && again.settings->layers);
    EXPECT_TRUE(same(again.settings->layers, session.settings->layers));
    session.solid = Solid::below;
    EXPECT_THROW(write_session(folder / "t.json", session), std::invalid_argument)
        << "levels in the order of the other side";
}

TEST(LayerSet, sets_are_the_same_where_their_files_are) {
    Layers layers = skin_and_bone();
    const SharedLayers one = shared(layers), copy = shared(layers);
    EXPECT_TRUE(same(one, copy));
    layers.layers[1].opacity = 0.5;
    EXPECT_FALSE(same(one, shared(layers)));
    EXPECT_FALSE(same(one, nullptr));
    EXPECT_TRUE(same(nullptr, nullptr));
    for (const io::LayersPreset& preset : io::layers_presets()) {
        EXPECT_TRUE(same(shared(preset.file.layers), shared(preset.file.layers)));
    }
}

}  // namespace
}  // namespace palpate::viewer
