// A run that starts in place of another one.
#include "palpate/run/run.hpp"
#include "run/run_support.hpp"

namespace palpate::run {
namespace {

TEST(StartAs, goes_on_with_what_was_asked_for_there_and_ends_the_run_before) {
    const auto data = test::stepped_data(test::loaded("synthetic:sphere:32x32x32"));
    run::Run before(data, test::with_device("mouse"));
    before.start();
    ForceSettings force = before.settings().force;
    force.stiffness = 0.2;
    before.send(force);
    before.send(command::Isovalue{65.5});
    before.use_field(Solid::above, Interpolation::linear);
    before.send(command::Freeze{true});
    run::Run same(data, before.setup());
    EXPECT_THROW(before.start_as(same), WrongState) << "it has started";
    EXPECT_THROW(run::Run(data, before.setup()).start_as(same), WrongState) << "nothing to end";
    same.start_as(before);
    EXPECT_THROW(before.step(), WrongState);
    EXPECT_TRUE(same.frozen()) << "the device is the same";

    run::Run other(data, test::with_device("simulated:hand=hold,depth=5,seconds=60"));
    other.start_as(same);
    EXPECT_FALSE(other.frozen());
    EXPECT_EQ(other.isovalue(), 65.5);
    EXPECT_EQ(other.settings().force.stiffness, 0.2);
    EXPECT_EQ(other.field().interpolation(), Interpolation::linear);
    EXPECT_TRUE(test::steps_until(other, [&] {
        const auto now = other.snapshot();
        return now && now->session.tick.proxy.mode == Mode::constrained;
    }));
}

}  // namespace
}  // namespace palpate::run
