// A brush that is on while the hand stands still and a command makes it touch.
#include <functional>
#include <vector>

#include "palpate/tool.hpp"
#include "run/run_support.hpp"

namespace palpate::run {
namespace {

/// A hand of a mouse in the air before a ball, where the samples rise but are below its isovalue.
struct Hovering {
    std::shared_ptr<Data> data = test::stepped_data(test::loaded("synthetic:sphere:32x32x32"));
    Run live{data, test::with_device("mouse")};

    Hovering() {
        live.start();
        live.step();
        live.mouse()->aim({0, 0, 0});
        EXPECT_TRUE(test::steps_until(live, [&] { return here() > 0.2 * level(); }));
        live.mouse()->aim(live.snapshot()->session.device.position);
        test::step(live, 500);
        EXPECT_TRUE(is_free());
        EXPECT_LT(here(), 0.9 * level());
    }

    ProxyUpdate proxy() const { return live.snapshot()->session.tick.proxy; }
    bool is_free() const { return proxy().mode == Mode::free; }
    bool touches() const {
        return proxy().mode == Mode::constrained && proxy().status == UpdateStatus::done;
    }
    double level() const { return live.isovalue(); }
    double here() const { return value_at(live.field(), proxy().scp); }
};

TEST(RestingBrush, edits_nothing_when_a_change_makes_a_hand_touch_that_stands_still) {
    const std::vector<std::function<void(Hovering&)>> changes{
        [](Hovering& h) { h.live.send(command::Isovalue{h.here() - 3}); },
        [](Hovering& h) { h.live.use_field(Solid::below, Interpolation::cubic, {}); },
        [](Hovering& h) {
            h.live.send(command::UseTool{std::make_shared<const Tool>(sphere_tool(6, 2))});
        }};
    for (std::size_t i = 0; i < changes.size(); ++i) {
        Hovering hovering;
        hovering.data->editor().set_brush(HandBrush{.radius = 3, .rate = 5});
        test::step(hovering.live, 50);
        changes[i](hovering);
        EXPECT_TRUE(test::steps_until(hovering.live, [&] { return hovering.touches(); })) << i;
        test::step(hovering.live, 300);
        EXPECT_EQ(hovering.data->editor().state().version, 0U) << i;
    }
}

}  // namespace
}  // namespace palpate::run
