// DICOM files with several frames: places, stacks, moments and values from their functional groups,
// and what is made of frames without them.
#include "volume_dicom_slice.hpp"

using namespace palpate;
using namespace palpate::io;
using namespace palpate::io::test;

namespace {

const char* const enhanced_mr = "1.2.840.10008.5.1.4.1.1.4.1";
const std::string axial = "1\\0\\0\\0\\1\\0", sagittal = "0\\1\\0\\0\\0\\-1";

struct TestFrame {
    std::string position = "0\\0\\0", orientation = axial;
    std::string stack = "1", type = "ORIGINAL\\PRIMARY\\M";
    int moment = 1;
    int in_stack = 0;  ///< InStackPositionNumber; 0: not given
    std::string slope = "1", intercept = "0";
    int value = 0;  ///< of its first pixel; each further one is one more
};

std::string item(const std::string& content) {
    return little(std::uint16_t{0xfffe}) + little(std::uint16_t{0xe000}) +
           little(static_cast<std::uint32_t>(content.size())) + content;
}

std::string sequence(int group, int element, const std::vector<std::string>& items) {
    std::string content;
    for (const std::string& i : items) content += item(i);
    DicomBytes bytes;
    bytes.long_value(static_cast<std::uint16_t>(group), static_cast<std::uint16_t>(element), "SQ",
                     content);
    return bytes.bytes();
}

std::string groups_of(const TestFrame& frame) {
    DicomBytes content, position, orientation, values, type;
    content.text(0x20, 0x9056, "SH", frame.stack);
    if (frame.in_stack > 0) {
        content.text(0x20, 0x9057, "UL", little(static_cast<std::uint32_t>(frame.in_stack)));
    }
    content.text(0x20, 0x9128, "UL", little(static_cast<std::uint32_t>(frame.moment)));
    std::string places;
    if (!frame.position.empty()) {
        position.text(0x20, 0x32, "DS", frame.position);
        places = sequence(0x20, 0x9113, {position.bytes()});
    }
    orientation.text(0x20, 0x37, "DS", frame.orientation);
    values.text(0x28, 0x1052, "DS", frame.intercept);
    values.text(0x28, 0x1053, "DS", frame.slope);
    values.text(0x28, 0x1054, "LO", "US");
    type.text(0x08, 0x9007, "CS", frame.type);
    return sequence(0x18, 0x9226, {type.bytes()}) + sequence(0x20, 0x9111, {content.bytes()}) +
           places + sequence(0x20, 0x9116, {orientation.bytes()}) +
           sequence(0x28, 0x9145, {values.bytes()});
}

constexpr int columns = 4, rows = 3;

/// What all frames of a file have in common; nothing where it is empty.
struct SharedPlace {
    std::string position, between;
};

/// Rows 0.5 mm apart, columns 0.78125 mm; `described` of the frames have groups of their own.
std::string enhanced_bytes(const std::vector<TestFrame>& frames, std::size_t described,
                           const SharedPlace& shared = {}) {
    TestSlice head;
    head.kind = enhanced_mr;
    DicomBytes data, measures;
    data.text(8, 0x16, "UI", head.kind, '\0');
    data.text(8, 0x18, "UI", instance_of(head), '\0');
    data.text(8, 0x60, "CS", "MR");
    data.text(0x20, 0xe, "UI", head.series, '\0');
    data.number(0x28, 2, 1);
    data.text(0x28, 4, "CS", "MONOCHROME2");
    data.text(0x28, 8, "IS", std::to_string(frames.size()));
    data.number(0x28, 0x10, rows);
    data.number(0x28, 0x11, columns);
    data.number(0x28, 0x100, 16);
    data.number(0x28, 0x101, 16);
    data.number(0x28, 0x102, 15);
    data.number(0x28, 0x103, 0);
    measures.text(0x18, 0x50, "DS", "5");
    if (!shared.between.empty()) measures.text(0x18, 0x88, "DS", shared.between);
    measures.text(0x28, 0x30, "DS", "0.5\\0.78125");
    std::vector<std::string> own;
    std::string pixels;
    for (const TestFrame& frame : frames) {
        if (own.size() < described) own.push_back(groups_of(frame));
        for (int i = 0; i < rows * columns; ++i) {
            pixels += little(static_cast<std::uint16_t>(frame.value + i));
        }
    }
    std::string groups = sequence(0x28, 0x9110, {measures.bytes()});
    if (!shared.position.empty()) {
        DicomBytes position;
        position.text(0x20, 0x32, "DS", shared.position);
        groups = sequence(0x20, 0x9113, {position.bytes()}) + groups;
    }
    DicomBytes pixel_data;
    pixel_data.long_value(0x7fe0, 0x10, "OW", pixels);
    return dicom_start(head, "1.2.840.10008.1.2.1") + data.bytes() +
           sequence(0x5200, 0x9229, {groups}) + sequence(0x5200, 0x9230, own) + pixel_data.bytes();
}

class dicom_frames : public testing::Test {
  protected:
    VolumeFile read(const std::vector<TestFrame>& frames, const ReadOptions& options = {}) {
        put_bytes(file_, enhanced_bytes(frames, frames.size()));
        return read_volume(file_, options);
    }
    std::string refused(const std::vector<TestFrame>& frames, const ReadOptions& options = {}) {
        put_bytes(file_, enhanced_bytes(frames, frames.size()));
        return refusal(file_, options);
    }
    const ScratchFolder folder_;
    const std::filesystem::path file_ = folder_ / "frames.dcm";
};

TestFrame at(double z, int value) {
    TestFrame frame;
    frame.position = "-10\\20\\" + std::to_string(z);
    frame.value = value;
    return frame;
}

void expect_first_pixels(const VolumeFile& file, const std::vector<double>& expected) {
    ASSERT_EQ(file.volume.geometry().size,
              Index3(columns, rows, static_cast<int>(expected.size())));
    for (std::size_t k = 0; k < expected.size(); ++k) {
        EXPECT_EQ(file.volume.sample({0, 0, static_cast<int>(k)}), expected[k]) << k;
    }
}

}  // namespace

