// Recordings damaged at random: rendered again or refused as input, never anything else.
#include <cstdint>
#include <exception>
#include <string>
#include <utility>

#include "palpate/baselines/methods.hpp"
#include "palpate/run/replay.hpp"
#include "run/run_support.hpp"
#include "support/random.hpp"
#include "support/recordings.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::run {
namespace {

constexpr const char* sphere = "synthetic:sphere:9x9x9";

/// A hand that presses into the sphere, from the middle of a session on, with commands of every
/// kind that is recorded by itself.
std::string recording(const LoadedVolume& loaded) {
    const support::ScratchFolder folder;
    io::RecordingHead head;
    head.version = "1.2.3";
    head.volume = io::identify(loaded.volume, {{"volume", sphere}});
    head.isovalue = 76.5;
    head.method = "exact";
    Session session = recorded_session(head, loaded, "made here");
    io::RecordingWriter writer(folder / "r.csv", head);
    const std::vector<Command> commands{command::Isovalue{70},
                                        command::Freeze{true},
                                        command::Freeze{false},
                                        command::Clutch{true},
                                        command::Clutch{false},
                                        command::Scale{1.5},
                                        command::Forces{true},
                                        command::Moment{1},
                                        command::Speed{0},
                                        ForceSettings{},
                                        Friction{0.5, 0.25},
                                        penetrability_threshold(1, 60),
                                        DeviceLimits{2, 1000, 0.0025}};
    const auto tick = [&](int i) {
        DeviceReading reading;
        reading.status = DeviceStatus::ready;
        reading.position = Vec3(0.05 * i, 4, 4);
        return advance(session, 1e-3 * i, reading);
    };
    for (int i = -30; i < 0; ++i) (void)tick(i);
    const auto point = std::make_shared<SessionPoint>();
    checkpoint(session, *point);
    writer.queue().push(Command(command::Resume{point}));
    for (int i = 0; i < 65; ++i) {
        if (i % 5 == 4) {
            const Command& command = commands[static_cast<std::size_t>(i / 5)];
            apply(session, command);
            writer.queue().push(command);
        }
        writer.queue().push(tick(i));
    }
    writer.finish(0);
    return support::bytes_of(folder / "r.csv");
}

/// Some bytes changed, removed or repeated; of recordings with checksums mostly the head.
std::string damaged(std::string text, support::Random& random) {
    const int count = 1 + random.below(3);
    for (int i = 0; i < count; ++i) {
        const auto size = static_cast<int>(text.size());
        const auto at = static_cast<std::size_t>(random.below(size - 40));
        const auto length = static_cast<std::size_t>(1 + random.below(30));
        switch (random.below(5)) {
            case 0:
                text[at] = static_cast<char>(random.below(256));
                break;
            case 1:
                text[at] = "0123456789-.e,:{}[]\"#\n"[random.below(22)];
                break;
            case 2:
                text.erase(at, length);
                break;
            case 3:
                text.insert(at, text.substr(at, length));
                break;
            default: {
                // A whole number becomes another kind of value.
                const std::size_t digit = text.find_first_of("0123456789", at);
                const std::string_view values[]{"1e308", "-1", "null",       "\"inf\"",
                                                "{}",    "[]", "99999999999"};
                if (digit != std::string::npos) text.replace(digit, 1, values[random.below(7)]);
            }
        }
    }
    return text;
}

TEST(Replay, of_a_damaged_recording_renders_it_or_refuses_it_as_input) {
    const LoadedVolume loaded = test::loaded(sphere);
    const std::string now = recording(loaded);
    const std::string old = support::as_format_1(now);
    support::Random random(3);
    int rendered = 0, refused = 0;
    for (int i = 0; i < 6000; ++i) {
        const std::string text = damaged(i % 2 ? now : old, random);
        try {
            io::RecordingReader reader(text, "r.csv");
            (void)recorded_source(reader.head(), "r.csv", {});
            Replay replay(reader, loaded, "r.csv");
            while (const auto tick = replay.next()) {
                ASSERT_TRUE(tick->again.tick.force.allFinite());
            }
            ++rendered;
        } catch (const io::InputError&) {
            ++refused;
        } catch (const std::exception& e) {
            FAIL() << e.what() << "\n" << text;
        }
    }
    EXPECT_GT(rendered, 100);
    EXPECT_GT(refused, 3000);
}

TEST(Replay, the_head_of_a_recording_is_read_without_the_rest) {
    const support::ScratchFolder folder;
    const std::filesystem::path path = folder / "r.csv";
    support::put_bytes(path, recording(test::loaded(sphere)) + std::string(10, '\0'));
    EXPECT_THROW(io::RecordingReader reader(path), io::InputError) << "is no text at the end";
    const io::RecordingHead head = io::read_recording_head(path);
    EXPECT_EQ(head.version, "1.2.3");
    EXPECT_EQ(head.isovalue, 76.5);
    EXPECT_EQ(run::recorded_source(head, path).from.index(), 1U) << "synthetic";
    EXPECT_THROW(io::read_recording_head(folder / "none.csv"), io::InputError);
    support::put_bytes(path, "t,x,y,z\n0,1,2,3\n");
    EXPECT_THROW(io::read_recording_head(path), io::InputError);
}

}  // namespace
}  // namespace palpate::run
