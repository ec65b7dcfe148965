// Field: moments between the frames of a sequence, and the field at them.
#include <gtest/gtest.h>

#include "palpate/field.hpp"
#include "support/constants.hpp"
#include "support/edits.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

std::vector<Frame> noise_frames(SampleType type, const std::vector<double>& times,
                                const Geometry& geometry = grid({7, 6, 5})) {
    std::vector<Frame> frames;
    for (const double time : times) {
        frames.push_back({time, noise_of(type, geometry, frames.size() + 1)});
    }
    return frames;
}

std::shared_ptr<const Samples> noise_sequence(SampleType type, const std::vector<double>& times,
                                              double period = 0) {
    return std::make_shared<const Samples>(noise_frames(type, times), period);
}

void expect_moment(const Samples& samples, double time, std::size_t from, std::size_t to,
                   double weight) {
    const Moment moment = samples.moment_at(time);
    SCOPED_TRACE(time);
    EXPECT_EQ(moment.from, from);
    EXPECT_EQ(moment.to, to);
    EXPECT_NEAR(moment.weight, weight, 1e-12);
}

TEST(Moment, lies_between_the_frames_round_it_and_at_the_ends_beyond_them) {
    const auto s = noise_sequence(SampleType::uint8, {1, 1.5, 4});
    expect_moment(*s, 1, 0, 0, 0);
    expect_moment(*s, 1.1, 0, 1, 0.2);
    expect_moment(*s, 1.5, 1, 1, 0);
    expect_moment(*s, 3.5, 1, 2, 0.8);
    expect_moment(*s, 4, 2, 2, 0);
    for (const double before : {-infinity, -1e300, 0.0, 0.999}) expect_moment(*s, before, 0, 0, 0);
    for (const double after : {4.001, 1e300, infinity}) expect_moment(*s, after, 2, 2, 0);
    expect_moment(*s, not_a_number, 0, 0, 0);
    EXPECT_EQ(s->within(0), 1);
    EXPECT_EQ(s->within(2), 2);
    EXPECT_EQ(s->within(9), 4);
}

TEST(Moment, goes_on_from_the_last_frame_to_the_first_where_there_is_a_period) {
    const auto s = noise_sequence(SampleType::uint8, {1, 1.5, 4}, 4);  // comes again at 5
    for (const int rounds : {0, 1, -1, 7, -1000}) {
        const double t = 4.0 * rounds;
        expect_moment(*s, t + 1, 0, 0, 0);
        expect_moment(*s, t + 1.25, 0, 1, 0.5);
        expect_moment(*s, t + 3.5, 1, 2, 0.8);
        expect_moment(*s, t + 4, 2, 2, 0);
        expect_moment(*s, t + 4.25, 2, 0, 0.25);
        expect_moment(*s, t + 0.75, 2, 0, 0.75);
    }
    for (const double odd : {not_a_number, infinity, -infinity}) expect_moment(*s, odd, 0, 0, 0);
    EXPECT_EQ(s->within(123), 123);
}

