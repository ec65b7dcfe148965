// The Falcon's serial line: its rates, its loader, its packets.
#include "devices/falcon/port.hpp"

#include <algorithm>
#include <array>

namespace palpate::devices::falcon {
namespace {

// [baud]
constexpr int rate_of_packets = 1'456'312;
constexpr int rate_of_greeting = 9'600;
constexpr int rate_of_loader = 140'000;
// [ms] in which the converter passes on what has arrived. Loading fails with the shorter one.
constexpr unsigned char latency_of_packets = 1;
constexpr unsigned char latency_of_loader = 16;
constexpr int waits_for_loader = 60;  // a second

constexpr std::array<unsigned char, 3> greeting{0x0a, 0x43, 0x0d};
constexpr std::size_t greeting_answer = 4;
constexpr std::array<unsigned char, 1> loader_call{0x41};
constexpr std::size_t loader_answer = 2;
constexpr std::size_t most_at_once = 8 * packet_size;
constexpr std::size_t block = 62;  // of a USB packet of 64 bytes, two are the converter's

}  // namespace

Port::Port(const Ftdi& ftdi, unsigned int index) : ftdi_(ftdi), context_(ftdi.make()) {
    if (!context_) throw PortError("libftdi gives no context");
    try {
        check(ftdi_.open(context_, vendor_id, product_id, nullptr, nullptr, index), "opening it");
        use_packets();
    } catch (...) {
        ftdi_.free(context_);
        throw;
    }
}

Port::~Port() {
    ftdi_.close(context_);
    ftdi_.free(context_);
}

void Port::check(int result, const char* step) const {
    if (result >= 0) return;
    const char* text = ftdi_.error_text(context_);
    throw PortError(std::string(step) + ": " + (text && *text ? text : "unknown error") + " (" +
                    std::to_string(result) + ")");
}

void Port::use_packets() {
    check(ftdi_.set_latency(context_, latency_of_packets), "setting its latency");
    check(ftdi_.set_baud_rate(context_, rate_of_packets), "setting its rate");
}

void Port::write(std::span<const unsigned char> bytes) {
    const int written = ftdi_.write(context_, bytes.data(), static_cast<int>(bytes.size()));
    check(written, "writing");
    if (static_cast<std::size_t>(written) != bytes.size()) {
        throw PortError("writing: the device takes no more");
    }
}

std::vector<unsigned char> Port::read(std::size_t size, int most_waits) {
    std::vector<unsigned char> bytes(size);
    std::size_t count = 0;
    for (int waits = 0; count < size && waits < most_waits;) {
        const int got = ftdi_.read(context_, bytes.data() + count, static_cast<int>(size - count));
        check(got, "reading");
        count += static_cast<std::size_t>(std::min<int>(got, static_cast<int>(size - count)));
        if (got == 0) ++waits;
    }
    bytes.resize(count);
    return bytes;
}

/// Taken for the answer to the next packet, it would make every later reading a packet old.
void Port::forget_late_answer() {
    std::array<unsigned char, most_at_once> bytes{};
    for (std::size_t count = 0; count < most_at_once;) {  // noise must not hold it up
        const int got = ftdi_.read(context_, bytes.data(), static_cast<int>(bytes.size()));
        check(got, "reading");
        if (got == 0) break;
        count += static_cast<std::size_t>(got);
    }
    answers_ = {};
}

std::optional<FromDevice> Port::exchange(const ToDevice& message, int most_waits) {
    if (!is_answered_) forget_late_answer();
    is_answered_ = false;
    write(packed(message));
    // More than one packet may have come since the last reading: the newest counts.
    std::array<unsigned char, most_at_once> bytes{};
    std::size_t count = 0;
    for (int waits = 0; waits < most_waits;) {
        const int got = ftdi_.read(context_, bytes.data(), static_cast<int>(bytes.size()));
        check(got, "reading");
        const auto size = std::min(static_cast<std::size_t>(got), bytes.size());
        if (const auto answer = answers_.take(std::span(bytes).first(size))) {
            is_answered_ = true;
            return answer;
        }
        count += size;
        if (size == 0 || count > most_at_once) ++waits;  // noise must not hold it up
    }
    return std::nullopt;
}

bool Port::starts_loader() {
    check(ftdi_.reset(context_), "resetting it");
    check(ftdi_.set_latency(context_, latency_of_loader), "setting its latency");
    check(ftdi_.set_baud_rate(context_, rate_of_greeting), "setting its rate");
    check(ftdi_.set_line(context_, eight_bits, one_stop_bit, no_parity), "setting its line");
    check(ftdi_.set_flow_control(context_, no_flow_control), "setting its flow control");
    check(ftdi_.set_rts(context_, 0), "setting RTS");
    check(ftdi_.set_dtr(context_, 0), "setting DTR");
    check(ftdi_.set_dtr(context_, 1), "setting DTR");
    write(greeting);
    if (read(greeting_answer, waits_for_loader).size() < greeting_answer) return false;
    check(ftdi_.set_dtr(context_, 0), "setting DTR");
    check(ftdi_.set_baud_rate(context_, rate_of_loader), "setting its rate");
    write(loader_call);
    return read(loader_answer, waits_for_loader).size() == loader_answer;
}

std::string Port::load(std::span<const unsigned char> firmware) {
    std::string wrong;
    if (!starts_loader()) wrong = "its loader does not answer";
    for (std::size_t at = 0; wrong.empty() && at < firmware.size(); at += block) {
        const auto part = firmware.subspan(at, std::min(block, firmware.size() - at));
        write(part);
        if (!std::ranges::equal(read(part.size(), waits_for_loader), part)) {
            wrong = "byte " + std::to_string(at) + " or one of the next came back wrong";
        }
    }
    use_packets();
    return wrong;
}

}  // namespace palpate::devices::falcon
