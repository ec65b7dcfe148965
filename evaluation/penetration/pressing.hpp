// Where and how a hand presses into a body, and what it feels going in and out again.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/subject.hpp"
#include "palpate/penetrability.hpp"
#include "pictures/view.hpp"

namespace palpate::evaluation {

/// A level and what lies there, for pictures.
struct NamedLevel {
    double isovalue = 0;
    std::string name;
};

/// A straight line into a body.
struct PressingLine {
    explicit PressingLine(Subject s) : subject(std::move(s)) {}

    Subject subject;                   ///< `isovalue` is the level felt first: the skin
    Vec3 entry = Vec3::Zero();         ///< [mm, physical] where the line first meets that level
    Vec3 inward = Vec3(0, 1, 0);       ///< unit
    double depth = 0;                  ///< [mm] how far past the entry the hand goes
    std::vector<DensityRange> ranges;  ///< of interest: skin and bone
    std::vector<NamedLevel> levels;    ///< drawn; from the outside in
    std::optional<pictures::View> view;
};

/// The head of a CT scan (through the forehead into the brain), where the data folder has it, and
/// the Shepp-Logan head (from its left to its middle); or the user's volumes, each from the first
/// side of its box that meets its level towards the middle. Throws std::invalid_argument where none
/// does.
std::vector<PressingLine> pressing_lines(const std::vector<Subject>& subjects,
                                         const std::filesystem::path& data, bool quick,
                                         const std::function<void(const std::string&)>& note);

/// How the hand presses.
struct PressingPlan {
    double stiffness = 0.5;  ///< k [N/mm]
    double threshold = 1;    ///< PT [device mm]
    double speed = 20;       ///< [device mm/s]
    double rate = 1000;      ///< [Hz]
    double approach = 5;     ///< [device mm] of free space before the entry
};

/// One tick.
struct PressingTick {
    double depth = 0;     ///< [mm of volume] of the hand past the entry
    bool inwards = true;  ///< going in
    ProxyUpdate update;   ///< after penetrability
    double pull = 0;      ///< |SCP - HIP| [device mm]
    double force = 0;     ///< k |SCP - HIP| in contact, else 0 [N]
    double density_at_hand = 0;
};

/// mm of volume a mm of hand: a voxel.
double pressing_scale(const PressingLine& line);

/// All ticks in order, from free space in and out again.
std::vector<PressingTick> press(const PressingLine& line, const Penetrability& penetrability,
                                const PressingPlan& plan);

}  // namespace palpate::evaluation
