// The table of models. docs/devices/models.md gives the source of each figure: change both
// together.
#include "devices/models.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <string>

namespace palpate::devices {
namespace {

// clang-format off
constexpr Model models[] = {
    // name                     N   cont. N/mm  ms    box [mm]       wrist gripper N mm
    {"PHANToM Omni",            3.3, 0.88, 0.7,  0.5,  160, 120,  70, true},
    {"Touch",                   3.3, 0.88, 0.4,  1,    160, 120,  70, true},
    {"Touch X",                 7.9, 1.75, 1.48, 1,    160, 120, 120, true},
    {"Premium 1.5/6DOF",        8.5, 1.4,  3.5,  0.5,  381, 267, 191, true, false, 170},
    {"omega.3",                12,  12,    5,    0.25, 110, 110, 110},
    {"omega.6",                12,  12,    5,    0.25, 110, 110, 110, true},
    {"omega.7",                12,  12,    5,    0.25, 110, 110, 110, true, true},
    {"delta.3",                20,  20,    5,    0.25, 260, 260, 260},
    {"delta.6",                20,  20,    5,    0.25, 260, 260, 260, true, false, 150},
    {"sigma.3",                20,  20,    4,    0.25, 130, 130, 130},
    {"sigma.6+",               12,  12,    4,    0.25, 130, 130, 130, true, false, 200},
    {"sigma.7",                20,  20,    4,    0.25, 130, 130, 130, true, true,  200},
    {"lambda.3",               20,  20,    4,    0.25, 165, 165, 165},
    {"lambda.6",               20,  20,    4,    0.25, 165, 165, 165, true, false, 150},
    {"lambda.7",               20,  20,    4,    0.25, 165, 165, 165, true, true,  150},
    {"Falcon",                  8,   1.3,  3,    1,     80,  80,  80},
    {"Inverse3",               10,   1.7,  1,    1,    170, 170, 170},
    {"Inverse3 with VerseGrip", 10,  1.7,  1,    1,    170, 170, 170, true},
    {"Minverse",                3.3, 0.55, 0.5,  1,    100, 100, 100},
    // The least of its kind, for models that are not listed.
    {"Force Dimension device",  8,   1.3,  3,    1,     80,  80,  80, false, false, 150},
};
// clang-format on

}  // namespace

DeviceLimits limits_of(const Model& model, double rate, double exchange) {
    DeviceLimits limits;
    limits.maximum_force = model.force;
    limits.continuous_force = model.continuous;
    limits.maximum_torque = model.torque;
    limits.rate = rate;
    limits.delay = 1e-3 * model.delay + exchange;
    return limits;
}

const Model& model_named(std::string_view name) {
    const auto* const found = std::ranges::find(models, name, &Model::name);
    if (found == std::end(models)) {
        throw std::invalid_argument("no model " + std::string(name));
    }
    return *found;
}

}  // namespace palpate::devices
