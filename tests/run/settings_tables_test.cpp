// The tables of settings: each has every member of its struct, and the checks of numbers, the files
// and the messages follow from it.
#include <concepts>
#include <cstddef>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "io/recording/settings_json.hpp"
#include "palpate/run/brush.hpp"
#include "palpate/settings.hpp"
#include "run/run_support.hpp"

namespace palpate::run {
namespace {

/// Fails for a member that lies between those of the table. (A bool may hide in the padding.)
template <class T>
void expect_a_whole_table(const char* name) {
    const T whole{};
    const auto* start = reinterpret_cast<const std::byte*>(&whole);
    std::size_t end = 0;
    for_each_setting<T>([&](const auto& one) {
        const auto& member = whole.*one.member;
        const auto at =
            static_cast<std::size_t>(reinterpret_cast<const std::byte*>(&member) - start);
        ASSERT_GE(at, end) << name << "::" << one.name << ": not in the order of the struct";
        EXPECT_LT(at - end, alignof(decltype(member))) << name << ": before " << one.name;
        end = at + sizeof(member);
    });
    EXPECT_LT(sizeof(T) - end, alignof(T)) << name << ": at the end";
}

TEST(SettingsTables, have_every_member_of_their_structs) {
    expect_a_whole_table<Friction>("Friction");
    expect_a_whole_table<Magnet>("Magnet");
    expect_a_whole_table<Texture>("Texture");
    expect_a_whole_table<ForceSettings>("ForceSettings");
    expect_a_whole_table<DeviceLimits>("DeviceLimits");
    expect_a_whole_table<DeviceTransform>("DeviceTransform");
    expect_a_whole_table<DensityRange>("DensityRange");
    expect_a_whole_table<Needle>("Needle");
    expect_a_whole_table<Brush>("Brush");
    expect_a_whole_table<HandBrush>("HandBrush");
    expect_a_whole_table<SessionSettings>("SessionSettings");
}

std::string refusal(auto&& call) {
    try {
        call();
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return "";
}

/// Each number of `good` that is out of its range is refused by check(changed), with its title,
/// unit and range.
template <class T>
void expect_refused(const T& good, auto&& check) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    ASSERT_EQ(refusal([&] { check(good); }), "");
    int seen = 0;
    for_each_setting<T>([&](const auto& one) {
        T changed = good;
        auto& member = changed.*one.member;
        using Value = std::remove_cvref_t<decltype(member)>;
        if constexpr (std::same_as<Value, double> || std::same_as<Value, std::optional<double>>) {
            const double nan = std::numeric_limits<double>::quiet_NaN();
            for (const double wrong : {nan, -infinity, infinity, -1.0, 0.0, 2.0}) {
                if (one.range.has(wrong)) continue;
                member = wrong;
                const std::string told = refusal([&] { check(changed); });
                EXPECT_EQ(told.find(title_of(one) + " = "), 0U) << one.name << ": " << told;
                EXPECT_NE(told.find(one.range.words), std::string::npos) << told;
                ++seen;
            }
        }
    });
    EXPECT_GT(seen, 0);
}

TEST(SettingsTables, a_number_out_of_its_range_is_refused_by_whoever_takes_the_struct) {
    const Field field = linear_field(test::loaded("synthetic:sphere:12x12x12").volume);
    for (const BrushKind kind : {BrushKind::carve, BrushKind::add, BrushKind::smooth}) {
        expect_refused(brush_for(kind, field, 100, 2), [&](const Brush& brush) {
            check(edit::Stroke{brush, Vec3::Zero(), Vec3::Zero()}, field.samples());
        });
    }
    expect_refused(HandBrush{.value = 3}, [](const HandBrush& brush) { check(brush); });
    expect_refused(SessionSettings{}, [](const SessionSettings& settings) { check(settings); });
    expect_refused(Needle{}, [](const Needle& needle) {
        Layers layers;
        layers.needle = needle;
        check(layers, Solid::above);
    });
    expect_refused(DeviceTransform{}, [](const DeviceTransform& transform) {
        RendererSettings settings;
        settings.transform = transform;
        check(settings);
    });
    RendererSettings settings;
    settings.transform.translation.y() = 1e61;
    EXPECT_NE(refusal([&] { check(settings); }).find("translation [mm, physical] = 1e+61: must"),
              std::string::npos);
}

TEST(SettingsTables, recordings_keep_every_setting_of_a_brush_and_read_older_ones) {
    Brush brush{.kind = BrushKind::paint, .solid = Solid::below};
    double next = 0.125;
    for_each_number("brush", brush, [&](auto&, const auto&, double& number) {
        number = next /= 2;  // in each range
    });
    io::Bodies bodies;
    const auto made = [&](const Edit& edit) {
        const command::Samples command{nullptr, 1, std::make_shared<const Recipe>(EditOf{0, edit})};
        return io::to_json(command, bodies);
    };
    const auto brush_in = [&](const io::Json& json) {
        const auto samples = std::get<command::Samples>(io::command_from_json(json, bodies));
        return std::get<edit::Stroke>(std::get<EditOf>(*samples.recipe).edit).brush;
    };
    const io::Json written = made(edit::Stroke{brush, {1, 2, 3}, {4, 5, 6}});
    const io::Json& stroke = written.at("samples").at("edit").at("stroke");
    const Brush read = brush_in(written);
    for_each_setting<Brush>([&](const auto& one) {
        EXPECT_TRUE(stroke.contains(one.key)) << one.key;
        EXPECT_EQ(read.*one.member, brush.*one.member) << one.name;
        io::Json older = written;
        older["samples"]["edit"]["stroke"].erase(one.key);
        EXPECT_EQ(brush_in(older).*one.member, Brush{}.*one.member) << one.name;
    });
    for (const char* needed : {"from", "to"}) {
        io::Json less = written;
        less["samples"]["edit"]["stroke"].erase(needed);
        EXPECT_EQ(refusal([&] { brush_in(less); }), std::string("'") + needed + "' is missing");
    }
}

}  // namespace
}  // namespace palpate::run
