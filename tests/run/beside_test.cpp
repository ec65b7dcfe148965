// Overlays and label volumes whose files do not say how they lie, beside a volume for which it was
// given.
#include "palpate/run/beside.hpp"

#include <gtest/gtest.h>

#include "palpate/run/labels.hpp"
#include "run/run_support.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::run {
namespace {

/// A cube of 8 samples along each side, in which label 3 is where x is small and y is large.
void put_cube(const std::filesystem::path& path, const std::string& fields) {
    std::string text =
        "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 8 8 8\nencoding: raw\n" + fields + "\n";
    for (int i = 0; i < 8 * 8 * 8; ++i) text += i % 8 < 3 && i / 8 % 8 > 4 ? '\3' : '\0';
    support::put_bytes(path, text);
}

const std::string in_body =
    "space: left-posterior-superior\nspace directions: (1,0,0) (0,1,0) (0,0,2)\n"
    "space origin: (0,0,0)\n";

bool same_place(const Geometry& a, const Geometry& b) {
    return a == b && a.oriented == b.oriented && a.measured == b.measured;
}

class Beside : public testing::Test {
  protected:
    std::string file(const char* name) { return (folder.path() / name).string(); }
    /// With what a user gives by options or in the window's dialog.
    LoadedVolume volume_with(const io::GivenGrid& given) {
        put_cube(file("a.nrrd"), "");
        Source source = source_named(file("a.nrrd"));
        auto& from = std::get<FileSource>(source.from);
        from.orientation = given.orientation;
        from.spacing = given.spacing;
        return load(source);
    }
    LoadedVolume labels_with(const std::string& fields) {
        put_cube(file("l.nrrd"), fields);
        return load(source_named(file("l.nrrd")));
    }

    support::ScratchFolder folder;
    const io::GivenGrid given{Vec3(1, 1, 3), "RIP"};
};

TEST_F(Beside, files_without_orientation_and_spacing_get_what_was_given_for_the_volume) {
    const LoadedVolume volume = volume_with(given);
    const Geometry& grid = volume.volume.geometry();
    ASSERT_EQ(io::orientation_of(grid), "RIP");
    (void)labels_with("");
    const LoadedVolume labels = load_beside(source_named(file("l.nrrd")), volume);
    EXPECT_TRUE(same_place(labels.volume.geometry(), grid));
    EXPECT_EQ(labels.volume.sample(Index3(1, 6, 2)), 3);
    EXPECT_EQ(warning_beside("l.nrrd", labels.volume.geometry(), volume), "");
}

TEST_F(Beside, files_keep_what_they_say_themselves) {
    const LoadedVolume volume = volume_with(given);
    const Geometry own = labels_with(in_body).volume.geometry();
    EXPECT_TRUE(same_place(grid_beside(own, volume), own));
    const Geometry measured = labels_with("spacings: 1 1 2\n").volume.geometry();
    EXPECT_EQ(grid_beside(measured, volume).spacing, Vec3(1, 1, 2));
    EXPECT_EQ(io::orientation_of(grid_beside(measured, volume)), "RIP");
}

TEST_F(Beside, a_given_spacing_is_not_that_of_a_grid_of_another_size) {
    const LoadedVolume volume = volume_with(given);
    Geometry coarse = labels_with("").volume.geometry();
    coarse.size = Index3(4, 4, 4);
    const Geometry placed = grid_beside(coarse, volume);
    EXPECT_EQ(placed.spacing, Vec3::Ones());
    EXPECT_TRUE(placed.oriented);
    EXPECT_NE(warning_beside("l.nrrd", placed, volume).find("l.nrrd does not give its spacing"),
              std::string::npos);
}

TEST_F(Beside, a_warning_names_the_file_that_lacks_what_the_other_has) {
    const LoadedVolume plain = volume_with({});
    const Geometry bare = labels_with("").volume.geometry();
    EXPECT_EQ(warning_beside("l.nrrd", bare, plain), "") << "both lie as they come";
    const Geometry oriented = labels_with(in_body).volume.geometry();
    EXPECT_TRUE(
        warning_beside("l.nrrd", oriented, plain).starts_with(file("a.nrrd") + " does not give"));
    put_cube(file("b.nrrd"), in_body);
    const LoadedVolume in_space = load(source_named(file("b.nrrd")));
    EXPECT_TRUE(warning_beside("l.nrrd", bare, in_space)
                    .starts_with("l.nrrd does not give its orientation"));
    io::LayersFile layers = layers_by_label(labels_with(""));
    EXPECT_TRUE(layers_warning(layers, in_space).starts_with(file("l.nrrd")));
    EXPECT_EQ(warning_beside("l.nrrd", oriented, load(source_named("synthetic:sphere:8x8x8"))), "")
        << "what is made up has no sides";
}

TEST_F(Beside, a_run_places_labels_that_it_begins_with_and_that_are_sent) {
    const LoadedVolume volume = volume_with(given);
    const io::LayersFile unplaced = layers_by_label(labels_with(""));
    ASSERT_FALSE(unplaced.layers.labels->geometry().oriented);
    run::Setup setup = test::with_device("simulated:hand=hold");
    setup.render.layers = unplaced;
    run::Run live(test::stepped_data(volume), setup);
    live.start();
    const auto felt = [&] { return live.settings().layers->labels; };
    EXPECT_TRUE(same_place(felt()->geometry(), volume.volume.geometry()));
    live.send(command::UseLayers{nullptr});
    live.send(command::UseLayers{std::make_shared<const Layers>(unplaced.layers)});
    EXPECT_TRUE(same_place(felt()->geometry(), volume.volume.geometry()));
    const auto before = felt();
    live.send(command::UseLayers{live.settings().layers});
    EXPECT_EQ(felt(), before) << "shared, as they lie there already";
}

TEST_F(Beside, recorded_labels_are_read_again_to_the_same_place) {
    const LoadedVolume volume = volume_with(given);
    Layers recorded = layers_by_label(labels_with("")).layers;
    recorded.labels.reset();
    const auto layers =
        with_labels(std::make_shared<const Layers>(recorded), file("r.csv"), volume);
    EXPECT_TRUE(same_place(layers->labels->geometry(), volume.volume.geometry()));
}

}  // namespace
}  // namespace palpate::run
