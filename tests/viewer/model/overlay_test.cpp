// Overlays: which volumes are label maps, and masks of their labels. Colour maps.
#include <gtest/gtest.h>
#include <cmath>
#include <set>

#include "apps/viewer/model/measurement.hpp"
#include "apps/viewer/model/overlay.hpp"
#include "apps/viewer/model/transfer.hpp"
#include "palpate/field.hpp"
#include "support/fields.hpp"

namespace palpate::viewer {
namespace {

const run::Source somewhere = run::source_named("synthetic:sphere");

run::LoadedVolume loaded(const Volume& volume) {
    run::LoadedVolume result = run::load(run::source_named("synthetic:sphere:8x8x8"));
    result.volume = volume;
    return result;
}

TEST(Overlay, of_few_whole_numbers_is_a_label_map_and_knows_where_each_lies) {
    const Volume volume = support::volume_of<std::uint8_t>(
        support::grid({10, 12, 14}, {1, 2, 3}, {5, 6, 7}), [](const Index3& i) {
            return i == Index3(1, 2, 3) || i == Index3(4, 2, 9) ? 3 : i[0] == 9 ? 200 : 0;
        });
    const Overlay overlay = make_overlay(loaded(volume), somewhere);
    ASSERT_TRUE(overlay.is_label_map());
    ASSERT_EQ(overlay.labels.size(), 2U);
    EXPECT_EQ(overlay.labels[0].value, 3);
    EXPECT_EQ(overlay.labels[0].name, "Label 3");
    EXPECT_EQ(overlay.labels[0].box, (SampleBox{Index3(1, 2, 3), Index3(4, 2, 9)}));
    EXPECT_EQ(overlay.labels[1].box, (SampleBox{Index3(9, 0, 0), Index3(9, 11, 13)}));
    EXPECT_FALSE(overlay.labels[0].colour == overlay.labels[1].colour);
}

TEST(Overlay, names_and_colours_are_the_headers) {
    const Volume volume = support::volume_of<float>(support::grid(support::cube(4)),
                                                    [](const Index3& i) { return i[0]; });
    run::LoadedVolume from = loaded(volume);
    from.values.labels = {{2, "liver", {0.5, 0.25, 0}}, {77, "nowhere", {1, 1, 1}}};
    const Overlay overlay = make_overlay(from, somewhere);
    ASSERT_EQ(overlay.labels.size(), 3U);
    EXPECT_EQ(overlay.labels[1].name, "liver");
    EXPECT_EQ(overlay.labels[1].colour, (Colour{0.5, 0.25, 0}));
    EXPECT_EQ(overlay.labels[2].name, "Label 3");
}

TEST(Overlay, of_many_values_or_of_parts_is_an_image_with_its_window) {
    const Geometry g = support::grid(support::cube(10));
    for (const Volume& volume :
         {support::noise_volume<std::uint8_t>(g, 1, 0, 256),
          support::volume_of<float>(g, [](const Index3& i) { return 0.5 * i[0]; })}) {
        run::LoadedVolume from = loaded(volume);
        const Overlay overlay = make_overlay(from, somewhere);
        EXPECT_FALSE(overlay.is_label_map());
        EXPECT_EQ(overlay.dark, volume.minimum());
        EXPECT_EQ(overlay.bright, volume.maximum());
        from.values.window = {2, 1};
        EXPECT_EQ(make_overlay(from, somewhere).dark, 1.5);
    }
}

TEST(Overlay, a_mask_lies_where_its_label_does_and_keeps_its_size) {
    const Geometry g =
        support::grid(support::cube(40), {0.5, 1, 1.5}, {-7, 8, 9}, support::oblique_direction());
    const Volume ball = support::volume_of<std::uint8_t>(g, [](const Index3& i) {
        return (i - Index3(20, 18, 22)).cast<double>().norm() < 9 ? 5 : i[0] < 3 ? 1 : 0;
    });
    const Overlay overlay = make_overlay(loaded(ball), somewhere);
    ASSERT_EQ(overlay.labels.size(), 2U);
    const Field mask = linear_field(label_mask(overlay, overlay.labels[1]), Solid::above, 0);
    int wrong = 0;
    for (int n = 0; n < 40 * 40 * 40; ++n) {
        const Index3 at(n % 40, n / 40 % 40, n / 1600);
        const bool inside = value_at(mask, physical_from_index(g, at.cast<double>())) > 0.5;
        wrong += inside != (ball.sample(at) == 5);
    }
    EXPECT_LT(wrong, 100) << "of some 3000: its corners are rounded";
}

TEST(Overlay, a_mask_keeps_what_is_a_sample_wide) {
    const Volume line = support::volume_of<std::uint8_t>(
        support::grid(support::cube(20)),
        [](const Index3& i) { return i[0] == i[1] && i[2] == 10 ? 4 : 0; });
    const Overlay overlay = make_overlay(loaded(line), somewhere);
    const Field mask = linear_field(label_mask(overlay, overlay.labels[0]), Solid::above, 0);
    for (int i = 1; i < 19; ++i) {
        const Vec3 at = physical_from_index(line.geometry(), Vec3(i, i, 10));
        EXPECT_GT(value_at(mask, at), 0.5) << i;
    }
}

TEST(ColourMap, goes_from_dark_to_bright_and_unknown_ones_are_refused) {
    for (const std::string& name : colour_map_names()) {
        const ColourTable table = colour_table(name);
        std::set<std::uint32_t> different(table.begin(), table.end());
        EXPECT_GT(different.size(), 200U) << name;
        for (const std::uint32_t colour : table) EXPECT_EQ(colour >> 24, 0xffU);
    }
    const ColourTable grey = colour_table("grey");
    for (std::uint32_t i = 0; i < 256; ++i) EXPECT_EQ(grey[i], 0xff000000U | 0x010101U * i);
    EXPECT_THROW((void)colour_table("beige"), std::invalid_argument);
    for (int i = 1; i < 30; ++i) EXPECT_FALSE(label_colour(i) == label_colour(i + 1));
}

TEST(Measurement, has_the_unit_and_the_decimals_of_its_grid) {
    const auto text = [](double spacing, double mm, bool measured = true) {
        Geometry grid;
        grid.spacing = Vec3::Constant(spacing);
        grid.measured = measured;
        const Ruler ruler = ruler_of(grid);
        return ruler.number(mm) + " " + ruler.unit;
    };
    EXPECT_EQ(text(1, 12.34), "12.3 mm");
    EXPECT_EQ(text(0.5, 12.34), "12.3 mm");
    EXPECT_EQ(text(0.04, 12.34), "12.340 mm");
    EXPECT_EQ(text(0.005, 0.0123), "12.3 µm");
    EXPECT_EQ(text(0.0003, 0.0123), "12.30 µm");
    EXPECT_EQ(text(1, 12.34, false), "12.3 voxel");
    EXPECT_EQ(text(1, -0.01), "0.0 mm");
    EXPECT_EQ(text(1e-9, 1e-9), "0.000001 µm") << "digits end somewhere";
}

TEST(Measurement, is_put_into_words) {
    EXPECT_EQ(text_of({Measure::length, {{0, 0, 0}, {3, 4, 0}}}), "5 mm");
    EXPECT_EQ(text_of({Measure::length, {{0, 0, 0}, {0, 0, 123.44}}}), "123.4 mm");
    EXPECT_EQ(text_of({Measure::length, {{0, 0, 0}, {0, 0.0125, 0}}}), "0.0125 mm");
    EXPECT_EQ(length_text(25.4, LengthUnit::inches), "1 in");
    EXPECT_EQ(length_text(25.4, LengthUnit::centimetres), "2.54 cm");
    EXPECT_EQ(length_text(0.5, LengthUnit::micrometres), "500.0 µm");
    Geometry field;
    field.spacing.setConstant(5000);
    EXPECT_EQ(length_text(40000, unit_in(field, LengthUnit::automatic)), "40 m");
    EXPECT_EQ(ruler_of(field).number(147500) + " " + ruler_of(field).unit, "147.5 m");
    EXPECT_EQ(length_text(12.34, LengthUnit::voxels, "Voxel"), "12.3 Voxel");
    EXPECT_EQ(text_of({Measure::length, {{0, 0, 0}, {0, 20, 0}}}, LengthUnit::centimetres), "2 cm");
    EXPECT_EQ(text_of({Measure::angle, {{1, 0, 0}, {0, 0, 0}, {0, 2, 0}}}), "90.0°");
    EXPECT_EQ(text_of({Measure::angle, {{1, 0, 0}, {0, 0, 0}, {-3, 0, 0}}}), "180.0°");
    EXPECT_EQ(text_of({Measure::angle, {{1, 0, 0}, {1, 0, 0}, {0, 2, 0}}}), "");
    EXPECT_EQ(text_of({Measure::length, {{1, 0, 0}}}), "");
}

TEST(Measurement, is_in_the_unit_of_positions_however_long_it_is) {
    for (const double spacing : {1e-6, 0.004, 0.04, 1.0, 90.0, 400.0}) {
        Geometry grid;
        grid.spacing.setConstant(spacing);
        for (const double voxels : {0.5, 20.0, 1e4}) {
            const std::string text =
                length_text(voxels * spacing, unit_in(grid, LengthUnit::automatic));
            EXPECT_TRUE(text.ends_with(std::string(" ") + ruler_of(grid).unit)) << text;
        }
    }
}

}  // namespace
}  // namespace palpate::viewer