TEST_F(dicom_frames, lie_where_they_say_in_whatever_order_they_come) {
    const VolumeFile file = read({at(7.5, 200), at(22.5, 400), at(0, 100), at(15, 300)});
    expect_first_pixels(file, {100, 200, 300, 400});
    const Geometry& g = file.volume.geometry();
    EXPECT_EQ(g.spacing, Vec3(0.78125, 0.5, 7.5));
    EXPECT_EQ(g.origin, Vec3(-10, 20, 0));
    EXPECT_TRUE(g.direction.isIdentity(0));
    EXPECT_EQ(file.volume.sample({2, 1, 3}), 406);
    EXPECT_EQ(file.time_steps, 1);
    EXPECT_EQ(all_notes(file), "");
}

TEST_F(dicom_frames, that_are_missing_are_filled_as_missing_slices_are) {
    const VolumeFile file = read({at(0, 100), at(5, 200), at(10, 300), at(20, 500)});
    expect_first_pixels(file, {100, 200, 300, 400, 500});
    EXPECT_TRUE(contains(all_notes(file), "1 of 5 slices are missing")) << all_notes(file);
}

TEST_F(dicom_frames, of_several_stacks_are_volumes_of_their_own) {
    std::vector<TestFrame> frames{at(0, 100), at(7, 200)};
    for (const int x : {3, 6, 9}) {
        TestFrame frame = at(0, 1000 * x);
        frame.position = std::to_string(x) + "\\0\\0";
        frame.orientation = sagittal;
        frame.stack = "side";
        frames.insert(frames.begin() + x / 3, frame);
    }
    const std::string message = refused(frames);
    EXPECT_TRUE(contains(message, "has 2 DICOM series")) << message;
    const std::vector<SeriesInfo> all = choice_in(file_);
    ASSERT_EQ(all.size(), 2U);
    EXPECT_EQ(text_of(all[0]), "2 slices of 4x3  MR ''  0.78125 x 0.5 x 7 mm  stack 1  1.2.3.4");
    EXPECT_EQ(text_of(all[1]), "3 slices of 4x3  MR ''  0.78125 x 0.5 x 3 mm  stack side  1.2.3.4");
    ReadOptions options;
    options.series = "1";
    expect_first_pixels(read(frames, options), {100, 200});
    options.series = "2";
    const VolumeFile side = read(frames, options);
    // Rows run to the back, columns down: slices follow one another to the left or right.
    const Geometry& g = side.volume.geometry();
    EXPECT_EQ(g.size, Index3(columns, rows, 3));
    EXPECT_EQ(g.spacing, Vec3(0.78125, 0.5, 3));
    for (int k = 0; k < 3; ++k) {
        const Vec3 place = physical_from_index(g, Vec3(0, 0, k));
        EXPECT_EQ(side.volume.sample({0, 0, k}), 1000 * std::lround(place[0]));
    }
}

