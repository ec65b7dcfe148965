// Seeded random input for tests: the raw output of mt19937_64 (the same with every library) mapped
// without std distributions, so that golden results are the same everywhere.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <random>

#include "palpate/tool.hpp"

namespace palpate::support {

class Random {
  public:
    explicit Random(std::uint64_t seed) : engine_(seed) {}

    std::uint64_t bits() { return engine_(); }
    /// Uniform in [low, high).
    double uniform(double low, double high) {
        return low + (high - low) * (static_cast<double>(bits() >> 11) * 0x1p-53);
    }
    /// Uniform in 0 .. count - 1.
    int below(int count) {
        return static_cast<int>((bits() >> 33) % static_cast<std::uint64_t>(count));
    }
    bool chance(double probability) { return uniform(0, 1) < probability; }
    /// Each coordinate uniform in [low, high).
    Vec3 point(double low, double high) {
        const double x = uniform(low, high);
        const double y = uniform(low, high);
        return {x, y, uniform(low, high)};
    }
    /// A unit vector, uniform on the sphere.
    Vec3 direction() {
        while (true) {
            const Vec3 v = point(-1, 1);
            const double squared = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
            if (squared > 1e-4 && squared <= 1) return v / std::sqrt(squared);
        }
    }
    /// An orientation, though not a uniform one.
    Quaternion orientation() { return turned(Quaternion::Identity(), point(-3, 3)); }

  private:
    std::mt19937_64 engine_;
};

#if defined(__has_feature)
#define PALPATE_HAS_FEATURE(x) __has_feature(x)
#else
#define PALPATE_HAS_FEATURE(x) 0
#endif
#if !defined(__OPTIMIZE__) || defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || \
    PALPATE_HAS_FEATURE(address_sanitizer) || PALPATE_HAS_FEATURE(thread_sanitizer)
inline constexpr bool is_slow_build = true;
#else
inline constexpr bool is_slow_build = false;
#endif
#undef PALPATE_HAS_FEATURE

/// `count` repetitions in an optimised build, a twentieth of them in a slow one.
constexpr int scaled(int count) {
    return is_slow_build ? (count + 19) / 20 : count;
}

/// As scaled(), or as many as the environment variable PALPATE_TEST_UPDATES says: for long runs.
inline int scaled_or_asked(int usual) {
    const char* const asked = std::getenv("PALPATE_TEST_UPDATES");
    return asked ? std::atoi(asked) : scaled(usual);
}

}  // namespace palpate::support
