// An application that edits the data while a hand touches it: it drills, fills a box and undoes an
// edit while a servo runs.
#include <chrono>
#include <cstdio>
#include <thread>
#include <vector>

#include "palpate/palpate.hpp"

namespace {

using namespace palpate;

/// A hand that rests 4 mm deep in the block.
class RestingHand : public Device {
  public:
    DeviceInfo info() const override { return {}; }
    DeviceReading read(double) noexcept override {
        DeviceReading reading;
        reading.status = DeviceStatus::ready;
        reading.position = {16, 16, 20};
        return reading;
    }
    void write(const Wrench&, double) noexcept override {}  // a device would push here
    void stop() noexcept override {}
};

/// The force once nothing holds it back: the ramp after a start or a pause, the rate limit.
double force_after(const Servo& servo, std::uint64_t version) {
    for (;;) {
        const auto now = servo.snapshot();
        if (now && now->session.version == version && now->session.tick.force_flags == 0) {
            return now->session.tick.force.norm();
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
}

}  // namespace

int main() {
    // A block of 200 below z = 24, air above.
    Geometry geometry;
    geometry.size = {32, 32, 32};
    std::vector<std::uint8_t> samples(32 * 32 * 32);
    for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = i / 1024 < 24 ? 200 : 0;
    const Field field(Volume(geometry, std::move(samples)));
    const double isovalue = 100;

    RestingHand hand;
    Servo servo({make_renderer(field, isovalue), {}}, hand, {.real_time = false});
    servo.start();
    std::printf("the block: force %.2f N\n", force_after(servo, 0));

    Editor editor(field.shared_samples());
    std::uint64_t version = 0;
    const auto feel = [&](const char* what) {
        servo.send(command::Samples{editor.samples(), ++version});
        std::printf("%s: force %.2f N\n", what, force_after(servo, version));
    };
    // A burr of 3 mm drills from the surface to the hand, so that nothing is left there.
    editor.apply(
        edit::Stroke{brush_for(BrushKind::carve, field, isovalue, 3), {16, 16, 26}, {16, 16, 20}});
    feel("drilled");
    editor.apply(edit::Fill{{{0, 0, 0}, {31, 31, 21}}, 250});
    feel("filled up to 2 mm above the hand");
    editor.undo();
    feel("undone");
    servo.stop();
}
