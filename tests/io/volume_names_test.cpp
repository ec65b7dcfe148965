// Folders of TIFF slices: their order by the numbers in their names, and links that lead nowhere.
#include <string>
#include <vector>

#include "volume_tiff_bytes.hpp"

namespace palpate::io::test {
namespace {

using Names = std::vector<std::string>;

/// A slice of each name, whose samples begin with its place in the list.
void put_slices(const ScratchFolder& folder, const Names& names) {
    for (std::size_t i = 0; i < names.size(); ++i) {
        const int number = static_cast<int>(i);
        put_bytes(folder / (names[i] + ".tif"), tiff_bytes({counting_page(number)}));
    }
}

/// The places in the list in the order in which the slices were taken: 0, 1, 2, ... if it is right.
std::vector<int> order_of(const Names& names) {
    const ScratchFolder folder;
    put_slices(folder, names);
    const VolumeFile file = read_volume(folder.path());
    std::vector<int> order;
    for (int z = 0; z < file.volume.geometry().size[2]; ++z) {
        order.push_back(static_cast<int>(file.volume.sample({0, 0, z})));
    }
    return order;
}

TEST(slice_names, the_number_of_the_slice_counts_wherever_it_stands) {
    const Names each[] = {
        {"batch2_z001", "batch2_z002", "batch1_z003", "batch1_z004"},
        {"scan_120005_z001", "scan_120004_z002", "scan_120003_z003", "scan_120002_z004"},
        {"z001_120005", "z002_120004", "z003_120003"},
        {"id734_z000", "id12_z001", "id99_z002"},
        {"acq7_slice1", "acq3_slice2", "acq5_slice3"},
        {"7_section1", "5_section2", "6_section3"},
        {"L_001", "R_002", "L_003", "R_004"},
        {"scanB_0001", "scanA_0002", "scanB_0003"},
        {"C_9", "B_10", "A_11"},
        {"IMG1", "img2", "IMG3"},
        {"p2_s001", "p2_s002", "p1_s003", "p1_s004"},
        {"T5_Z0", "T4_Z1", "T3_Z2"},
        {"w2_s1", "w1_s2"}};
    for (const Names& names : each) {
        std::vector<int> expected;
        for (std::size_t i = 0; i < names.size(); ++i) expected.push_back(static_cast<int>(i));
        EXPECT_EQ(order_of(names), expected) << names[0];
    }
}

TEST(slice_names, a_hyphen_is_a_sign_if_other_names_lack_it) {
    EXPECT_EQ(order_of({"s9_z-2.5", "s8_z-1.0", "s7_z0.0", "s6_z1.5"}),
              (std::vector<int>{0, 1, 2, 3}));
    EXPECT_EQ(order_of({"z-10", "z-9", "z-8", "z-7"}), (std::vector<int>{3, 2, 1, 0}));
}

TEST(slice_names, numbers_that_give_several_orders_are_refused) {
    const Names each[] = {{"acq7_1", "acq3_2", "acq5_3"},
                          {"slice1_z3", "slice2_z2", "slice3_z1"},
                          {"120003_001", "120002_002", "120001_003"}};
    for (const Names& names : each) {
        const ScratchFolder folder;
        put_slices(folder, names);
        const std::string message = refusal(folder.path());
        EXPECT_TRUE(contains(message, "which of them counts slices is not certain")) << message;
        EXPECT_TRUE(one_line_about(message, folder.path())) << message;
    }
}

TEST(slice_names, slices_that_share_their_marked_number_are_no_stack) {
    const ScratchFolder folder;
    put_slices(folder, {"001_z1", "002_z2", "003_z1", "004_z2"});
    EXPECT_TRUE(contains(refusal(folder.path()), "count 2")) << refusal(folder.path());
}

TEST(slice_names, a_missing_number_counts_where_it_is_marked) {
    const ScratchFolder folder;
    put_slices(folder, {"run1_z001", "run2_z002", "run3_z004"});
    EXPECT_TRUE(contains(refusal(folder.path()), "1 is missing")) << refusal(folder.path());
}

TEST(slice_links, a_slice_that_is_a_link_to_nowhere_or_to_itself_is_named) {
    for (const char* target : {"gone.tif", "s3.tif"}) {
        const ScratchFolder folder;
        put_slices(folder, {"s0", "s1", "s2"});
        std::filesystem::create_symlink(target, folder / "s3.tif");
        const std::string message = refusal(folder.path());
        EXPECT_TRUE(contains(message, "'s3.tif' is a link to a file that is not there")) << message;
        EXPECT_TRUE(one_line_about(message, folder.path())) << message;
        for (int i = 0; i < 3; ++i) {
            std::filesystem::remove(folder / ("s" + std::to_string(i) + ".tif"));
        }
        EXPECT_TRUE(
            contains(refusal(folder.path()), "'s3.tif' is a link to a file that is not there"));
    }
}

TEST(slice_links, other_links_that_lead_nowhere_or_to_themselves_are_passed_over) {
    const ScratchFolder folder;
    put_slices(folder, {"s0", "s1", "s2"});
    std::filesystem::create_symlink("loop", folder / "loop");
    std::filesystem::create_symlink("gone", folder / "notes.txt");
    std::filesystem::create_symlink("gone", folder / ".s3.tif");
    EXPECT_EQ(read_volume(folder.path()).volume.geometry().size[2], 3);
}

}  // namespace
}  // namespace palpate::io::test
