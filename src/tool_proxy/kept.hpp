// The memory of a tool's updates for the next ones. It saves time and changes no result.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "palpate/tool_proxy.hpp"

namespace palpate::tool {

/// What is known about the samples round the tool. Changes no result but saves time.
struct Surroundings {
    /// Bounds of the field, its sign turned where the solid is below.
    struct Bounds {
        double most = 0;            ///< greatest value
        Vec3 slope = Vec3::Zero();  ///< greatest derivatives along the grid's axes [1/mm]
    };
    /// Four cubes along each axis.
    struct Brick {
        Index3 at = Index3::Zero();
        std::uint32_t epoch = 0;
        bool knows_wide = false;
        Bounds own;
        Bounds wide;  ///< with the 26 bricks round it
    };
    static constexpr std::size_t brick_count = 4096;
    std::vector<Brick> bricks = std::vector<Brick>(brick_count);
    std::uint32_t epoch = 1;
    std::shared_ptr<const Samples> samples;  ///< that it is about
    Moment moment;
    double sign = 0, background = 0;
};

/// Of one proxy.
struct Kept {
    // One per point, with room for more.
    std::vector<double> arms;    ///< distance from the reference point [mm]
    std::vector<double> expiry;  ///< travel [mm] up to which it certainly meets nothing
    double moved = 0;            ///< odometers: translation [mm] ...
    double turned = 0;           ///< ... and rotation [rad] so far
    std::vector<int> suspects;   ///< room for one motion
    /// A motion from the present pose, and the progress of testing its points. If a budget ends,
    /// the next update continues from here.
    struct Pass {
        Vec3 translation = Vec3::Zero(), rotation = Vec3::Zero();  ///< [mm], [rad]
        std::optional<Pose> exact;                                 ///< the end of the whole motion
        double part = 0;                 ///< of the motion that may be free; 0: none is under way
        int next = 0;                    ///< the first point that was not examined
        int suspects = 0, outdated = 0;  ///< so many may meet something, and may not be free
        int tries = 0, again = 0, first = -1;  ///< test of those: the next one, what blocked last
        double least = 1;                      ///< what they leave of the part
    } pass;
    Surroundings surroundings;
    double isovalue = 0;
    bool renewed = true;  ///< the tool is another one
    bool inside = false;  ///< recovery goes on
    /// Recovery so far.
    struct Recovery {
        int pushes = 0;
        double push = 1;  ///< how far they go, as a share of the longest
        int search = 0;   ///< place that it looks at next; 0: it pushes
    } recovery;
};

}  // namespace palpate::tool
