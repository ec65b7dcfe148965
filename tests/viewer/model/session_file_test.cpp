// Sessions in files: everything comes back, and nothing damaged gets in.
#include "apps/viewer/model/session_file.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "palpate/io/error.hpp"
#include "support/fields.hpp"
#include "support/random.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::viewer {
namespace {

using support::bytes_of;
using support::contains;
using support::message_of;
using support::put_bytes;
using support::ScratchFolder;
using Json = nlohmann::ordered_json;

constexpr double infinity = std::numeric_limits<double>::infinity();

SessionFile some_session() {
    SessionFile s;
    s.source.from = run::SyntheticSource{"sphere:32x32x32", SampleType::uint16};
    s.source.smooth = 2;
    s.solid = Solid::below;
    s.interpolation = Interpolation::cubic;
    s.background = 0.1 + 0.2;
    s.isovalue = 1.0 / 3;
    s.device = {"haply", {{"port", "10001"}}};
    s.buttons = {run::Button{3}, run::Button{1}};
    s.settings.emplace();
    s.settings->proxy.friction = {0.3, 0.2};
    s.settings->proxy.step_budget = 777;
    const std::array<DensityRange, 2> ranges{DensityRange{30, infinity}, DensityRange{1, 20}};
    s.settings->penetrability = penetrability_ranges(0.7, ranges, Solid::below);
    s.settings->force.rate_limit = infinity;
    s.settings->force.start_below = 0.3;
    s.settings->device.maximum_force = 7.9;
    s.settings->transform = {support::oblique_direction(), Vec3(0.1, 0.2, 0.3), 1.7};
    s.settings->forces_on = false;
    s.look.surface = false;
    s.look.surface_colour = {0.1, 0.2, 0.3};
    s.look.surface_opacity = 0.4;
    s.look.surfaces = {{1.5, {1, 0, 0.5}, 0.3, true}, {-4, {0.25, 0, 0}, 1, false}};
    s.look.cut = Cut::box;
    s.look.cut_plane = {{1, 2, 3}, {0, 0.6, 0.8}};
    s.look.cut_box = {{0.1, 0, 0.2}, {0.9, 1, 0.3}};
    s.look.volume = true;
    s.look.transfer = {"CT \"bone\"", {{-5, {0, 0, 0}, 0}, {7.5, {1, 0.5, 0}, 0.25}}};
    s.look.shading = false;
    s.look.maximum = true;
    s.look.slices = s.look.tetrahedra = s.look.planes = true;
    s.look.contact = s.look.box = s.look.orientation = s.look.scale_bar = false;
    s.camera = pictures::Camera{{1, 2, 3}, {0.5, 0.5, 0.1}, {0, 0, 2}, 123.456};
    s.crosshair = Vec3(-7, 8.25, 9);
    s.follow = false;
    s.window_low = -100.5;
    s.window_high = 900;
    s.slices_shown = false;
    s.measurements = {{Measure::length, {{1, 2, 3}, {4.5, 5, 6}}},
                      {Measure::angle, {{1, 0, 0}, {0, 0, 0}, {0, 0.1, 0}}}};
    return s;
}

/// Everything but where the volume lies.
void expect_same(const SessionFile& a, const SessionFile& b) {
    EXPECT_EQ(a.solid, b.solid);
    EXPECT_EQ(a.interpolation, b.interpolation);
    EXPECT_EQ(a.background, b.background);
    EXPECT_EQ(a.isovalue, b.isovalue);
    EXPECT_EQ(a.device, b.device);
    EXPECT_EQ(a.buttons, b.buttons);
    EXPECT_EQ(a.method.method, b.method.method);
    EXPECT_EQ(a.settings->proxy.friction.static_coefficient,
              b.settings->proxy.friction.static_coefficient);
    EXPECT_EQ(a.settings->proxy.step_budget, b.settings->proxy.step_budget);
    EXPECT_EQ(a.settings->penetrability.on, b.settings->penetrability.on);
    EXPECT_EQ(a.settings->penetrability.threshold, b.settings->penetrability.threshold);
    ASSERT_EQ(a.settings->penetrability.range_count, b.settings->penetrability.range_count);
    for (int i = 0; i < a.settings->penetrability.range_count; ++i) {
        const auto at = static_cast<std::size_t>(i);
        EXPECT_EQ(a.settings->penetrability.ranges[at].low,
                  b.settings->penetrability.ranges[at].low);
        EXPECT_EQ(a.settings->penetrability.ranges[at].high,
                  b.settings->penetrability.ranges[at].high);
    }
    EXPECT_EQ(a.settings->force.rate_limit, b.settings->force.rate_limit);
    EXPECT_EQ(a.settings->force.start_below, b.settings->force.start_below);
    EXPECT_EQ(a.settings->device.maximum_force, b.settings->device.maximum_force);
    EXPECT_EQ(a.settings->transform.rotation, b.settings->transform.rotation);
    EXPECT_EQ(a.settings->transform.translation, b.settings->transform.translation);
    EXPECT_EQ(a.settings->transform.scale, b.settings->transform.scale);
    EXPECT_EQ(a.settings->forces_on, b.settings->forces_on);
    EXPECT_EQ(a.look, b.look);
    EXPECT_EQ(a.camera->focus, b.camera->focus);
    EXPECT_EQ(a.camera->towards_viewer, b.camera->towards_viewer);
    EXPECT_EQ(a.camera->up, b.camera->up);
    EXPECT_EQ(a.camera->half_height, b.camera->half_height);
    EXPECT_EQ(a.crosshair, b.crosshair);
    EXPECT_EQ(a.follow, b.follow);
    EXPECT_EQ(a.window_low, b.window_low);
    EXPECT_EQ(a.window_high, b.window_high);
    EXPECT_EQ(a.slices_shown, b.slices_shown);
    EXPECT_EQ(a.measurements, b.measurements);
}

TEST(SessionFile, everything_comes_back_bit_for_bit) {
    const ScratchFolder folder;
    const SessionFile before = some_session();
    write_session(folder / "s.json", before);
    const SessionFile after = read_session(folder / "s.json");
    expect_same(before, after);
    EXPECT_EQ(run::to_names(after.source), run::to_names(before.source));
    EXPECT_EQ(run::to_names(after.source).at("type"), "uint16");
    EXPECT_EQ(after.source.smooth, 2);
    EXPECT_EQ(after.settings->method, &update_exact);
    write_session(folder / "again.json", after);
    EXPECT_EQ(bytes_of(folder / "again.json"), bytes_of(folder / "s.json"));
}

TEST(SessionFile, keeps_a_second_hand) {
    const ScratchFolder folder;
    SessionFile before = some_session();
    before.others.push_back({{"falcon", {{"index", "1"}}}, 2.0 / 3, before.settings});
    before.others[0].settings->force.stiffness = 0.123;
    write_session(folder / "s.json", before);
    const SessionFile after = read_session(folder / "s.json");
    expect_same(before, after);
    ASSERT_EQ(after.others.size(), 1U);
    EXPECT_EQ(after.others[0].device, before.others[0].device);
    EXPECT_EQ(after.others[0].isovalue, before.others[0].isovalue);
    EXPECT_EQ(after.others[0].settings->force.stiffness, 0.123);
    before.others.push_back(before.others[0]);
    EXPECT_TRUE(contains(
        message_of<std::invalid_argument>([&] { write_session(folder / "three.json", before); }),
        "'hands'"));
    put_bytes(folder / "no.json", R"({"format": "palpate-session", "version": 1, "isovalue": 300,
        "volume": {"volume": "synthetic:torus"}, "hands": [{"device": "mouse"}]})");
    EXPECT_THROW((void)read_session(folder / "no.json"), io::InputError);
}

