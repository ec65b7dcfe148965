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
    // name                     N   N/mm   box [mm]       wrist gripper N mm
    {"PHANToM Omni",            3.3, 0.7,  160, 120,  70, true},
    {"Touch",                   3.3, 0.4,  160, 120,  70, true},
    {"Touch X",                 7.9, 1.48, 160, 120, 120, true},
    {"Premium 1.5/6DOF",        8.5, 3.5,  381, 267, 191, true, false, 170},
    {"omega.3",                12,   5,    110, 110, 110},
    {"omega.6",                12,   5,    110, 110, 110, true},
    {"omega.7",                12,   5,    110, 110, 110, true, true},
    {"delta.3",                20,   5,    260, 260, 260},
    {"delta.6",                20,   5,    260, 260, 260, true, false, 150},
    {"sigma.3",                20,   4,    130, 130, 130},
    {"sigma.6+",               12,   4,    130, 130, 130, true, false, 200},
    {"sigma.7",                20,   4,    130, 130, 130, true, true,  200},
    {"lambda.3",               20,   4,    165, 165, 165},
    {"lambda.6",               20,   4,    165, 165, 165, true, false, 150},
    {"lambda.7",               20,   4,    165, 165, 165, true, true,  150},
    {"Falcon",                  8,   3,     80,  80,  80},
    {"Inverse3",               10,   1,    170, 170, 170},
    {"Inverse3 with VerseGrip", 10,  1,    170, 170, 170, true},
    {"Minverse",                3.3, 0.5,  100, 100, 100},
    // The least of its kind, for models that are not listed.
    {"Force Dimension device",  8,   3,     80,  80,  80, false, false, 150},
};
// clang-format on

}  // namespace

const Model& model_named(std::string_view name) {
    const auto* const found = std::ranges::find(models, name, &Model::name);
    if (found == std::end(models)) {
        throw std::invalid_argument("no model " + std::string(name));
    }
    return *found;
}

}  // namespace palpate::devices
