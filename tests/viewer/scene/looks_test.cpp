// Compares pictures of the 3-D view with committed references.
#include <gtest/gtest.h>

#include "apps/viewer/scene/render_request.hpp"
#include "apps/viewer/scene/surface_maker.hpp"
#include "palpate/edit.hpp"
#include "palpate/scenes/volumes.hpp"
#include "pictures/vtk/props.hpp"
#include "support/fields.hpp"
#include "viewer/scene/shown_scene.hpp"

namespace palpate::viewer {
namespace {

run::LoadedVolume loaded_from(const Overlay& overlay) {
    run::LoadedVolume loaded = run::load(run::source_named("synthetic:sphere:8x8x8"));
    loaded.volume = overlay.volume;
    return loaded;
}

struct Torus : ShownScene {
    scenes::Scene torus = scenes::make_volume("torus:48x48x32");
    Field field = linear_field(torus.volume);

    explicit Torus(const Look& look) {
        set(scene, &Shown::look, look);
        scene.set_field(field, torus.isovalue);
    }
    /// Pressed on the side that is seen.
    Snapshot pressed() const {
        const RayHit hit = cast_ray(field, torus.isovalue, Vec3(5, -23, 14), Vec3(5, -13, 0));
        EXPECT_TRUE(hit.hit);
        Snapshot snapshot = snapshot_at(hit.point - 6 * hit.normal, hit.point, 0.8 * hit.normal);
        snapshot.scp = locate(index_from_physical(field.geometry(), hit.point));
        snapshot.session.tick.proxy.isovalue = torus.isovalue;
        return snapshot;
    }
};

TEST(ScaleBar, has_the_unit_that_a_person_would_use) {
    const auto words = [](double mm) {
        return pictures::scale_bar(1000, 220 / (1.01 * mm), 12, 1).text;
    };
    EXPECT_EQ(words(5e6), "5 km");
    EXPECT_EQ(words(5e4), "50 m");
    EXPECT_EQ(words(1e3), "1 m");
    EXPECT_EQ(words(500), "50 cm");
    EXPECT_EQ(words(100), "10 cm");
    EXPECT_EQ(words(50), "50 mm");
    EXPECT_EQ(words(1), "1 mm");
    EXPECT_EQ(words(0.5), "500 \xC2\xB5m");
    EXPECT_EQ(words(1e-3), "1 \xC2\xB5m");
    EXPECT_EQ(words(5e-4), "500 nm");
}

TEST(DrawnLooks, show_a_surface_with_probe_proxy_spring_and_force) {
    Torus shown{Look()};
    shown.scene.show_snapshot(shown.pressed());
    expect_as_committed(shown.settled("look_contact"), "contact");
}

TEST(DrawnLooks, show_glass_in_a_dark_window) {
    Look look;
    look.surface_opacity = 0.35;
    Torus shown(look);
    QPalette dark;
    dark.setColor(QPalette::Window, QColor(40, 40, 44));
    shown.scene.setPalette(dark);
    shown.scene.show_snapshot(shown.pressed());
    expect_as_committed(shown.settled("look_glass"), "glass");
}

TEST(DrawnLooks, show_a_volume_with_slices) {
    Look look;
    look.surface = false;
    look.volume = look.slices = true;
    look.transfer.points = {{70, {0.7, 0.3, 0.2}, 0}, {160, pictures::bone, 0.5}};
    Torus shown(look);
    set(shown.scene, &Shown::crosshair, Vec3(8, 6, -6));
    expect_as_committed(shown.settled("look_volume"), "volume");
}

TEST(DrawnLooks, show_lattice_and_planes_round_the_proxy) {
    Look look;
    look.surface_opacity = 0.4;
    look.tetrahedra = look.planes = true;
    look.box = false;
    Torus shown(look);
    // The hand presses at a wall between two tetrahedra.
    Snapshot snapshot = shown.pressed();
    const Vec3 index = index_of(snapshot.scp);
    LatticePoint on_wall = snapshot.scp;
    on_wall.folded = snap(on_wall.folded, 1U << wall_plus);
    snapshot.scp = on_wall;
    const Vec3 scp = physical_from_index(shown.field.geometry(), index_of(on_wall));
    EXPECT_LT((index_of(on_wall) - index).norm(), 1);
    snapshot.session.tick.proxy.scp = scp;
    snapshot.session.tick.proxy.isovalue = value_at(shown.field, on_wall);
    Camera camera = shown.scene.camera();
    camera.focus = scp;
    camera.half_height = 2.2;
    shown.scene.set_camera(camera);
    shown.scene.show_snapshot(snapshot);
    expect_as_committed(shown.settled("look_lattice"), "lattice");
}

TEST(DrawnLooks, show_several_surfaces_cut_open) {
    Look look;
    look.surface_opacity = 0.35;
    look.surfaces = {{200, {0.84, 0.37, 0.25}, 1, true}};
    look.cut = Cut::plane;
    look.cut_plane = {Vec3(0, 0, 0), Vec3(1, -0.3, 0.2).normalized()};
    Torus shown(look);
    expect_as_committed(shown.settled("look_surfaces"), "surfaces");
}

TEST(DrawnLooks, show_labels_inside_glass) {
    Look look;
    look.surface_opacity = 0.35;
    Torus shown(look);
    Overlay overlay{run::source_named("synthetic:torus"),
                    support::volume_of<std::uint8_t>(
                        support::grid({24, 24, 16}, {2, 2, 2}, {-23, -23, -15}),
                        [&](const Index3& i) {
                            const Vec3 at = 2 * i.cast<double>() - Vec3(23, 23, 15);
                            const bool inside = value_at(shown.field, at) > 150;
                            return inside ? at[0] < 0 ? 1 : 2 : 0;
                        }),
                    {}};
    overlay = make_overlay(loaded_from(overlay), overlay.source);
    std::vector<DrawnSurface> surfaces;
    for (const auto& surface : label_surfaces(overlay, [](double) {})) {
        const Label& label = overlay.labels[surfaces.size()];
        surfaces.push_back(
            {surface, label.colour, 1,
             physical_centre(overlay.volume.geometry()) - physical_centre(shown.field.geometry())});
    }
    shown.scene.set_overlay(surfaces);
    expect_as_committed(shown.settled("look_labels"), "labels");
}

TEST(DrawnLooks, show_an_edit_while_the_brush_is_on) {
    Torus shown{Look()};
    const Snapshot pressed = shown.pressed();
    edit::Stroke stroke;
    stroke.brush = brush_for(BrushKind::carve, shown.field, shown.torus.isovalue, 5);
    stroke.from = stroke.to = pressed.session.tick.proxy.scp;
    Field field = shown.field;
    field.use(edited(field.shared_samples(), stroke).samples);
    shown.settled();
    shown.scene.update_field(field);
    set(shown.scene, &Shown::brush, 5);
    shown.scene.show_snapshot(pressed);
    expect_as_committed(shown.settled("look_edit"), "edit");
}

}  // namespace
}  // namespace palpate::viewer
