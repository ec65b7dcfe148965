// How the command line opens the viewer. The viewer itself is tested in tests/viewer.
#include <fstream>

#include "apps/program.hpp"

namespace palpate::app::test {
namespace {

/// A program in the viewer's place that tells how it was called.
class WithViewer : public testing::Test {
  protected:
    void SetUp() override {
        const auto stand_in = folder_.path() / "viewer.sh";
        std::ofstream(stand_in) << "#!/bin/sh\necho viewer \"$@\"\nexit 7\n";
        std::filesystem::permissions(stand_in, std::filesystem::perms::owner_all);
        ::setenv("PALPATE_VIEWER", stand_in.c_str(), 1);
        ::setenv("DISPLAY", ":99", 1);
    }
    void TearDown() override {
        ::unsetenv("PALPATE_VIEWER");
        ::unsetenv("DISPLAY");
    }
    const ScratchFolder folder_;
};

TEST_F(WithViewer, view_becomes_the_viewer_with_the_same_words_and_its_exit_status) {
    const Outcome seen = palpate(folder_, "view synthetic:sphere:8x8x8 --device mouse -i 3");
    EXPECT_EQ(seen.status, 7);
    EXPECT_EQ(seen.out, "viewer synthetic:sphere:8x8x8 --device mouse -i 3\n");
}

TEST_F(WithViewer, warnings_of_options_without_effect_are_left_to_it) {
    const Outcome seen = palpate(folder_, "view synthetic:sphere:8x8x8 --after 2");
    EXPECT_EQ(seen.status, 7);
    EXPECT_EQ(seen.err, "");
}

TEST_F(WithViewer, touch_opens_it_where_there_is_a_display) {
    const Outcome seen = palpate(folder_, "touch synthetic:sphere:8x8x8");
    EXPECT_EQ(seen.status, 7);
    EXPECT_EQ(seen.out, "viewer synthetic:sphere:8x8x8\n");
}

TEST_F(WithViewer, touch_opens_it_for_two_hands_but_not_for_more) {
    const std::string two = "touch synthetic:sphere:8x8x8 --device mouse --device simulated";
    EXPECT_EQ(palpate(folder_, two).status, 7);
    expect_failure(palpate(folder_, two + " --device simulated:seed=2"), 4, "no window");
}

TEST_F(WithViewer, touch_for_scripts_and_record_stay_without_a_window) {
    for (const std::string words :
         {"touch synthetic:sphere:8x8x8 --seconds 0.05",
          "touch synthetic:sphere:8x8x8 --headless "
          "--seconds 0.05",
          "touch synthetic:sphere:8x8x8 --json --seconds 0.05",
          "record synthetic:sphere:8x8x8 --seconds 0.05 -o session.csv"}) {
        const Outcome seen = palpate(folder_, words);
        EXPECT_EQ(seen.status, 0) << words << "\n" << seen.err;
        EXPECT_FALSE(contains(seen.out, "viewer")) << words;
    }
}

TEST_F(WithViewer, wrong_words_are_told_before_a_window_opens) {
    expect_failure(palpate(folder_, "view --sesion a.json"), 2, "--sesion");
    expect_failure(palpate(folder_, "view synthetic:sphere:8x8x8 --session a.json"), 2,
                   "one of them");
    expect_failure(palpate(folder_, "view --screenshot a.png"), 2, "needs a VOLUME");
}

TEST(View, without_a_display_it_says_so_and_what_to_do) {
    const ScratchFolder folder;
    ::setenv("PALPATE_VIEWER", "/bin/true", 1);
    ::unsetenv("DISPLAY");  // as in a terminal far away
    expect_failure(palpate(folder, "view synthetic:sphere:8x8x8"), 2, "display");
    ::unsetenv("PALPATE_VIEWER");
}

TEST(View, mouse_is_no_device_without_a_window) {
    const ScratchFolder folder;
    expect_failure(palpate(folder, "touch synthetic:sphere:8x8x8 --headless --device mouse"), 4,
                   "no window");
}

}  // namespace
}  // namespace palpate::app::test
