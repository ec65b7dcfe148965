// The Falcon's packets, and finding them in a stream.
#include "devices/falcon/packet.hpp"

#include <gtest/gtest.h>

#include <string>

#include "support/random.hpp"

namespace palpate::devices::falcon {
namespace {

using support::Random;

std::string text(const Packet& packet) {
    return {packet.begin(), packet.end()};
}
std::optional<FromDevice> taken(Answers& answers, const std::string& bytes) {
    return answers.take({reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()});
}

FromDevice any_answer(Random& random) {
    FromDevice answer;
    for (int& encoder : answer.encoders) encoder = random.below(65536) - 32768;
    answer.buttons = static_cast<unsigned>(random.below(16));
    answer.homed = static_cast<unsigned>(random.below(8));
    return answer;
}

TEST(FalconPacket, is_written_as_the_device_reads_it) {
    EXPECT_EQ(text(packed(ToDevice{})), "<AAAAAAAAAAAAAA>");
    EXPECT_EQ(text(packed(ToDevice{{-1447, 1, -1}, green, false})), "<JFKPBAAAPPPPEA>");
    EXPECT_EQ(text(packed(ToDevice{{100'000, -100'000, 0}, red, true})), "<PPPHAAAIAAAADA>");
}

TEST(FalconPacket, comes_back_as_it_was_sent) {
    Random random(1);
    for (int i = 0; i < 2000; ++i) {
        const FromDevice answer = any_answer(random);
        Answers answers;
        ASSERT_EQ(taken(answers, text(packed(answer))), answer);
    }
}

TEST(FalconPacket, is_found_in_pieces_and_among_anything_else) {
    Random random(2);
    Answers answers;
    int found = 0;
    for (int i = 0; i < 2000; ++i) {
        const FromDevice answer = any_answer(random);
        std::string bytes;
        for (int k = random.below(20); k > 0; --k) bytes += static_cast<char>(random.below(256));
        if (random.chance(0.3)) bytes += text(packed(any_answer(random))).substr(0, 9);
        bytes += text(packed(answer));
        std::optional<FromDevice> last;
        while (!bytes.empty()) {
            const auto size = static_cast<std::size_t>(1 + random.below(7));
            if (const auto now = taken(answers, bytes.substr(0, size))) last = now;
            bytes.erase(0, size);
        }
        found += last == answer;
    }
    EXPECT_EQ(found, 2000);
}

TEST(FalconPacket, the_newest_of_several_counts_and_a_damaged_one_does_not) {
    Random random(3);
    const FromDevice one = any_answer(random), other = any_answer(random);
    Answers answers;
    EXPECT_EQ(taken(answers, text(packed(one)) + text(packed(other))), other);
    std::string damaged = text(packed(other));
    damaged[5] = 'Z';
    EXPECT_EQ(taken(answers, text(packed(one)) + damaged), one);
    EXPECT_EQ(taken(answers, damaged), std::nullopt);
    EXPECT_EQ(taken(answers, text(packed(one)).substr(0, 15)), std::nullopt);
    EXPECT_EQ(taken(answers, ">"), one);
}

}  // namespace
}  // namespace palpate::devices::falcon