TEST_F(dicom_frames, of_one_place_are_moments_in_the_order_of_time) {
    std::vector<TestFrame> frames;
    for (const int moment : {3, 1, 2}) {
        for (const double z : {0.0, 4.0}) {
            frames.push_back(at(z, 1000 * moment + static_cast<int>(z)));
            frames.back().moment = moment;
        }
    }
    ReadOptions options;
    for (int step = 0; step < 3; ++step) {
        options.time_step = step;
        const VolumeFile file = read(frames, options);
        EXPECT_EQ(file.time_steps, 3);
        expect_first_pixels(file, {1000.0 * (step + 1), 1000.0 * (step + 1) + 4});
    }
    frames.pop_back();
    EXPECT_TRUE(contains(refused(frames), "at the same place")) << refused(frames);
}

TEST_F(dicom_frames, without_a_position_are_in_the_order_of_their_numbers_in_the_stack) {
    const auto frame = [](int in_stack, int moment) {
        TestFrame one;
        one.position = "";
        one.in_stack = in_stack;
        one.moment = moment;
        one.value = 100 * in_stack + 10 * moment;
        return one;
    };
    expect_first_pixels(read({frame(3, 1), frame(1, 1), frame(2, 1)}), {110, 210, 310});
    ReadOptions second;
    second.time_step = 1;
    const VolumeFile file = read({frame(2, 2), frame(1, 1), frame(1, 2), frame(2, 1)}, second);
    expect_first_pixels(file, {120, 220});
    EXPECT_EQ(file.time_steps, 2);
    EXPECT_TRUE(contains(refused({frame(2, 2), frame(1, 1), frame(1, 2)}), "same place"));
}

TEST_F(dicom_frames, with_one_position_for_all_lie_one_behind_the_other) {
    for (const bool numbered : {true, false}) {
        for (const bool shared : {true, false}) {
            std::vector<TestFrame> frames;
            for (const int i : {1, 0, 2, 3}) {
                frames.push_back(at(3, 100 * i));
                if (shared) frames.back().position.clear();
                if (numbered) frames.back().in_stack = i + 1;
            }
            const SharedPlace place{shared ? "-10\\20\\3" : "", "2.5"};
            put_bytes(file_, enhanced_bytes(frames, 4, place));
            const VolumeFile file = read_volume(file_);
            if (numbered) {
                expect_first_pixels(file, {0, 100, 200, 300});
            } else {
                expect_first_pixels(file, {100, 0, 200, 300});
            }
            EXPECT_EQ(file.time_steps, 1);
            EXPECT_EQ(file.volume.geometry().spacing[2], 2.5);
            EXPECT_EQ(file.volume.geometry().origin, Vec3(-10, 20, 3));
            EXPECT_FALSE(file.volume.geometry().oriented);
            EXPECT_TRUE(contains(all_notes(file), "frames all have one position"));
        }
    }
}