TEST(SessionFile, a_volume_and_a_level_are_enough) {
    const ScratchFolder folder;
    put_bytes(folder / "s.json", R"({"format": "palpate-session", "version": 1, "isovalue": 300,
        "volume": {"volume": "synthetic:torus"}, "flavour": ["unknown"], "look": {"fog": 1}})");
    const SessionFile read = read_session(folder / "s.json");
    EXPECT_EQ(read.isovalue, 300);
    EXPECT_EQ(read.look, Look{});
    EXPECT_EQ(read.device, SessionFile{}.device);
    EXPECT_EQ(read.buttons, run::Buttons{});
    EXPECT_EQ(read.interpolation, Interpolation::cubic);  // as of a volume without a session
    EXPECT_FALSE(read.background || read.settings || read.camera || read.crosshair);
    // And as little comes back.
    write_session(folder / "again.json", read);
    EXPECT_FALSE(read_session(folder / "again.json").settings);
}

TEST(SessionFile, a_volume_below_its_folder_moves_with_it_and_others_stay_where_they_are) {
    const ScratchFolder folder;
    std::filesystem::create_directories(folder.path() / "here" / "data");
    SessionFile s = some_session();
    const auto file = folder.path() / "here" / "s.json";
    const auto volume_of = [&](const std::filesystem::path& volume) {
        s.source = run::source_named(volume.string());
        write_session(file, s);
        std::filesystem::rename(folder / "here", folder / "there");
        const std::string read = name_of(read_session(folder.path() / "there" / "s.json").source);
        std::filesystem::rename(folder / "there", folder / "here");
        return read;
    };
    EXPECT_EQ(volume_of(folder.path() / "here" / "data" / "a b.nrrd"),
              folder.path() / "there" / "data" / "a b.nrrd");
    EXPECT_EQ(volume_of(folder.path() / "here" / "data" / ".." / "x.nrrd"),
              folder.path() / "there" / "x.nrrd");
    EXPECT_EQ(volume_of(folder / "outside.nrrd"), folder / "outside.nrrd");
    // A relative name counts from where the program runs.
    EXPECT_EQ(volume_of("elsewhere.nrrd"), std::filesystem::absolute("elsewhere.nrrd"));
}

