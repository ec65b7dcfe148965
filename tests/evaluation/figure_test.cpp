// Figures are drawn as they are described.
#include "evaluation/figure.hpp"

#include <gtest/gtest.h>

#include "support/scratch_folder.hpp"

namespace palpate::evaluation {
namespace {

using support::bytes_of;
using support::contains;

std::string svg_of(const Figure& figure) {
    const support::ScratchFolder folder;
    draw(figure, folder / "figure.svg");
    return bytes_of(folder / "figure.svg");
}

TEST(Figure, every_way_to_draw_a_series_is_drawn_with_its_title_in_the_key) {
    Figure figure;
    figure.columns = 2;
    figure.panels.resize(2);
    const Rows points{{1, 2}, {2, 4}, {}, {3, 1}};
    const Rows boxes{{1, 2, 1, 2}};
    for (Panel& panel : figure.panels) {
        panel.y.low = 0;
        panel.series = {{Draw::area, "an area", {}, points},
                        {Draw::boxes, "boxes", {}, boxes},
                        {Draw::segments, "segments", {}, boxes},
                        {Draw::line, "a line", {.dash = Dash::dashed}, points},
                        {Draw::points, "points", {.marker = Marker::circle}, points},
                        {Draw::line_points, "both", look_of(3), points},
                        {Draw::level, "a level", {}, {{3}}}};
        panel.series.push_back({Draw::text, "", {}, {{1, 3}}, {"some text"}});
    }
    figure.panels[1].title = "to the right";
    const std::string svg = svg_of(figure);
    const auto count = [](const std::string& text, const char* what) {
        std::size_t found = 0;
        for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) {
            ++found;
        }
        return found;
    };
    for (const char* text : {"an area", "boxes", "segments", "a line", "points", "both", "a level",
                             "some text", "to the right"}) {
        EXPECT_TRUE(contains(svg, text)) << text;
    }
    figure.panels.pop_back();
    figure.columns = 1;
    EXPECT_EQ(count(svg, "a level"), count(svg_of(figure), "a level"));  // in the key once
}

TEST(Figure, the_title_of_an_axis_has_room_beside_long_numbers) {
    Figure figure;
    figure.panels.resize(1);
    Panel& panel = figure.panels[0];
    panel.y.title = "angle, mean";
    panel.y.is_logarithmic = true;
    panel.series = {{Draw::line, "", {}, {{1, 1e-4}, {2, 100}}}};
    const std::string svg = svg_of(figure);
    EXPECT_TRUE(contains(svg, "0.0001"));
    EXPECT_TRUE(contains(svg, "angle, mean")) << "gnuplot leaves out what begins outside";
}

TEST(Figure, a_map_has_a_scale_of_colours_and_its_texts) {
    Figure figure;
    figure.panels.resize(1);
    Panel& panel = figure.panels[0];
    panel.scale = ColourScale{"share [%]", 0, 100, false};
    panel.series = {{Draw::cells, "", {}, {{0, 0, 10}, {1, 0, 50}, {0, 1, 90}, {1, 1, 100}}}};
    panel.x.ticks = axis_named({"left", "right\nside"}).ticks;
    const std::string svg = svg_of(figure);
    for (const char* text : {"share [%]", "left", "right", "side"}) {
        EXPECT_TRUE(contains(svg, text)) << text;
    }
}

TEST(Figure, a_name_is_never_read_as_a_command) {
    Figure figure;
    figure.panels.resize(1);
    figure.panels[0].title = "it's `echo run` \"$x\" {/Bold a_b}";
    figure.panels[0].series = {{Draw::points, "b'`echo run`", {.marker = Marker::plus}, {{1, 1}}}};
    const std::string svg = svg_of(figure);
    EXPECT_TRUE(contains(svg, "it's `echo run`"));
    EXPECT_TRUE(contains(svg, "{/Bold a_b}"));
    EXPECT_TRUE(contains(svg, "b'`echo run`"));
}

TEST(Figure, methods_look_the_same_everywhere_and_differ_in_colour_and_marker) {
    EXPECT_STREQ(look_of_method("exact").colour, look_of(0).colour);
    EXPECT_STRNE(look_of_method("exact").colour, look_of_method("paper").colour);
    EXPECT_NE(look_of_method("exact").marker, look_of_method("paper").marker);
}

}  // namespace
}  // namespace palpate::evaluation
