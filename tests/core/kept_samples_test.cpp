// What a proxy keeps of the samples round a cube: it tells every change of them, and nothing else.
#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <vector>

#include "palpate/session.hpp"
#include "proxy/kept_samples.hpp"
#include "support/fields.hpp"
#include "support/random.hpp"

namespace palpate::cubic {
namespace {

template <class T>
class KeptSamplesOf : public testing::Test {};
using Types = testing::Types<std::uint8_t, std::int16_t, std::uint16_t, float, double>;
TYPED_TEST_SUITE(KeptSamplesOf, Types);

/// Without a sample to spare round the 27, so that reading beyond the block would be noticed.
template <class T>
struct Block {
    std::ptrdiff_t nx, ny, nz, x, y, z;  ///< size, and where the centre is
    std::vector<T> samples = std::vector<T>(static_cast<std::size_t>(nx * ny * nz));

    std::ptrdiff_t row() const { return nx; }
    std::ptrdiff_t slice() const { return nx * ny; }
    std::size_t at(std::ptrdiff_t i, std::ptrdiff_t j, std::ptrdiff_t k) const {
        return static_cast<std::size_t>(i + j * row() + k * slice());
    }
    const T* centre() const { return samples.data() + at(x, y, z); }
    bool is_near(std::ptrdiff_t i, std::ptrdiff_t j, std::ptrdiff_t k) const {
        return std::abs(i - x) <= 1 && std::abs(j - y) <= 1 && std::abs(k - z) <= 1;
    }
};

TYPED_TEST(KeptSamplesOf, tell_a_change_of_each_of_the_27_and_of_no_other_sample) {
    std::mt19937 random(11);
    std::uniform_int_distribution<int> level(0, 100);
    for (auto& block : {Block<TypeParam>{3, 3, 3, 1, 1, 1}, Block<TypeParam>{4, 5, 6, 1, 1, 1},
                        Block<TypeParam>{4, 5, 6, 2, 3, 4}, Block<TypeParam>{5, 5, 5, 2, 2, 2}}) {
        Block<TypeParam> b = block;
        for (auto& sample : b.samples) sample = static_cast<TypeParam>(level(random));
        KeptSamples kept;
        EXPECT_FALSE(Kept::are(kept, b.centre(), b.row(), b.slice()));
        Kept::keep(kept, b.centre(), b.row(), b.slice());
        EXPECT_TRUE(Kept::are(kept, b.centre(), b.row(), b.slice()));
        for (std::ptrdiff_t k = 0; k < b.nz; ++k) {
            for (std::ptrdiff_t j = 0; j < b.ny; ++j) {
                for (std::ptrdiff_t i = 0; i < b.nx; ++i) {
                    TypeParam& sample = b.samples[b.at(i, j, k)];
                    const TypeParam before = sample;
                    sample = static_cast<TypeParam>(sample + 1);
                    EXPECT_EQ(Kept::are(kept, b.centre(), b.row(), b.slice()), !b.is_near(i, j, k))
                        << i << ' ' << j << ' ' << k;
                    sample = before;
                }
            }
        }
    }
}

TEST(KeptSamples, of_one_type_are_not_those_of_another) {
    const std::vector<std::int16_t> samples(27, 0);
    const std::vector<std::uint16_t> others(27, 0);
    KeptSamples kept;
    Kept::keep(kept, samples.data() + 13, 3, 9);
    EXPECT_FALSE(Kept::are(kept, others.data() + 13, 3, 9));
}

TEST(KeptSamples, a_session_goes_on_like_one_that_a_recording_brings_back) {
    const Field field(
        support::noise_volume<std::uint8_t>(support::grid(support::cube(10)), 1, 0, 256));
    RendererSettings settings;
    settings.proxy.step_budget = 12;  // ends many updates, and counts what they compute anew
    Session session{make_renderer(field, 128, settings), {}};
    support::Random random(1);
    Vec3 hand = Vec3::Zero();
    int cut = 0;
    for (int i = 0; i < 2000; ++i) {
        auto point = std::make_shared<SessionPoint>();
        checkpoint(session, *point);
        point->proxy.kept = {};
        point->proxy.kept_samples = {};
        Session other{make_renderer(field, 128, settings), {}};
        apply(other, command::Resume{point});
        if (random.chance(0.1)) hand = random.point(0, 9);
        const DeviceReading reading{.position = hand, .status = DeviceStatus::ready};
        const SessionTick a = advance(session, 0.001 * (i + 1), reading);
        const SessionTick b = advance(other, 0.001 * (i + 1), reading);
        ASSERT_EQ(a.tick.proxy.scp, b.tick.proxy.scp) << i;
        ASSERT_EQ(a.tick.force, b.tick.force) << i;
        cut += a.tick.proxy.status == UpdateStatus::out_of_budget;
    }
    EXPECT_GT(cut, 100);
}

}  // namespace
}  // namespace palpate::cubic
