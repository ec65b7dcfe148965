// Branches as random walks that keep their direction, stamped into the volume ball by ball.
#include "evaluation/performance/neuron.hpp"

#include <algorithm>
#include <cmath>

#include "palpate/scenes/volumes.hpp"
#include "scenes/random.hpp"

namespace palpate::evaluation {
namespace {

using scenes::Random;

constexpr double edge = 2;  // [voxel] over which the density falls to 0 outside the radius
constexpr double thinnest = 1;

/// Lengths and points in voxels, index space.
struct Tip {
    Vec3 point, direction;
    double radius = 0;
    double length_left = 0;
};

class Arbor {
  public:
    Arbor(const Index3& size, std::uint64_t seed) : size_(size), random_(seed) {
        const auto count = static_cast<std::size_t>(size.cast<std::int64_t>().prod());
        samples_.assign(count, 0);
    }

    std::vector<std::uint8_t> grown() {
        const Vec3 extent = size_.cast<double>();
        const Vec3 soma = 0.5 * (extent - Vec3::Ones());
        stamp(soma, 0.25 * extent.minCoeff());
        std::vector<Tip> tips;
        constexpr int stems = 7;
        for (int i = 0; i < stems; ++i) {
            tips.push_back({soma, wandered(Vec3::Zero(), 1), 4, 0.5 * extent.maxCoeff()});
        }
        while (!tips.empty()) {
            Tip tip = tips.back();
            tips.pop_back();
            grow(tip, tips);
        }
        return std::move(samples_);
    }

  private:
    /// Flatter than the grid's own shape: the dendrites of a slice lie in it.
    Vec3 wandered(const Vec3& direction, double by) {
        Vec3 kick(random_.uniform(-1, 1), random_.uniform(-1, 1), random_.uniform(-1, 1));
        kick = by * kick.cwiseProduct(size_.cast<double>() / size_.maxCoeff());
        const Vec3 turned = direction + kick;
        return turned.norm() > 1e-9 ? Vec3(turned.normalized()) : Vec3::UnitX();
    }

    void grow(Tip tip, std::vector<Tip>& tips) {
        constexpr double step = 0.7;
        double to_fork = random_.uniform(0.08, 0.25) * size_.maxCoeff();
        for (; tip.length_left > 0; tip.length_left -= step, to_fork -= step) {
            stamp(tip.point, tip.radius);
            tip.point += step * tip.direction;
            tip.direction = wandered(tip.direction, 0.12);
            turn_back(tip);
            tip.radius = std::max(thinnest, tip.radius - 0.004 * step);
            if (to_fork > 0) continue;
            for (int i = 0; i < 2; ++i) {
                const double thinner = std::max(thinnest, 0.8 * tip.radius);
                tips.push_back({tip.point, wandered(tip.direction, 0.8), thinner,
                                random_.uniform(0.5, 0.9) * tip.length_left});
            }
            return;
        }
    }

    /// Before a branch would leave the grid.
    void turn_back(Tip& tip) const {
        for (int a = 0; a < 3; ++a) {
            const double margin = std::min(5.0, 0.25 * size_[a]);
            if (tip.point[a] < margin) tip.direction[a] = std::abs(tip.direction[a]);
            if (tip.point[a] > size_[a] - 1 - margin) {
                tip.direction[a] = -std::abs(tip.direction[a]);
            }
        }
    }

    void stamp(const Vec3& centre, double radius) {
        const double reach = radius + edge;
        Index3 low, high;
        for (int a = 0; a < 3; ++a) {
            low[a] = std::max(0, static_cast<int>(std::ceil(centre[a] - reach)));
            high[a] = std::min(size_[a] - 1, static_cast<int>(std::floor(centre[a] + reach)));
        }
        for (int k = low[2]; k <= high[2]; ++k) {
            for (int j = low[1]; j <= high[1]; ++j) {
                for (int i = low[0]; i <= high[0]; ++i) {
                    const double away = (Vec3(i, j, k) - centre).norm();
                    if (away >= reach) continue;
                    const auto at = (std::size_t(k) * std::size_t(size_[1]) + std::size_t(j)) *
                                        std::size_t(size_[0]) +
                                    std::size_t(i);
                    const auto value = static_cast<std::uint8_t>(255 * (1 - away / reach));
                    samples_[at] = std::max(samples_[at], value);
                }
            }
        }
    }

    Index3 size_;
    Random random_;
    std::vector<std::uint8_t> samples_;
};

}  // namespace

Subject synthetic_neuron(const Index3& size, std::uint64_t seed) {
    Volume volume(scenes::centred(size), Arbor(size, seed).grown());
    return {"synthetic-neuron", Field(std::move(volume)), 64, {}, ""};
}

}  // namespace palpate::evaluation
