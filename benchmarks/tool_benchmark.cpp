// An update of a tool's proxy against its points, and of the penalty method on the same way.
#include <string>

#include "benchmarks/timing.hpp"
#include "benchmarks/tool_hand.hpp"
#include "palpate/baselines/penalty_tool.hpp"

namespace palpate::benchmarks {
namespace {

/// There and back.
class ToolMotion {
  public:
    explicit ToolMotion(const std::vector<Pose>& path) : path_(path) {}
    const Pose& next() {
        const std::size_t n = path_.size(), at = count_++ % (2 * n);
        return path_[at < n ? at : 2 * n - 1 - at];
    }

  private:
    const std::vector<Pose>& path_;
    std::size_t count_ = 0;
};

void exact(benchmark::State& state, ToolTouch (*touch_of)(int)) {
    const ToolTouch touch = touch_of(static_cast<int>(state.range(0)));
    ToolProxy proxy(touch.tool);
    proxy.isovalue = touch.isovalue;
    ToolMotion hand(touch.path);
    time_ticks(state, [&] {
        benchmark::DoNotOptimize(update_tool(proxy, touch.field, hand.next()).proxy);
    });
    state.counters["points"] = static_cast<double>(touch.tool->points().size());
}

void penalty(benchmark::State& state, ToolTouch (*touch_of)(int)) {
    const ToolTouch touch = touch_of(static_cast<int>(state.range(0)));
    baselines::PenaltyTool tool{touch.tool, touch.isovalue};
    ToolMotion hand(touch.path);
    time_ticks(state, [&] {
        benchmark::DoNotOptimize(baselines::update_penalty(tool, touch.field, hand.next()).proxy);
    });
    state.counters["points"] = static_cast<double>(touch.tool->points().size());
}

using Run = void (*)(benchmark::State&, ToolTouch (*)(int));

void add(const ToolCase& tool, const char* method, Run run) {
    benchmark::RegisterBenchmark((tool.name + std::string(method)).c_str(), run, tool.touch)
        ->Arg(10)
        ->Arg(100)
        ->Arg(500)
        ->Arg(1000)
        ->Unit(benchmark::kMillisecond);
}

const int registered = [] {
    for (const ToolCase& tool : tool_cases()) {
        add(tool, "/exact", exact);
        add(tool, "/penalty", penalty);
    }
    return 0;
}();

}  // namespace
}  // namespace palpate::benchmarks
