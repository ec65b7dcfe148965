// Tool body: the solid of a rigid tool as distances from its skin, for edits that have the tool's
// own shape. Immutable. Not for the servo thread, which feels a tool with its points alone.
#pragma once

#include <memory>
#include <vector>

#include "palpate/tool.hpp"

namespace palpate {

/// Where the tool's shape is closed (each edge has an even number of triangles, turned either way)
/// the body is what it encloses. Otherwise the body is the tool's points, which has no inside:
/// edits reach as far round them as their brush says.
class ToolBody {
  public:
    /// Distances are computed at places `step` [mm] apart (farther where that would be more than
    /// four million) and are known up to `reach` [mm] from the skin, on both sides. Throws
    /// std::invalid_argument for a shape of more than 20,000 triangles, a step or reach that is not
    /// from 1e-6 to 1e6 mm, and a reach of more than half a million steps.
    ToolBody(std::shared_ptr<const Tool> tool, double step, double reach);

    /// From the skin to a point in tool axes [mm], below 0 inside; where it is more than the reach,
    /// at least that. Between the places it is interpolated linearly.
    double distance(const Vec3& point) const;

    const std::shared_ptr<const Tool>& tool() const { return tool_; }
    bool is_closed() const { return closed_; }
    double step() const { return asked_step_; }
    double reach() const { return reach_; }
    /// The corners of the box round the body [mm, tool axes], without its reach.
    const Vec3& low() const { return low_; }
    const Vec3& high() const { return high_; }

  private:
    std::shared_ptr<const Tool> tool_;
    double asked_step_, reach_;
    double step_;  // of the places
    bool closed_ = false;
    Vec3 low_, high_;
    Vec3 first_;  // the first place
    Index3 size_;
    std::vector<float> distances_;  // x fastest
};

}  // namespace palpate
