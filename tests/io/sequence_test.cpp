// Sequences: which frames there are, when they were taken, and that each is what was promised.
#include "palpate/io/sequence.hpp"

#include <functional>

#include "io/real_volumes.hpp"
#include "io/volume_support.hpp"

namespace palpate::io::test {
namespace {

/// A frame of which every sample says which one it is.
Volume marked(int number, const Index3& size = {4, 3, 2}, const Vec3& spacing = {1, 2, 3}) {
    Geometry geometry;
    geometry.size = size;
    geometry.spacing = spacing;
    const auto count = static_cast<std::size_t>(sample_count(geometry));
    return Volume(geometry, std::vector<std::uint8_t>(count, static_cast<std::uint8_t>(number)));
}

void write_series(const ScratchFolder& folder,
                  const std::vector<std::pair<std::string, int>>& files) {
    for (const auto& [name, number] : files) write_volume(marked(number), folder / name);
}

std::vector<double> marks_of(const Sequence& sequence) {
    std::vector<double> marks;
    for (int i = 0; i < sequence.count(); ++i) {
        marks.push_back(read_frame(sequence, i).minimum());
    }
    return marks;
}

bool says(const SequenceFile& file, const std::string& part) {
    std::string text;
    for (const auto& note : file.notes) text += note + "\n";
    return contains(text, part);
}

std::string refusal_of(const std::filesystem::path& path, const SequenceOptions& options = {}) {
    return message_of<InputError>([&] { (void)open_sequence(path, options); });
}

/// A 4-D NRRD file of three frames with more header fields.
std::filesystem::path nrrd_4d(const ScratchFolder& folder, const std::string& fields) {
    std::string bytes =
        "NRRD0004\ntype: uint8\ndimension: 4\nsizes: 2 2 2 3\nencoding: raw\n"
        "kinds: domain domain domain time\n" +
        fields + "\n";
    for (int i = 0; i < 24; ++i) bytes += static_cast<char>(i);
    put_bytes(folder / "a.nrrd", bytes);
    return folder / "a.nrrd";
}

/// A 4-D NIfTI file of three frames.
std::filesystem::path nifti_4d(const ScratchFolder& folder, float step, float first, char units) {
    std::string header(352, '\0');
    const auto put = [&](std::size_t at, const std::string& bytes) {
        header.replace(at, bytes.size(), bytes);
    };
    put(0, little<std::int32_t>(348));
    const std::int16_t sizes[8] = {4, 2, 2, 2, 3, 1, 1, 1};
    for (std::size_t i = 0; i < 8; ++i) put(40 + 2 * i, little(sizes[i]));
    put(70, little<std::int16_t>(2) + little<std::int16_t>(8));
    for (std::size_t i = 0; i < 4; ++i) put(76 + 4 * i, little(1.0F));
    put(92, little(step));
    put(108, little(352.0F));
    put(123, std::string(1, units));
    put(136, little(first));
    put(252, little<std::int16_t>(1));
    put(344, std::string("n+1\0", 4));
    for (int i = 0; i < 24; ++i) header += static_cast<char>(i);
    put_bytes(folder / "a.nii", header);
    return folder / "a.nii";
}

}  // namespace

TEST(Sequence, the_turning_head_has_six_frames_3_2_seconds_apart) {
    const auto path = real_volume("fmri_headturn_4d.nrrd");
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
    const SequenceFile file = open_sequence(path);
    const Sequence& sequence = file.sequence;
    ASSERT_EQ(sequence.count(), 6);
    for (int i = 0; i < 6; ++i) EXPECT_NEAR(sequence.times[std::size_t(i)], 3.2 * i, 1e-9);
    EXPECT_NEAR(sequence.period, 6 * 3.2, 1e-9);
    EXPECT_EQ(sequence.geometry.size, Index3(64, 64, 36));
    EXPECT_EQ(sequence.type, SampleType::int16);
    EXPECT_TRUE(same_samples(file.first, read_frame(sequence, 0)));
    EXPECT_FALSE(says(file, "time step"));
    ReadOptions fifth;
    fifth.time_step = 5;
    EXPECT_TRUE(same_samples(read_volume(path, fifth).volume, read_frame(sequence, 5)));
    EXPECT_FALSE(same_samples(read_frame(sequence, 4), read_frame(sequence, 5)));
}

TEST(Sequence, the_times_of_nifti_files_are_in_the_units_that_they_name) {
    const ScratchFolder folder;
    const auto second = [&](float step, float first, char units) {
        return open_sequence(nifti_4d(folder, step, first, units)).sequence.times[1];
    };
    EXPECT_NEAR(second(2, 0, 2 | 8), 2, 1e-6);
    EXPECT_NEAR(second(40, 1000, 2 | 16), 1.04, 1e-6);
    EXPECT_NEAR(second(500000, 0, 2 | 24), 0.5, 1e-6);
    const SequenceFile none = open_sequence(nifti_4d(folder, 2.5F, 0, 2));
    EXPECT_EQ(none.sequence.times, (std::vector<double>{0, 2.5, 5}));
    EXPECT_TRUE(says(none, "seconds were taken"));
    const SequenceFile hertz = open_sequence(nifti_4d(folder, 2.5F, 0, 2 | 32));
    EXPECT_EQ(hertz.sequence.times[1], assumed_frame_interval);
    EXPECT_TRUE(says(hertz, "0.1 s was taken"));
    for (const float odd : {0.0F, -1.0F, std::numeric_limits<float>::quiet_NaN(), 1e30F}) {
        EXPECT_EQ(second(odd, 0, 2 | 8), assumed_frame_interval) << odd;
    }
}

TEST(Sequence, the_times_of_nrrd_files_are_those_of_their_time_axis) {
    const ScratchFolder folder;
    const auto times = [&](const std::string& fields) {
        return open_sequence(nrrd_4d(folder, fields)).sequence.times;
    };
    const std::string spacings = "spacings: 1 1 1 40\n";
    EXPECT_EQ(times(spacings), (std::vector<double>{0, 40, 80}));
    EXPECT_EQ(times(spacings + "units: \"mm\" \"mm\" \"mm\" \"ms\"\n"),
              (std::vector<double>{0, 0.04, 0.08}));
    EXPECT_EQ(times(spacings + "units: \"mm\" \"mm\" \"mm\" \"min\"\n")[1], 2400);
    EXPECT_EQ(times(spacings + "axis mins: nan nan nan 20\nunits: \"\" \"\" \"\" \"s\"\n"),
              (std::vector<double>{20, 60, 100}));
    EXPECT_EQ(times(spacings + "units: \"mm\" \"mm\" \"mm\" \"pm\"\n")[1], assumed_frame_interval);
    EXPECT_EQ(times("spacings: 1 1 1 nan\n")[1], assumed_frame_interval);
    put_bytes(folder / "b.nrrd",
              "NRRD0004\ntype: uint8\ndimension: 4\nsizes: 3 2 2 2\nencoding: raw\n"
              "kinds: list domain domain domain\nspace: left-posterior-superior\n"
              "space directions: none (1,0,0) (0,2,0) (0,0,3)\nspacings: 0.5 nan nan nan\n\n" +
                  std::string(24, 'a'));
    const SequenceFile first_axis = open_sequence(folder / "b.nrrd");
    EXPECT_EQ(first_axis.sequence.times, (std::vector<double>{0, 0.5, 1}));
    EXPECT_EQ(first_axis.sequence.geometry.spacing, Vec3(1, 2, 3));
}

TEST(Sequence, an_interval_of_the_callers_own_counts) {
    const ScratchFolder folder;
    SequenceOptions options;
    options.interval = 0.25;
    const auto path = nrrd_4d(folder, "spacings: 1 1 1 40\n");
    const SequenceFile file = open_sequence(path, options);
    EXPECT_EQ(file.sequence.times, (std::vector<double>{0, 0.25, 0.5}));
    EXPECT_EQ(file.sequence.period, 0.75);
    for (const double odd : {-1.0, std::numeric_limits<double>::infinity(), std::nan("")}) {
        options.interval = odd;
        EXPECT_THROW((void)open_sequence(path, options), std::invalid_argument);
    }
}

TEST(Sequence, files_of_a_series_come_by_number_not_by_name) {
    const ScratchFolder folder;
    write_series(folder, {{"heart_2.nrrd", 2},
                          {"heart_10.nrrd", 10},
                          {"heart_1.nrrd", 1},
                          {"heart_x.nrrd", 99},
                          {"heart_3.mha", 98},
                          {"heart_.nrrd", 97},
                          {"heart_3.nrrd", 3}});
    const SequenceFile file = open_sequence(folder / "heart_%d.nrrd");
    EXPECT_EQ(marks_of(file.sequence), (std::vector<double>{1, 2, 3, 10}));
    // Number 10 comes 9 intervals after number 1.
    EXPECT_EQ(file.sequence.times.back(), 9 * assumed_frame_interval);
    EXPECT_EQ(file.sequence.period, 10 * assumed_frame_interval);
    EXPECT_TRUE(says(file, "missing between 3 and 10"));
    EXPECT_TRUE(says(file, "0.1 s was taken"));
}

TEST(Sequence, digits_that_are_asked_for_are_as_printf_writes_them) {
    const ScratchFolder folder;
    write_series(folder, {{"h000.nrrd", 0},
                          {"h010.nrrd", 1},
                          {"h20.nrrd", 90},
                          {"h020.nrrd", 2},
                          {"h0030.nrrd", 91},
                          {"h1000.nrrd", 3}});
    SequenceOptions options;
    options.interval = 0.5;
    const SequenceFile file = open_sequence(folder / "h%03d.nrrd", options);
    EXPECT_EQ(marks_of(file.sequence), (std::vector<double>{0, 1, 2, 3}));
    // Numbered in tens: one interval is ten.
    EXPECT_EQ(file.sequence.times[2], 1);
    EXPECT_TRUE(says(file, "missing between 20 and 1000"));
    EXPECT_FALSE(says(file, "between 0 and 10"));
    EXPECT_TRUE(contains(refusal_of(folder / "h%d.nrrd"), "have the same number"));
}

TEST(Sequence, one_file_is_a_sequence_of_one_frame) {
    const ScratchFolder folder;
    write_series(folder, {{"a.nrrd", 7}, {"b%d.nrrd", 8}});
    for (const auto& [name, mark] : {std::pair{"a.nrrd", 7.0}, {"b%d.nrrd", 8.0}}) {
        const SequenceFile file = open_sequence(folder / name);
        EXPECT_EQ(marks_of(file.sequence), std::vector<double>{mark});
        EXPECT_EQ(file.sequence.times, std::vector<double>{0});
        EXPECT_TRUE(file.notes.empty());
    }
}

TEST(Sequence, raw_files_and_a_spacing_work_for_series_too) {
    const ScratchFolder folder;
    for (int i = 0; i < 3; ++i) {
        put_bytes(folder / ("r" + std::to_string(i)), std::string(24, static_cast<char>(i)));
    }
    SequenceOptions options;
    options.read.raw = RawLayout{{2, 3, 4}, SampleType::uint8, {1, 1, 2}, 0};
    const SequenceFile file = open_sequence(folder / "r%d", options);
    EXPECT_EQ(marks_of(file.sequence), (std::vector<double>{0, 1, 2}));
    EXPECT_EQ(file.sequence.geometry.spacing, Vec3(1, 1, 2));
    options.read.spacing = Vec3(5, 6, 7);
    EXPECT_EQ(open_sequence(folder / "r%d", options).sequence.geometry.spacing, Vec3(5, 6, 7));
}

TEST(Sequence, a_frame_on_another_grid_is_named_with_what_differs) {
    const ScratchFolder folder;
    write_volume(marked(0), folder / "a0.nrrd");
    const auto second = [&](const Volume& volume) {
        write_volume(volume, folder / "a1.nrrd");
        const SequenceFile file = open_sequence(folder / "a%d.nrrd");
        const std::string message =
            message_of<InputError>([&] { (void)read_frame(file.sequence, 1); });
        EXPECT_TRUE(one_line_about(message, folder / "a1.nrrd")) << message;
        return message;
    };
    EXPECT_TRUE(
        contains(second(marked(1, {4, 3, 5})), "size is 4x3x5, that of the first frame 4x3x2"));
    EXPECT_TRUE(contains(second(marked(1, {4, 3, 2}, {1, 2, 4})), "spacing is 1, 2, 4"));
    Geometry geometry = marked(0).geometry();
    EXPECT_TRUE(contains(second(Volume(geometry, std::vector<float>(24, 0.5F))), "float32"));
    geometry.origin[1] = 7;
    const std::vector<std::uint8_t> samples(24, 1);
    EXPECT_TRUE(contains(second(Volume(geometry, samples)), "origin is 0, 7, 0"));
    geometry = marked(0).geometry();
    geometry.direction = Vec3(-1, -1, 1).asDiagonal();
    EXPECT_TRUE(contains(second(Volume(geometry, samples)), "axes"));
}

TEST(Sequence, files_that_vanish_and_names_that_make_no_sense_are_told_in_one_line) {
    const ScratchFolder folder;
    write_series(folder, {{"a0.nrrd", 0}, {"a1.nrrd", 1}});
    const SequenceFile file = open_sequence(folder / "a%d.nrrd");
    std::filesystem::remove(folder / "a1.nrrd");
    EXPECT_TRUE(one_line_about(message_of<InputError>([&] { (void)read_frame(file.sequence, 1); }),
                               folder / "a1.nrrd"));
    for (const char* name : {"b%d.nrrd", "a%s.nrrd", "a%d%d.nrrd", "a%3d.nrrd", "a%", "a%0000d",
                             "none.nrrd", "no/a%d.nrrd"}) {
        EXPECT_TRUE(one_line_about(refusal_of(folder / name), folder / name))
            << refusal_of(folder / name);
    }
    EXPECT_THROW((void)read_frame(file.sequence, 2), std::invalid_argument);
    EXPECT_THROW((void)read_frame(file.sequence, -1), std::invalid_argument);
}

TEST(Sequence, frames_can_be_made_in_memory) {
    const Sequence sequence =
        made_sequence(4, 0.5, [](int frame, const Progress&) { return marked(10 * frame); });
    EXPECT_EQ(marks_of(sequence), (std::vector<double>{0, 10, 20, 30}));
    EXPECT_EQ(sequence.period, 2);
    EXPECT_EQ(sequence.frame_bytes(), 24U);
    check(sequence);
    Sequence wrong = sequence;
    wrong.times[2] = wrong.times[1];
    EXPECT_THROW(check(wrong), std::invalid_argument);
    wrong = sequence;
    wrong.period = 1.5;
    EXPECT_THROW(check(wrong), std::invalid_argument);
    EXPECT_THROW(made_sequence(0, 1, sequence.reader), std::invalid_argument);
    EXPECT_THROW(made_sequence(1, 0, sequence.reader), std::invalid_argument);
}

TEST(Sequence, reading_a_frame_can_be_cancelled) {
    const ScratchFolder folder;
    write_series(folder, {{"a0.nrrd", 0}, {"a1.nrrd", 1}});
    const SequenceFile file = open_sequence(folder / "a%d.nrrd");
    struct Enough {};
    EXPECT_THROW((void)read_frame(file.sequence, 1, [](double) { throw Enough{}; }), Enough);
}

}  // namespace palpate::io::test