TEST(SessionFile, may_be_named_without_a_folder) {
    const ScratchFolder folder;
    const auto before = std::filesystem::current_path();
    std::filesystem::current_path(folder.path());
    SessionFile s = some_session();
    s.source = run::source_named("head.nrrd");
    EXPECT_NO_THROW(write_session("s.json", s));
    std::filesystem::current_path(before);
    EXPECT_EQ(name_of(read_session(folder / "s.json").source), folder / "head.nrrd");
}

TEST(SessionFile, an_error_is_one_line_with_file_and_member) {
    const ScratchFolder folder;
    write_session(folder / "good.json", some_session());
    const Json good = Json::parse(bytes_of(folder / "good.json"));
    const auto problem = [&](const Json::json_pointer& member, const Json& value) {
        Json bad = good;
        bad[member] = value;
        put_bytes(folder / "bad.json", bad.dump());
        const std::string words =
            message_of<io::InputError>([&] { read_session(folder / "bad.json"); });
        EXPECT_TRUE(contains(words, (folder / "bad.json").string())) << words;
        EXPECT_FALSE(contains(words, "\n")) << words;
        return words;
    };
    const auto names = [&](const char* member, const Json& value, const std::string& named) {
        const std::string words = problem(Json::json_pointer(member), value);
        EXPECT_TRUE(contains(words, named)) << words << " should name " << named;
    };
    names("/version", 2, "version 2");
    names("/version", "one", "'version'");
    names("/format", "something", "no session");
    names("/volume", 7, "'volume'");
    names("/volume/volume", "", "'volume.volume'");
    names("/volume/smooth", 2, "'volume.smooth'");
    names("/isovalue", "inf", "'isovalue'");
    names("/isovalue", nullptr, "'isovalue'");
    names("/solid", "sideways", "'solid'");
    names("/field", "quartic", "'field'");
    names("/method", "magic", "exact");
    names("/device", "", "'device'");
    names("/clutch", 2, "'clutch'");
    names("/dead-man", "33", "'dead-man'");
    names("/settings/force/stiffness", -1, "stiffness");
    names("/settings/force", "strong", "'force'");
    names("/settings/penetrability/range_count", 99, "range_count");
    names("/settings/transform/rotation/0/0", 5, "rotat");
    names("/look/surface_colour", Json::array({1, 2}), "'look.surface_colour'");
    names("/look/surface_opacity", 1.5, "'look.surface_opacity'");
    names("/look/surfaces/1/opacity", -1, "'look.surfaces[1].opacity'");
    names("/look/surfaces/0/level", "high", "'look.surfaces[0].level'");
    names("/look/cut", "sphere", "'look.cut' must be nothing, plane or box");
    names("/measurements/1/kind", "area", "'measurements[1].kind' must be length or angle");
    names("/measurements/1/kind", "length", "'measurements[1].points'");
    names("/look/cut_plane/normal", Json::array({0, 0, 0}), "'look.cut_plane.normal'");
    names("/look/cut_box/high", Json::array({0.05, 1, 1}), "'look.cut_box'");
    names("/look/transfer/points/1/level", -6, "'look.transfer.points[1].level'");
    names("/look/transfer/points/0/colour/1", -1, "'look.transfer.points[0].colour'");
    names("/look/transfer/points", Json::array({Json::object()}), "'look.transfer.points'");
    names("/camera/half_height", 0, "'camera.half_height'");
    names("/camera/up", Json::array({0.5, 0.5, 0.1}), "'camera.up'");
    names("/crosshair", Json::array({1, 2, "x"}), "'crosshair'");
    names("/window_low", 1e9, "'window_low'");
    names("/follow", 1, "'follow'");
}

