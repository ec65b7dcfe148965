// The tools that the panel offers, in sizes that suit the data.
#pragma once

#include <memory>
#include <vector>

#include "palpate/io/tool_file.hpp"

namespace palpate::viewer {

/// A point, then each built-in shape: some voxels large, but for the fingertip, which has its own
/// size.
std::vector<io::ToolSpec> built_in_tools(const Geometry& geometry);

struct MadeTool {
    std::shared_ptr<const Tool> tool;  ///< null: a point
    double spacing = 0;                ///< [mm] of its points
};
/// Of the tool `scale` times as large. Points are half a voxel apart, or farther where that would
/// be more than two thousand, which a tick has time for. Throws std::invalid_argument for what is
/// no tool.
MadeTool made_tool(const io::ToolSpec& spec, double scale, const Geometry& geometry);

}  // namespace palpate::viewer