TEST_F(dicom_frames, of_one_position_that_differ_in_time_are_moments) {
    std::vector<TestFrame> frames;
    for (const int moment : {2, 1, 3}) {
        frames.push_back(at(3, 100 * moment));
        frames.back().moment = moment;
        frames.back().in_stack = 1;
    }
    for (const bool numbered_on : {true, false}) {
        put_bytes(file_, enhanced_bytes(frames, 3, {"", "2.5"}));
        ReadOptions last;
        last.time_step = 2;
        const VolumeFile file = read_volume(file_, last);
        EXPECT_EQ(file.time_steps, 3) << numbered_on;
        expect_first_pixels(file, {300});
        for (TestFrame& frame : frames) frame.in_stack = frame.moment;  // as some writers do
    }
}

TEST_F(dicom_frames, without_a_position_among_others_are_refused_by_number) {
    std::vector<TestFrame> frames{at(0, 1), at(5, 2), at(10, 3)};
    frames[1].position.clear();
    const std::string message = refused(frames);
    EXPECT_TRUE(one_line_about(message, file_)) << message;
    EXPECT_TRUE(contains(message, "'frames.dcm' (frame 2)")) << message;
}

TEST_F(dicom_frames, of_other_kinds_are_not_mixed) {
    std::vector<TestFrame> frames{at(0, 1), at(5, 2), at(0, 3), at(5, 4)};
    frames[2].type = frames[3].type = "ORIGINAL\\PRIMARY\\P";
    EXPECT_TRUE(contains(refused(frames), "has 2 DICOM series")) << refused(frames);
    ReadOptions options;
    options.series = "2";
    expect_first_pixels(read(frames, options), {3, 4});
}

TEST_F(dicom_frames, have_slopes_and_intercepts_of_their_own) {
    std::vector<TestFrame> frames{at(0, 100), at(5, 100), at(10, 100)};
    frames[1].slope = "2";
    frames[2].slope = "0.5";
    frames[2].intercept = "-7";
    expect_first_pixels(read(frames), {100, 200, 43});
}

TEST_F(dicom_frames, that_are_not_all_described_are_refused) {
    put_bytes(file_, enhanced_bytes({at(0, 1), at(5, 2), at(10, 3)}, 2));
    const std::string message = refusal(file_);
    EXPECT_TRUE(one_line_about(message, file_)) << message;
    EXPECT_TRUE(contains(message, "has 3 frames, and describes 2")) << message;
}

TEST_F(dicom_frames, with_places_that_make_no_sense_are_refused) {
    for (const char* position : {"1e30\\0\\0", "nan\\0\\0", "one\\0\\0"}) {
        std::vector<TestFrame> frames{at(0, 1), at(5, 2)};
        frames[1].position = position;
        EXPECT_TRUE(one_line_about(refused(frames), file_)) << refused(frames);
    }
}

TEST_F(dicom_frames, of_several_files_make_one_volume) {
    put_bytes(folder_ / "a.dcm", enhanced_bytes({at(0, 100), at(10, 300)}, 2));
    put_bytes(folder_ / "b.dcm", enhanced_bytes({at(15, 400), at(5, 200)}, 2));
    expect_first_pixels(read_volume(folder_.path()), {100, 200, 300, 400});
}

namespace {

/// The bytes of `more` put before an element of a plain file.
std::string with_elements(const TestSlice& slice, const std::string& more) {
    const std::string whole = dicom_bytes(slice);
    const std::size_t pixels =
        whole.rfind(little(std::uint16_t{0x7fe0}) + little(std::uint16_t{0x10}));
    return whole.substr(0, pixels) + more + whole.substr(pixels);
}

TestSlice plain_frames(int count) {
    TestSlice slice;
    slice.frames = count;
    slice.position = "1\\2\\3";
    return slice;
}

}  // namespace

TEST_F(dicom_frames, that_are_counted_by_time_are_a_sequence_and_no_stack) {
    DicomBytes time;
    time.text(0x18, 0x1063, "DS", "40");
    for (const bool placed : {true, false}) {
        TestSlice slice = plain_frames(6);
        if (!placed) slice.position.clear();
        // Elements are in order: the frame time stands before the images' own.
        std::string bytes = dicom_bytes(slice);
        const std::size_t images =
            bytes.find(little(std::uint16_t{0x20}) + little(std::uint16_t{0xd}));
        bytes.insert(images, time.bytes());
        put_bytes(file_, bytes);
        ReadOptions options;
        options.time_step = 4;
        const VolumeFile file = read_volume(file_, options);
        EXPECT_EQ(file.volume.geometry().size, Index3(columns, rows, 1));
        EXPECT_EQ(file.time_steps, 6);
        EXPECT_DOUBLE_EQ(file.frame_interval, 0.04);
        EXPECT_EQ(file.volume.sample({0, 0, 0}), 100 + 4 * 12);
        EXPECT_TRUE(contains(all_notes(file), "are moments of one slice")) << all_notes(file);
    }
}