TEST(SessionFile, files_that_are_no_sessions_are_refused) {
    const ScratchFolder folder;
    const auto words = [&](const std::string& text) {
        put_bytes(folder / "s.json", text);
        return message_of<io::InputError>([&] { read_session(folder / "s.json"); });
    };
    for (const std::string text :
         {"", "{", "[]", "null", "{}", "NRRD0004\n", R"({"format": 1})", "\xff\xfe\x00"}) {
        EXPECT_TRUE(contains(words(text), "is no session")) << words(text);
    }
    EXPECT_TRUE(contains(words(std::string(17 << 20, ' ')), "too large"));
    EXPECT_THROW(read_session(folder / "none.json"), io::InputError);
    EXPECT_THROW(read_session(folder.path()), io::InputError);
}

TEST(SessionFile, a_damaged_file_is_read_or_refused_without_harm) {
    const ScratchFolder folder;
    write_session(folder / "s.json", some_session());
    const std::string good = bytes_of(folder / "s.json");
    support::Random random(17);
    int refused = 0, read = 0;
    const auto attempt = [&](const std::string& text) {
        put_bytes(folder / "d.json", text);
        try {
            const SessionFile session = read_session(folder / "d.json");
            // What is read can be used; a file takes its time to the disk, so not all of them.
            if (read++ < 40) write_session(folder / "e.json", session);
        } catch (const io::InputError& e) {
            EXPECT_FALSE(contains(e.what(), "\n"));
            ++refused;
        }
    };
    const int step = support::is_slow_build ? 37 : 5;
    for (std::size_t length = 0; length < good.size(); length += std::size_t(step)) {
        attempt(good.substr(0, length));
    }
    const std::string odd = "{}[],:\"-0123456789eE.truefalsn \\u\xff";
    for (int i = 0; i < support::scaled(2000); ++i) {
        std::string text = good;
        for (int n = 1 + random.below(3); n > 0; --n) {
            const auto at = static_cast<std::size_t>(random.below(static_cast<int>(text.size())));
            switch (random.below(3)) {
                case 0:
                    text[at] = odd[std::size_t(random.below(static_cast<int>(odd.size())))];
                    break;
                case 1:
                    text.erase(at, std::size_t(1 + random.below(12)));
                    break;
                default:
                    text.insert(at, text.substr(at / 2, std::size_t(random.below(12))));
            }
        }
        attempt(text);
    }
    attempt(std::string(1'000'000, '['));
    attempt(R"({"format": "palpate-session", "version": 1, "isovalue": 1e999})");
    EXPECT_GT(refused, read / 4);
    EXPECT_GT(read, 0);
}

TEST(SessionFile, invalid_values_are_refused_before_anything_is_written) {
    const ScratchFolder folder;
    put_bytes(folder / "s.json", "mine");
    const auto refused = [&](const auto& change) {
        SessionFile s = some_session();
        change(s);
        EXPECT_THROW(write_session(folder / "s.json", s), std::invalid_argument);
        EXPECT_EQ(bytes_of(folder / "s.json"), "mine");
    };
    refused([](SessionFile& s) { s.isovalue = infinity; });
    refused([](SessionFile& s) { s.source = {}; });
    refused([](SessionFile& s) { s.device.name.clear(); });
    refused([](SessionFile& s) { s.look.surface_opacity = 2; });
    refused([](SessionFile& s) { s.look.surfaces.resize(most_surfaces + 1); });
    refused([](SessionFile& s) { s.look.surfaces[0].level = infinity; });
    refused([](SessionFile& s) { s.look.cut_plane.normal = Vec3::Zero(); });
    refused([](SessionFile& s) { s.camera->half_height = std::nan(""); });
    SessionFile s = some_session();
    s.source = run::source_named("/data/\xff\xfe.nrrd");
    EXPECT_THROW(write_session(folder / "s.json", s), io::OutputError);
    EXPECT_EQ(bytes_of(folder / "s.json"), "mine");
    EXPECT_THROW(write_session(folder.path() / "no" / "s.json", some_session()), io::OutputError);
    EXPECT_THROW(write_session("/dev/full", some_session()), io::OutputError);
    EXPECT_EQ(folder.names(), std::vector<std::string>{"s.json"});
}

}  // namespace
}  // namespace palpate::viewer