TEST(Moment, of_any_time_is_one_of_the_sequence) {
    Random random(1);
    for (int i = 0; i < scaled(100'000); ++i) {
        std::vector<double> times{random.uniform(-5, 5)};
        const int count = random.below(4);
        for (int k = 0; k < count; ++k) {
            times.push_back(times.back() + std::pow(10.0, random.uniform(-9, 3)));
        }
        const double length = times.back() - times.front();
        const double period = random.chance(0.5) ? length + std::pow(10, random.uniform(-9, 2)) : 0;
        if (period > 0 && !(period > length)) continue;
        static const Volume volume = noise_of(SampleType::uint8, grid({1, 1, 1}), 1);
        std::vector<Frame> frames;
        for (const double time : times) frames.push_back({time, volume});
        const Samples samples(std::move(frames), period);
        const double time = random.chance(0.3) ? times[random.bits() % times.size()]
                                               : std::pow(10.0, random.uniform(-12, 300)) *
                                                     (random.chance(0.5) ? 1 : -1);
        const Moment m = samples.moment_at(time);
        ASSERT_LT(m.from, times.size());
        ASSERT_LT(m.to, times.size());
        ASSERT_TRUE(m.weight >= 0 && m.weight < 1) << m.weight;
        ASSERT_TRUE(m.weight > 0 ? m.to == (m.from + 1) % times.size() : m.to == m.from);
    }
}

TEST(Moment, of_one_frame_is_that_frame) {
    const auto s = noise_sequence(SampleType::uint8, {3});
    for (const double t : {0.0, 3.0, 1e9, not_a_number}) expect_moment(*s, t, 0, 0, 0);
}

TEST(ChangingField, between_two_frames_each_sample_of_a_cell_lies_between_theirs) {
    std::int64_t between = 0;
    for (const SampleType type :
         {SampleType::uint8, SampleType::int16, SampleType::uint16, SampleType::float32}) {
        const auto samples = noise_sequence(type, {0, 1, 3}, 3.5);
        constexpr double background = 3.5;
        Field field = linear_field(samples, Solid::above, background);
        std::vector<Field> at_frames;
        for (const Frame& frame : samples->frames()) {
            at_frames.emplace_back(frame.volume, Solid::above, background);
        }
        for (const double time : {0.0, 0.25, 0.999, 1.0, 1.7, 3.0, 3.2, 3.5, 100.1}) {
            field.set_time(time);
            const Moment m = samples->moment_at(time);
            const double w = m.weight;
            between += w > 0;
            const Volume whole = flattened(*samples, m);
            Geometry padded = field.geometry();
            padded.size += Index3::Constant(4);
            for_each_sample(padded, [&](const Index3& at) {
                const Index3 cell = at - Index3::Constant(2);
                const CellSamples a = at_frames[m.from].cell(cell), b = at_frames[m.to].cell(cell);
                const CellSamples now = field.cell(cell);
                for (int corner = 0; corner < 8; ++corner) {
                    const Index3 i = cell + Index3(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
                    const bool inside =
                        (i.array() >= 0).all() && (i.array() < field.geometry().size.array()).all();
                    const std::size_t c = static_cast<std::size_t>(corner);
                    const double wanted =
                        inside ? (w > 0 ? (1 - w) * a[c] + w * b[c] : a[c]) : background;
                    ASSERT_EQ(now[c], wanted) << time << " s, cell " << cell.transpose();
                    if (inside) {
                        ASSERT_EQ(samples->sample(i, m), wanted);
                        ASSERT_NEAR(whole.sample(i), wanted,
                                    type == SampleType::float32 ? 1e-6 : 0.5);
                    }
                }
            });
        }
    }
    EXPECT_EQ(between, 4 * 5);
}

TEST(ChangingField, takes_another_version_and_keeps_background_side_and_time) {
    const auto first = noise_sequence(SampleType::int16, {0, 1, 2});
    const auto second = noise_sequence(SampleType::int16, {0.5, 1.5});
    Field field = linear_field(first, Solid::below);
    const double background = field.background();
    field.set_time(1.25);
    const Field copy = field;
    field.use(second);
    EXPECT_EQ(field.time(), 1.25);
    EXPECT_EQ(field.moment().weight, 0.75);
    EXPECT_EQ(field.background(), background);
    EXPECT_EQ(field.solid(), Solid::below);
    EXPECT_EQ(&copy.samples(), first.get());  // a copy goes on with what it has
    EXPECT_EQ(copy.moment().weight, 0.25);
    EXPECT_NE(field.cell({2, 2, 2}), copy.cell({2, 2, 2}));
}

TEST(ChangingField, range_and_tolerance_cover_edits_and_frames) {
    const auto plain =
        samples_of(volume_of<float>(grid(cube(5)), [](const Index3& i) { return i[0]; }));
    Field field = linear_field(plain, Solid::above, 0);
    EXPECT_EQ(field.range(), 4);
    const double before = field.tolerance();
    field.use(edited(plain, edit::Fill{{{1, 1, 1}, {1, 1, 1}}, 1000}).samples);
    EXPECT_EQ(field.range(), 1000);
    EXPECT_GT(field.tolerance(), before);
    field.use(std::make_shared<const Samples>(std::vector<Frame>{
        {0, plain->volume()},
        {1, volume_of<float>(grid(cube(5)), [](const Index3&) { return -50; })}}));
    EXPECT_EQ(field.range(), 54);
}

}  // namespace