TEST_F(dicom_frames, with_a_time_and_a_distance_between_them_are_a_stack) {
    DicomBytes both;
    both.text(0x18, 0x88, "DS", "3");
    both.text(0x18, 0x1063, "DS", "40");
    std::string bytes = dicom_bytes(plain_frames(4));
    bytes.insert(bytes.find(little(std::uint16_t{0x20}) + little(std::uint16_t{0xd})),
                 both.bytes());
    put_bytes(file_, bytes);
    const VolumeFile file = read_volume(file_);
    EXPECT_EQ(file.time_steps, 1);
    EXPECT_EQ(file.volume.geometry().spacing[2], 3);
    expect_first_pixels(file, {100, 112, 124, 136});
    EXPECT_TRUE(contains(all_notes(file), "a distance and a time")) << all_notes(file);
}

TEST_F(dicom_frames, of_a_dose_lie_at_their_offsets) {
    DicomBytes offsets;
    offsets.text(0x3004, 0xc, "DS", "0\\2.5\\5\\7.5");
    DicomBytes pointer;
    pointer.text(0x28, 9, "AT", little(std::uint16_t{0x3004}) + little(std::uint16_t{0xc}));
    offsets.text(0x3004, 0xe, "DS", "0.25");
    std::string bytes = with_elements(plain_frames(4), offsets.bytes());
    const std::size_t row = bytes.find(little(std::uint16_t{0x28}) + little(std::uint16_t{0x10}));
    bytes.insert(row, pointer.bytes());
    put_bytes(file_, bytes);
    const VolumeFile file = read_volume(file_);
    EXPECT_EQ(file.volume.geometry().spacing, Vec3(0.25, 0.5, 2.5));
    EXPECT_EQ(file.volume.geometry().origin, Vec3(1, 2, 3));
    expect_first_pixels(file, {25, 28, 31, 34});
    EXPECT_EQ(file.volume.sample({1, 0, 0}), 25.25);
}

TEST_F(dicom_frames, counted_by_what_makes_no_volume_are_refused) {
    DicomBytes pointer;  // energy window, detector, rotation
    pointer.text(0x28, 9, "AT",
                 little(std::uint16_t{0x54}) + little(std::uint16_t{0x10}) +
                     little(std::uint16_t{0x54}) + little(std::uint16_t{0x50}));
    std::string bytes = dicom_bytes(plain_frames(4));
    bytes.insert(bytes.find(little(std::uint16_t{0x28}) + little(std::uint16_t{0x10})),
                 pointer.bytes());
    put_bytes(file_, bytes);
    EXPECT_TRUE(contains(refusal(file_), "export a reconstructed volume")) << refusal(file_);
}

TEST(dicom, says_what_its_values_are) {
    const ScratchFolder folder;
    DicomBytes window;
    window.text(0x28, 0x1050, "DS", "40\\300");
    window.text(0x28, 0x1051, "DS", "400\\1500");
    const std::string bytes = dicom_bytes({});
    const std::size_t intercept =
        bytes.find(little(std::uint16_t{0x28}) + little(std::uint16_t{0x1052}));
    put_bytes(folder / "ct.dcm",
              bytes.substr(0, intercept) + window.bytes() + bytes.substr(intercept));
    const ValueInfo values = read_volume(folder / "ct.dcm").values;
    EXPECT_EQ(values.modality, "CT");
    EXPECT_EQ(values.units, "HU");
    ASSERT_TRUE(values.window);
    EXPECT_EQ(values.window->centre, 40);
    EXPECT_EQ(values.window->width, 400);
}
