// Fine samples from coarse ones, compared with trilinear interpolation sample by sample.
#include "stream/loader/upsample.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "support/constants.hpp"
#include "support/edits.hpp"
#include "support/random.hpp"

namespace palpate::stream {
namespace {

using namespace palpate::support;

TEST(Upsample, is_trilinear_and_goes_on_at_the_border) {
    Random random(8);
    for (const SampleType type : sample_types) {
        const Geometry fine = grid({40, 30, 20}, {1, 2, 0.5}, {3, -4, 5});
        Geometry coarse = fine;
        coarse.size = {11, 8, 3};
        coarse.spacing = fine.spacing.cwiseProduct(Vec3(4, 3, 5));
        coarse.origin += Vec3(1.5, 2, 0.7);
        const Volume volume = noise_of(type, coarse, 9);
        for (int n = 0; n < 20; ++n) {
            SampleBox box;
            for (int a = 0; a < 3; ++a) {
                const int i = int(random.uniform(0, fine.size[a])),
                          j = int(random.uniform(0, fine.size[a]));
                box.low[a] = std::min(i, j);
                box.high[a] = std::max(i, j);
            }
            const Index3 size = box.high - box.low + Index3::Ones();
            std::vector<std::byte> out(size_of(type) * std::size_t(size.prod()));
            upsample(coarse, static_cast<const std::byte*>(volume.data()), type, fine, box,
                     {out.data(), size[0], std::ptrdiff_t(size[0]) * size[1]});
            const Geometry part = geometry_of(fine, box);
            const Volume got(part, type,
                             std::shared_ptr<const void>(std::shared_ptr<void>(), out.data()),
                             out.size());
            const Vec3 last = (coarse.size - Index3::Ones()).cast<double>();
            for_each_sample(part, [&](const Index3& at) {
                const Vec3 p =
                    index_from_physical(coarse, physical_from_index(part, at.cast<double>()))
                        .cwiseMax(Vec3::Zero())
                        .cwiseMin(last);
                double expected = 0;
                for (int corner = 0; corner < 8; ++corner) {
                    double weight = 1;
                    Index3 of;
                    for (int a = 0; a < 3; ++a) {
                        const int low = std::min(int(p[a]), coarse.size[a] - 2);
                        const int side = corner >> a & 1;
                        weight *= side ? p[a] - low : 1 - (p[a] - low);
                        of[a] = low + side;
                    }
                    expected += weight * volume.sample(of);
                }
                const double tolerance =
                    type == SampleType::float32 ? 1e-5 * volume.maximum() : 0.51;
                ASSERT_NEAR(got.sample(at), expected, tolerance);
            });
        }
    }
}

}  // namespace
}  // namespace palpate::stream
