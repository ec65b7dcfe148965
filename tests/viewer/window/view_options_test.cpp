// Options of the viewer: which of them win over a session file, and which do nothing beside one.
#include <QAction>

#include "apps/options/view_options.hpp"
#include "viewer/window/window_fixture.hpp"

namespace palpate::viewer::test {
namespace {

TEST(ViewOptions, a_session_or_a_recording_is_opened_by_its_name) {
    for (const auto& [name, session, play] :
         {std::array{"a/b.json", "a/b.json", ""}, {"b.csv", "", "b.csv"}, {"c.nrrd", "", ""}}) {
        app::ViewOptions options;
        options.run.source.volume() = name;
        options.settle();
        EXPECT_EQ(options.session, session);
        EXPECT_EQ(options.play, play);
        EXPECT_EQ(options.has_volume(), std::string(name) == "c.nrrd");
    }
}

TEST(ViewOptions, without_effect_are_told_apart_from_the_settling) {
    CLI::App command;
    app::ViewOptions options;
    options.add_to(command);
    command.parse("synthetic:sphere:8x8x8 --after 2");
    testing::internal::CaptureStderr();
    options.settle();
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    testing::internal::CaptureStderr();
    options.warn();
    EXPECT_EQ(testing::internal::GetCapturedStderr(),
              "palpate: warning: --after does nothing: there is no --screenshot\n");
}

TEST(WindowSize, is_read_or_refused) {
    app::ViewOptions options;
    EXPECT_FALSE(options.window_size());
    options.size = "1280x800";
    EXPECT_EQ(options.window_size(), (std::array{1280, 800}));
    for (const char* wrong : {"1280", "1280x", "x800", "1280x800x3", "10x10", "big"}) {
        options.size = wrong;
        EXPECT_THROW((void)options.window_size(), std::invalid_argument) << wrong;
    }
}

/// What is said of options that do nothing.
std::string warning_for(const std::string& line,
                        void (app::ViewOptions::*warn)() const = &app::ViewOptions::warn) {
    CLI::App command;
    app::ViewOptions options;
    options.add_to(command);
    command.parse(line);
    options.settle();
    testing::internal::CaptureStderr();
    (options.*warn)();
    return testing::internal::GetCapturedStderr();
}

TEST(ViewOptions, beside_a_session_each_one_wins_or_is_warned_of) {
    EXPECT_EQ(warning_for("s.json --record r.csv --rate 500 --step-budget 99 --playback 2 --once "
                          "--dead-man 1 --overrun 0.1 --friction 0.2 --scale 2 -q "
                          "--device mouse --window 800x600"),
              "");
    EXPECT_EQ(warning_for("s.json --labels l.nrrd -i 3 --dims 3x3x3"),
              "palpate: warning: --dims, --isovalue, --labels do nothing: the session gives the "
              "data and the settings\n");
    const std::string unless_there_are_settings =
        "s.json --tool sphere:2 --penetrability threshold --threshold 2 --facing left";
    EXPECT_EQ(warning_for(unless_there_are_settings), "");
    EXPECT_EQ(warning_for(unless_there_are_settings, &app::ViewOptions::warn_beside_settings),
              "palpate: warning: --tool, --penetrability, --threshold, --facing do nothing: the "
              "session has settings of its own\n");
}

TEST(ViewOptions, beside_a_recording_nothing_is_felt) {
    EXPECT_EQ(warning_for("--play r.csv --window 800x600 --device mouse"), "");
    EXPECT_EQ(warning_for("r.csv --record s.csv --force-limit 1 --scale 2 --rate 500"),
              "palpate: warning: --record, --force-limit, --rate, --scale do nothing: the "
              "recording gives the data and the settings\n");
    EXPECT_EQ(warning_for("synthetic:sphere --play r.csv"),
              "palpate: warning: VOLUME does nothing: the recording gives the data and the "
              "settings\n");
}

class NamedSettings : public InWindow {};

TEST_F(NamedSettings, win_over_those_of_a_session) {
    const auto open = [&](const RunRequest& request, const QString& path) {
        open_window(request);
        window_->files().open_path(path);
        wait_until([&] { return window_->live() && window_->live()->snapshot(); });
    };
    RunRequest request{setup_with("simulated:hand=hold,depth=4,seconds=3600"), {}, {}};
    open(request, "synthetic:sphere:24x24x24");
    ForceSettings force = window_->live()->settings().force;
    force.limit = 2.5;
    force.stiffness = 0.4;
    force.damping = 0.002;
    window_->content().effect().request(force);
    window_->content().effect().request(Friction{0.3, 0.2});
    wait_until(
        [&] { return window_->live()->settings().proxy.friction.static_coefficient == 0.3; });
    window_->files().save_session(scratch("day.json"));

    CLI::App command;
    app::ViewOptions options;
    options.add_to(command);
    command.parse("day.json --force-limit 0.3 -k 0.1 --friction 0.1 --magnet 2,0.4 --scale 3");
    request.named_settings = options.run.render.named();
    open(request, scratch("day.json"));
    const auto settings = [&] { return window_->live()->settings(); };
    wait_until([&] { return settings().transform.scale == 3; });
    EXPECT_EQ(settings().force.limit, 0.3);
    EXPECT_EQ(settings().force.stiffness, 0.1);
    EXPECT_EQ(settings().force.magnet.distance, 2);
    EXPECT_EQ(settings().force.damping, 0.002) << "the command line does not name it";
    EXPECT_EQ(settings().proxy.friction.dynamic_coefficient, 0.1);
}

}  // namespace
}  // namespace palpate::viewer::test
