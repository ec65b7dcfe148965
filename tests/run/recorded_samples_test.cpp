// Samples that are made again from their recipes.
#include "palpate/run/recorded_samples.hpp"

#include <cstring>

#include "io/recording/settings_json.hpp"
#include "run/run_support.hpp"
#include "support/random.hpp"

namespace palpate::run {
namespace {

bool same_bits(const Samples& a, const Samples& b) {
    const Volume left = flattened(a), right = flattened(b);
    return left.bytes() == right.bytes() &&
           std::memcmp(left.data(), right.data(), left.bytes()) == 0;
}

/// To a line of a recording and back.
Command through_json(const Command& command, io::Bodies& written, io::Bodies& read) {
    return io::command_from_json(io::Json::parse(io::to_json(command, written).dump()), read);
}
Command through_json(const Command& command) {
    io::Bodies written, read;
    return through_json(command, written, read);
}

TEST(RecordedSamples, versions_come_out_as_they_were_felt) {
    const Field field = linear_field(test::loaded("synthetic:noise:24x24x24").volume);
    Brush brush = brush_for(BrushKind::add, field, 100.123456789, 3.3);
    brush.hardness = 0.3;
    brush.strength = 1.0 / 3;
    brush.solid = Solid::above;
    Editor editor(field.shared_samples());
    const Brush drill = brush_for(BrushKind::carve, field, 90, 0.5);
    const auto body_of = [&](const Tool& tool) {
        return std::make_shared<const ToolBody>(
            body_for(drill, field.geometry(), std::make_shared<const Tool>(tool)));
    };
    const auto burr = body_of(burr_tool(2.3, 0.5)), box = body_of(box_tool({2, 3, 4}, 0.5));
    const Quaternion tilted = turned({1, 0, 0, 0}, {0.3, 0.2, 0.1});
    RecordedSamples again(field.shared_samples());
    std::vector<std::shared_ptr<const Samples>> felt{field.shared_samples()};
    const std::vector<Edit> edits{
        edit::Stroke{brush, {0.1, 0.2, 0.3}, {5.5, 1e-3, -4}},
        edit::Fill{{{-3, 2, 2}, {9, 9, 40}}, 7.5},
        edit::Stroke{brush_for(BrushKind::carve, field, 90, 5), {1, 2, 3}, {1, 2, 3}},
        edit::Sweep{drill, burr, {{1, 2, 3}, tilted}, {{4, 2.5, -3}, {1, 0, 0, 0}}},
        edit::Sweep{drill, box, {{-4, 0.1, 3}, tilted}, {{4, 2.5, 1.0 / 3}, tilted}},
        edit::Sweep{drill, burr, {{4, 2.5, -3}, {1, 0, 0, 0}}, {{5, 2, 1}, tilted}}};
    io::Bodies written, read;
    for (std::size_t i = 0; i < edits.size(); ++i) {
        editor.apply(edits[i]);
        felt.push_back(editor.samples());
        const Command recorded =
            command::Samples{nullptr, i + 1, std::make_shared<const Recipe>(EditOf{i, edits[i]})};
        const auto whole =
            std::get<command::Samples>(again.whole(through_json(recorded, written, read)));
        EXPECT_TRUE(same_bits(*whole.samples, *felt.back())) << i;
        EXPECT_EQ(whole.version, i + 1);
    }
    EXPECT_EQ(read.size(), 2U) << "a body is written once";
    // Back to one that was there, and to the start.
    for (const std::uint64_t version : {1U, 0U, 3U}) {
        const Command recorded = command::Samples{nullptr, version};
        const auto whole = std::get<command::Samples>(again.whole(through_json(recorded)));
        EXPECT_TRUE(same_bits(*whole.samples, *felt[version]));
    }
}

TEST(RecordedSamples, of_many_versions_few_are_in_memory_and_all_can_be_had) {
    const Field field = linear_field(test::loaded("synthetic:noise:24x24x24").volume);
    RecordedSamples again(field.shared_samples());
    std::vector<std::shared_ptr<const Samples>> felt{field.shared_samples()};
    support::Random random(12);
    for (std::uint64_t version = 1; version <= 300; ++version) {
        // Mostly on and on, now and then from one that was undone to.
        const auto of =
            random.chance(0.9) ? version - 1 : std::uint64_t(random.below(int(version)));
        const Index3 low(random.below(20), random.below(20), random.below(20));
        const Edit fill = edit::Fill{{low, low + Index3::Constant(3)}, random.uniform(0, 200)};
        felt.push_back(edited(felt[of], fill).samples);
        const Command recorded =
            command::Samples{nullptr, version, std::make_shared<const Recipe>(EditOf{of, fill})};
        const auto whole = std::get<command::Samples>(again.whole(through_json(recorded)));
        EXPECT_TRUE(same_bits(*whole.samples, *felt.back())) << version;
    }
    EXPECT_LE(again.kept(), 300U / 6);
    for (int i = 0; i < 300; ++i) {
        const auto version = std::uint64_t(random.below(301));
        EXPECT_TRUE(same_bits(*again.of(version), *felt[version])) << version;
    }
    EXPECT_LE(again.kept(), 300U / 6);
}

TEST(RecordedSamples, a_version_that_comes_about_twice_is_refused) {
    const Field field = linear_field(test::loaded("synthetic:sphere:16x16x16").volume);
    RecordedSamples again(field.shared_samples());
    const auto made = [](std::uint64_t version, std::uint64_t of) {
        return Command(command::Samples{
            nullptr, version,
            std::make_shared<const Recipe>(EditOf{of, edit::Fill{{{1, 1, 1}, {2, 2, 2}}, 3}})});
    };
    EXPECT_THROW(again.whole(made(0, 0)), std::invalid_argument);
    EXPECT_THROW(again.whole(made(5, 5)), std::invalid_argument);
    (void)again.whole(made(5, 0));
    EXPECT_THROW(again.whole(made(5, 0)), std::invalid_argument);
    EXPECT_THROW(again.whole(made(5, 5)), std::invalid_argument);
}

TEST(RecordedSamples, what_came_from_outside_is_refused_with_its_reason) {
    const Field field = linear_field(test::loaded("synthetic:sphere:16x16x16").volume);
    RecordedSamples again(field.shared_samples());
    const Edit put = edit::Replace{{1, 1, 1}, field.volume()};
    const Command replaced =
        command::Samples{nullptr, 1, std::make_shared<const Recipe>(EditOf{0, put})};
    EXPECT_THROW(again.whole(through_json(replaced)), std::invalid_argument);
    EXPECT_THROW(again.whole(command::Samples{nullptr, 5}), std::invalid_argument);
    const auto frames = std::make_shared<const Recipe>(FramesOf{{0, 1}, {0, 1}, 0});
    EXPECT_THROW(again.whole(command::Samples{nullptr, 2, frames}), std::invalid_argument);
}

TEST(RecordedSamples, damaged_recipes_are_refused) {
    const auto refused = [](const std::string& text) {
        io::Bodies bodies;
        EXPECT_THROW(io::command_from_json(io::Json::parse(text), bodies), std::invalid_argument)
            << text;
    };
    refused(R"({"samples":{}})");
    const std::string sweep =
        R"({"samples":{"version":1,"of":0,"edit":{"sweep":{"kind":"carve","radius":1,"hardness":1,)"
        R"("strength":1,"level":1,"solid":"above","value":0,)"
        R"("from":{"position":[0,0,0],"wxyz":[1,0,0,0]},"to":{"position":[0,0,0],"wxyz":[1,0,0]},)";
    refused(sweep + R"("body":0}}}})");
    refused(sweep +
            R"("body":{"tool":{"points":[[0,0,0]],"gyration":1,"turns":false},"step":1}}}}})");
    refused(R"({"samples":{"version":-1}})");
    refused(R"({"samples":{"version":1,"of":0,"edit":{"stroke":{"kind":"carve"}}}})");
    refused(R"({"samples":{"version":1,"of":"x","edit":{"fill":{}}}})");
    refused(
        R"({"samples":{"version":1,"of":0,"edit":{"fill":{"low":[0,0],"high":[1,1,1],"value":1}}}})");
    refused(
        R"({"samples":{"version":1,"of":0,"edit":{"fill":{"low":[0,0,1e9],"high":[1,1,1],"value":1}}}})");
    refused(R"({"samples":{"version":1,"frames":[0,1],"times":[0],"period":0}})");
    refused(R"({"samples":{"version":1,"frames":[-1],"times":[0],"period":0}})");
    refused(R"({"samples":{"version":1,"frames":5,"times":[0],"period":0}})");
}

}  // namespace
}  // namespace palpate::run
