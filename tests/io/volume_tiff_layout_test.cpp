// What TIFF files say of their planes: OME-XML in every order, ImageJ's units and calibrations,
// tifffile's shapes.
#include <algorithm>
#include <array>

#include "volume_tiff_bytes.hpp"

namespace palpate::io::test {
namespace {

/// Pages whose first sample is their number; the first one has the description.
void put_pages(const ScratchFolder& folder, int count, const std::string& description) {
    std::vector<TestPage> pages;
    for (int i = 0; i < count; ++i) pages.push_back(counting_page(4 * i));
    pages[0].description = description;
    pages[0].resolution[0] = 2;
    pages[0].resolution[1] = 1;
    put_bytes(folder / "a.tif", tiff_bytes(pages));
}

int page_of(const VolumeFile& file, int z) {
    return static_cast<int>(file.volume.sample({0, 0, z})) / 4;
}

std::string ome(const std::string& attributes, const std::string& inside = "") {
    return "<?xml version=\"1.0\"?><OME><Image><Pixels Type=\"uint8\" SizeX=\"4\" SizeY=\"3\" " +
           attributes + ">" + inside + "</Pixels></Image></OME>";
}

const char* const lengths = "PhysicalSizeX=\"0.1\" PhysicalSizeY=\"0.2\" PhysicalSizeZ=\"0.3\" ";

TEST(tiff, planes_of_an_ome_tiff_in_strips_are_found_in_every_order) {
    const ScratchFolder folder;
    const int sizes[3] = {3, 2, 4};  // z, c, t
    std::string letters = "CTZ";
    int orders = 0;
    do {
        put_pages(folder, 24,
                  ome(std::string("SizeZ=\"3\" SizeC=\"2\" SizeT=\"4\" ") + lengths +
                      "DimensionOrder=\"XY" + letters + "\""));
        for (int t = 0; t < 4; ++t) {
            ReadOptions options;
            options.time_step = t;
            const VolumeFile file = read_volume(folder / "a.tif", options);
            ASSERT_EQ(file.volume.geometry().size, Index3(4, 3, 3));
            EXPECT_TRUE(file.volume.geometry().spacing.isApprox(Vec3(1e-4, 2e-4, 3e-4)));
            EXPECT_EQ(file.time_steps, 4);
            EXPECT_TRUE(contains(all_notes(file), "channel 0 (channel 0) of 2 was taken"));
            for (int z = 0; z < 3; ++z) {
                int page = 0, stride = 1;
                for (const char letter : letters) {
                    const auto axis = std::string("ZCT").find(letter);
                    page += stride * std::array{z, 0, t}[axis];
                    stride *= sizes[axis];
                }
                EXPECT_EQ(page_of(file, z), page) << letters << " " << z << " " << t;
            }
        }
        ++orders;
    } while (std::next_permutation(letters.begin(), letters.end()));
    EXPECT_EQ(orders, 6);
}

TEST(tiff, planes_of_an_ome_tiff_lie_where_its_tiff_data_say) {
    const ScratchFolder folder;
    std::mt19937 random(7);
    for (int round = 0; round < 5; ++round) {
        std::vector<int> pages = {0, 1, 2, 3, 4};
        std::shuffle(pages.begin(), pages.end(), random);
        std::string data;
        for (std::size_t z = 0; z < 5; ++z) {
            data += "<TiffData FirstZ=\"" + std::to_string(z) + "\" IFD=\"" +
                    std::to_string(pages[z]) + "\" PlaneCount=\"1\"/>";
        }
        put_pages(folder, 5,
                  ome(std::string(lengths) + "SizeZ=\"5\" DimensionOrder=\"XYZCT\"", data));
        const VolumeFile file = read_volume(folder / "a.tif");
        for (int z = 0; z < 5; ++z) EXPECT_EQ(page_of(file, z), pages[static_cast<std::size_t>(z)]);
    }
    put_pages(folder, 5, ome(std::string(lengths) + "SizeZ=\"3\" DimensionOrder=\"XYZCT\""));
    EXPECT_TRUE(contains(all_notes(read_volume(folder / "a.tif")), "3 of its 5 pages"));
    put_pages(folder, 2, ome("SizeZ=\"3\" DimensionOrder=\"XYZCT\""));
    EXPECT_TRUE(contains(refusal(folder / "a.tif"), "tells of page 2, but it has 2"));
    put_pages(folder, 3, ome("SizeZ=\"3\" DimensionOrder=\"XYZCT\""));
    EXPECT_TRUE(contains(all_notes(read_volume(folder / "a.tif")), "1 mm was taken"));
}

TEST(tiff, the_ratio_of_spacings_whose_unit_is_no_length_is_kept) {
    const ScratchFolder folder;
    const auto expect = [&](const std::string& description, const std::string& note) {
        put_pages(folder, 2, description);
        const VolumeFile file = read_volume(folder / "a.tif");
        EXPECT_EQ(file.volume.geometry().spacing, Vec3(1, 1, 6)) << description;
        EXPECT_FALSE(file.volume.geometry().measured);
        EXPECT_TRUE(contains(all_notes(file), note)) << all_notes(file);
    };
    const std::string head = "ImageJ=1.53t\nimages=2\nslices=2\nspacing=3\n";
    const std::string along_x = "1 mm was taken along x, and along the other axes in proportion";
    expect(head + "unit=pixel\n", "has the unit 'pixel', which is no length: " + along_x);
    expect(head, "gives no unit of length: " + along_x);
    std::string size;
    for (const std::string axis : {"X", "Y", "Z"}) {
        size += " PhysicalSize" + axis + "=\"" + (axis == "Z" ? "3" : "0.5") + "\" PhysicalSize" +
                axis + "Unit=\"pixel\"";
    }
    expect(ome(size + " SizeZ=\"2\" DimensionOrder=\"XYZCT\""), "its OME-XML has the unit 'pixel'");
}

TEST(tiff, planes_of_image_j_may_lie_before_the_directory_of_their_page) {
    const ScratchFolder folder;
    TestPage page = counting_page(0);
    page.samples += counting_page(12).samples + counting_page(24).samples;
    page.description = "ImageJ=1.53t\nimages=3\nslices=3\nunit=mm\n";
    std::string bytes = tiff_bytes({page});
    const std::string entry =
        little<std::uint16_t>(279) + little<std::uint16_t>(4) + little<std::uint32_t>(1);
    bytes.replace(bytes.find(entry) + entry.size(), 4, little<std::uint32_t>(12));
    put_bytes(folder / "a.tif", bytes);
    const VolumeFile file = read_volume(folder / "a.tif");
    ASSERT_EQ(file.volume.geometry().size, Index3(4, 3, 3));
    for (int z = 0; z < 3; ++z) EXPECT_EQ(file.volume.sample({3, 2, z}), 12 * z + 11);
}

/// The first samples of the slices of a time step of ScanImage, whose page P has P; and the steps.
std::pair<std::vector<int>, int> read_scan_image(int pages, const std::string& lines, int step) {
    const ScratchFolder folder;
    put_pages(folder, pages, "SI.hChannels.channelSave = 1\n" + lines);
    ReadOptions options;
    options.time_step = step;
    const VolumeFile file = read_volume(folder / "a.tif", options);
    std::vector<int> found;
    for (int z = 0; z < file.volume.geometry().size[2]; ++z) found.push_back(page_of(file, z));
    return {found, file.time_steps};
}

TEST(tiff, frames_of_scan_image_that_are_no_slices_are_left_out) {
    const auto lines = [](const std::string& slices, const std::string& more) {
        return "SI.hStackManager.numSlices = " + slices + "\n" + more;
    };
    using Read = std::pair<std::vector<int>, int>;
    const std::string flyback =
        "SI.hFastZ.enable = true\nSI.hStackManager.numVolumes = 3\n"
        "SI.hStackManager.numFramesPerVolume = 3\n"
        "SI.hStackManager.numFramesPerVolumeWithFlyback = 4\n";
    EXPECT_EQ(read_scan_image(12, lines("3", flyback), 1), Read({4, 5, 6}, 3));
    EXPECT_EQ(read_scan_image(9, lines("3", flyback), 1), Read({3, 4, 5}, 3));
    const std::string two =
        "SI.hStackManager.framesPerSlice = 2\nSI.hStackManager.numVolumes = 2\n";
    EXPECT_EQ(read_scan_image(12, lines("3", two), 0), Read({0, 2, 4}, 4));
    EXPECT_EQ(read_scan_image(12, lines("3", two), 3), Read({7, 9, 11}, 4));
    EXPECT_EQ(read_scan_image(4, lines("3", two), 1), Read({1, 3}, 2));
    const std::string mean =
        "SI.hStackManager.framesPerSlice = 4\nSI.hScan2D.logAverageFactor = 4\n";
    EXPECT_EQ(read_scan_image(4, lines("4", mean), 0), Read({0, 1, 2, 3}, 1));
}

TEST(tiff, ome_xml_that_is_cut_off_is_refused_and_that_of_2007_read) {
    const ScratchFolder folder;
    const std::string sizes = std::string(lengths) + "SizeZ=\"3\" DimensionOrder=\"XYZCT\"";
    const std::string whole = ome(sizes, "<TiffData/>");
    put_pages(folder, 3, whole.substr(0, whole.size() - 12));
    EXPECT_TRUE(contains(refusal(folder / "a.tif"), "its OME-XML is no XML"))
        << refusal(folder / "a.tif");
    put_pages(folder, 3, ome(sizes, "<TiffData IFD=\"0\" NumPlanes=\"3\"/>"));
    EXPECT_EQ(read_volume(folder / "a.tif").volume.geometry().size[2], 3);
}

TEST(tiff, pages_in_a_circle_are_noted) {
    const ScratchFolder folder;
    std::string bytes = tiff_bytes({counting_page(0), counting_page(4), counting_page(8)});
    // The last four bytes say where the next page lies: that of the first one.
    bytes.replace(bytes.size() - 4, 4, bytes.substr(4, 4));
    put_bytes(folder / "a.tif", bytes);
    const VolumeFile file = read_volume(folder / "a.tif");
    EXPECT_EQ(file.volume.geometry().size[2], 3);
    EXPECT_TRUE(contains(all_notes(file), "lead in a circle")) << all_notes(file);
}

TEST(tiff, more_pages_than_image_j_tells_of_are_noted) {
    const ScratchFolder folder;
    for (const int told : {2, 3, 5}) {
        put_pages(folder, 5, "ImageJ=1.53t\nimages=" + std::to_string(told) + "\nunit=mm\n");
        const VolumeFile file = read_volume(folder / "a.tif");
        EXPECT_EQ(file.volume.geometry().size[2], 5);
        EXPECT_EQ(contains(all_notes(file), "of its 5 pages: all of them were taken"), told < 5)
            << all_notes(file);
    }
}

TEST(tiff, parts_that_are_not_stored_are_zeros) {
    const ScratchFolder folder;
    std::string bytes = tiff_bytes({counting_page(7), counting_page(20)});
    const auto entry = [](std::uint16_t tag) {
        return little(tag) + little<std::uint16_t>(4) + little<std::uint32_t>(1);
    };
    for (const std::uint16_t tag : {std::uint16_t{273}, std::uint16_t{279}}) {
        const std::size_t at = bytes.rfind(entry(tag)) + entry(tag).size();
        bytes.replace(at, 4, little<std::uint32_t>(0));
    }
    put_bytes(folder / "a.tif", bytes);
    const VolumeFile file = read_volume(folder / "a.tif");
    EXPECT_EQ(file.volume.sample({3, 2, 0}), 18);
    EXPECT_EQ(file.volume.sample({0, 0, 1}), 0);
    EXPECT_EQ(file.volume.sample({3, 2, 1}), 0);
    EXPECT_TRUE(contains(all_notes(file), "are not stored")) << all_notes(file);
}

TEST(tiff, every_axis_may_have_a_unit_of_its_own_in_image_j) {
    const ScratchFolder folder;
    struct Unit {
        const char* name;
        double mm;
    };
    const Unit units[] = {{"um", 1e-3}, {"mm", 1}, {"cm", 10}, {"", 0}};
    for (const Unit& y : units) {
        for (const Unit& z : units) {
            std::string text = "ImageJ=1.53t\nimages=2\nslices=2\nunit=um\nspacing=3\n";
            if (y.mm > 0) text += std::string("yunit=") + y.name + "\n";
            if (z.mm > 0) text += std::string("zunit=") + z.name + "\n";
            put_pages(folder, 2, text);
            const Vec3 mm(1e-3, y.mm > 0 ? y.mm : 1e-3, z.mm > 0 ? z.mm : 1e-3);
            const Vec3 spacing = read_volume(folder / "a.tif").volume.geometry().spacing;
            EXPECT_TRUE(spacing.isApprox(mm.cwiseProduct(Vec3(0.5, 0.5, 3)))) << text;
        }
    }
    put_pages(folder, 2, "ImageJ=1.53t\nimages=2\nslices=2\nunit=mm\nzunit=row\nspacing=3\n");
    EXPECT_TRUE(contains(all_notes(read_volume(folder / "a.tif")), "1 mm was taken"));
}

TEST(tiff, an_axis_that_image_j2_does_not_know_holds_the_slices_if_no_other_does) {
    const ScratchFolder folder;
    const auto put = [&](const std::string& axes, const std::string& sizes) {
        put_pages(folder, 6,
                  "SCIFIO=0.46.0\naxes=" + axes + "\nlengths=" + sizes +
                      "\nscales=0.5,0.5,3.0,1.0\nunits=mm,mm,mm,null\nimages=6\n");
    };
    put("X,Y,Unknown", "4,3,6");
    const VolumeFile file = read_volume(folder / "a.tif");
    EXPECT_EQ(file.volume.geometry().size, Index3(4, 3, 6));
    EXPECT_EQ(file.volume.geometry().spacing, Vec3(0.5, 0.5, 3));
    EXPECT_TRUE(contains(all_notes(file), "taken as slices"));
    put("X,Y,Z,Unknown", "4,3,3,2");
    EXPECT_TRUE(contains(refusal(folder / "a.tif"), "2 channels"));
    put("X,Y,Unknown,Unknown", "4,3,3,2");
    EXPECT_TRUE(contains(refusal(folder / "a.tif"), "2 channels"));
}

TEST(tiff, calibrations_of_image_j_give_the_values_that_it_shows) {
    const ScratchFolder folder;
    const auto read = [&](int bits, const std::string& samples, const std::string& calibration) {
        TestPage page;
        page.width = 2;
        page.height = 1;
        page.bits = bits;
        page.samples = samples;
        page.description = "ImageJ=1.53t\nunit=mm\nslices=1\nspacing=2\n" + calibration;
        put_bytes(folder / "a.tif", tiff_bytes({page}));
        return read_volume(folder / "a.tif");
    };
    const std::string wide = little<std::uint16_t>(31768) + little<std::uint16_t>(65535);
    const VolumeFile is_signed = read(16, wide, "cf=0\nc0=-32768.0\nc1=1.0\nvunit=gray value\n");
    EXPECT_EQ(is_signed.volume.type(), SampleType::int16);
    EXPECT_EQ(is_signed.volume.minimum(), -1000);
    EXPECT_EQ(is_signed.volume.maximum(), 32767);
    EXPECT_TRUE(contains(all_notes(is_signed), "intercept (-32768)"));
    const VolumeFile scaled = read(8, "\x01\xff", "cf=0\nc0=-100.0\nc1=2.0\n");
    EXPECT_EQ(scaled.volume.type(), SampleType::float32);
    EXPECT_EQ(scaled.volume.minimum(), -98);
    EXPECT_EQ(scaled.volume.maximum(), 410);
    EXPECT_EQ(read(16, wide, "cf=0\nc0=-1000\nc1=1\n").volume.minimum(), 30768);
    const VolumeFile none = read(16, wide, "cf=20\n");
    EXPECT_EQ(none.volume.type(), SampleType::uint16);
    EXPECT_FALSE(contains(all_notes(none), "calibration"));
    const VolumeFile curved = read(16, wide, "cf=3\nc0=1\nc1=2\nc2=3\n");
    EXPECT_EQ(curved.volume.maximum(), 65535);
    EXPECT_TRUE(contains(all_notes(curved), "calibration"));
}

TEST(tiff, slices_within_a_page_are_refused_and_never_one_slice) {
    const ScratchFolder folder;
    TestPage page = counting_page(0);
    page.depth = 16;
    put_bytes(folder / "a.tif", tiff_bytes({page}));
    EXPECT_TRUE(contains(refusal(folder / "a.tif"), "ImageDepth"));
    page.depth = 1;
    page.description = "{\"shape\": [5, 3, 4], \"truncated\": true}";
    put_bytes(folder / "a.tif", tiff_bytes({page}));
    EXPECT_TRUE(contains(refusal(folder / "a.tif"), "shape 5x3x4, but it has 1 pages"));
    put_pages(folder, 6, "{\"shape\": [2, 3, 3, 4]}");
    EXPECT_TRUE(contains(all_notes(read_volume(folder / "a.tif")), "taken as slices"));
    put_pages(folder, 5, "{\"shape\": [5, 3, 4]}");
    EXPECT_EQ(read_volume(folder / "a.tif").volume.geometry().size[2], 5);
}

/// Pages of tifffile: for each series its shape and how many pages it has.
void put_series(const ScratchFolder& folder, const std::vector<std::pair<std::string, int>>& all) {
    std::vector<TestPage> pages;
    for (const auto& [shape, count] : all) {
        for (int i = 0; i < count; ++i) {
            pages.push_back(counting_page(4 * static_cast<int>(pages.size())));
            if (i == 0) pages.back().description = "{\"shape\": [" + shape + "]}";
        }
    }
    put_bytes(folder / "a.tif", tiff_bytes(pages));
}

TEST(tiff, the_first_of_several_series_of_tifffile_is_taken_with_a_note) {
    const ScratchFolder folder;
    const auto expect_slices = [&](int slices, const std::string& note) {
        for (const std::filesystem::path& path : {folder / "a.tif", folder.path()}) {
            const VolumeFile file = read_volume(path);
            ASSERT_EQ(file.volume.geometry().size, Index3(4, 3, slices)) << path;
            for (int z = 0; z < slices; ++z) EXPECT_EQ(page_of(file, z), z);
            EXPECT_EQ(contains(all_notes(file), "series"), !note.empty()) << all_notes(file);
            EXPECT_TRUE(contains(all_notes(file), note)) << all_notes(file);
        }
    };
    put_series(folder, {{"4, 3, 4", 4}, {"3, 3, 4", 3}});
    expect_slices(4,
                  "the first of its 2 series of images was taken, of the shape 4x3x4 (the "
                  "second one: 3x3x4)");
    put_series(folder, {{"3, 4", 1}, {"5, 3, 4", 5}});
    expect_slices(1, "of the shape 3x4 (the second one: 5x3x4)");
    put_series(folder, {{"4, 3, 4", 4}, {"3, 4", 1}, {"3, 4", 1}});
    expect_slices(4, "the first of its 3 series");
    put_series(folder, {{"3, 4", 1}, {"3, 4", 1}, {"3, 4", 1}});  // written one by one
    expect_slices(3, "");
}

}  // namespace
}  // namespace palpate::io::test
