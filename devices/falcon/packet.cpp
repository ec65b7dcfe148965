// Writes and reads packets: '<', three numbers of four nibbles with the lowest first, a byte of
// bits, a byte without meaning, '>'. All but the brackets are counted from 'A'.
#include "devices/falcon/packet.hpp"

#include <algorithm>

namespace palpate::devices::falcon {
namespace {

constexpr unsigned char zero = 0x41;
constexpr std::size_t bits_at = 13;
// Bits in packets to and from the device.
constexpr unsigned homing_bit = 1;
constexpr unsigned homed_shift = 4;

Packet packet_of(const std::array<int, 3>& numbers, unsigned bits) {
    Packet packet;
    packet.fill(zero);
    packet.front() = '<';
    packet.back() = '>';
    std::size_t at = 1;
    for (const int number : numbers) {
        const auto word = static_cast<unsigned>(std::clamp(number, -32768, 32767)) & 0xFFFFU;
        for (unsigned shift = 0; shift < 16; shift += 4) {
            packet[at++] = static_cast<unsigned char>(zero + ((word >> shift) & 0xFU));
        }
    }
    packet[bits_at] = static_cast<unsigned char>(zero + bits);
    return packet;
}

/// Returns nothing for bytes that no device sends.
std::optional<FromDevice> answer_of(const Packet& packet) {
    FromDevice answer;
    std::size_t at = 1;
    for (int& number : answer.encoders) {
        unsigned word = 0;
        for (unsigned shift = 0; shift < 16; shift += 4, ++at) {
            const unsigned nibble = packet[at] - unsigned{zero};  // wraps below it
            if (nibble > 0xF) return std::nullopt;
            word |= nibble << shift;
        }
        number = static_cast<std::int16_t>(word);
    }
    const unsigned bits = packet[bits_at] - unsigned{zero};
    if (bits > 0x7F) return std::nullopt;
    answer.buttons = bits & 0xFU;
    answer.homed = bits >> homed_shift;
    return answer;
}

}  // namespace

Packet packed(const ToDevice& message) {
    return packet_of(message.motors, message.lights | (message.homes ? homing_bit : 0));
}

Packet packed(const FromDevice& message) {
    return packet_of(message.encoders, message.buttons | (message.homed << homed_shift));
}

std::optional<FromDevice> Answers::take(std::span<const unsigned char> bytes) {
    std::optional<FromDevice> newest;
    for (const unsigned char byte : bytes) {
        if (byte == '<') count_ = 0;  // in no other place of a packet
        if (count_ == 0 && byte != '<') continue;
        begun_[count_++] = byte;
        if (byte == '>' || count_ == packet_size) {
            if (byte == '>' && count_ == packet_size) {
                if (const auto answer = answer_of(begun_)) newest = answer;
            }
            count_ = 0;
        }
    }
    return newest;
}

}  // namespace palpate::devices::falcon
