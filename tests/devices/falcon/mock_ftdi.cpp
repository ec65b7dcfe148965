// A stand-in for libftdi1.so.2 with one Falcon: its loader, which sends every byte back, and its
// firmware, which answers packets. Both only at their own rate.
#include "mock_ftdi.hpp"

#include <algorithm>
#include <cstdlib>
#include <deque>

namespace {

using palpate::support::MockFtdi;
using palpate::support::MockFtdiState;

constexpr int no_device = -4;

// The interface is one of globals: so is this.
MockFtdi mock;

/// The serial line as the converter is set, and what waits on it.
struct Line {
    int rate = 9600;
    int latency = 16;
    bool dtr = false;
    bool loads = false;      // the loader was called
    std::size_t loaded = 0;  // bytes of firmware
    bool came_back_wrong = false;
    std::deque<unsigned char> to_host;
    struct Later {
        int reads;  // empty ones, until then
        std::deque<unsigned char> bytes;
    };
    std::deque<Later> later;  // answers
} line;

void send(std::initializer_list<int> bytes) {
    for (const int byte : bytes) line.to_host.push_back(static_cast<unsigned char>(byte));
}

int number_at(const unsigned char* bytes) {
    int value = 0;
    for (int i = 3; i >= 0; --i) value = 16 * value + (bytes[i] - 'A');
    return value >= 32768 ? value - 65536 : value;
}

void answer_now() {
    for (const char c : mock.state.noise) line.to_host.push_back(static_cast<unsigned char>(c));
    send({'<'});
    for (const int encoder : mock.state.encoders) {
        const unsigned word = static_cast<unsigned>(encoder) & 0xFFFFU;
        for (int i = 0; i < 4; ++i) send({'A' + static_cast<int>((word >> (4 * i)) & 0xFU)});
    }
    const unsigned homed = mock.state.is_homed ? 7U << 4U : 0U;
    send({'A' + static_cast<int>(mock.state.buttons | homed), 'A', '>'});
}

void answer() {
    std::deque<unsigned char> before;
    before.swap(line.to_host);
    answer_now();
    before.swap(line.to_host);
    line.later.push_back({mock.state.answers_after, before});
}

/// Puts the bytes that are due on the line.
void arrive(int empty_reads) {
    for (auto& one : line.later) one.reads -= empty_reads;
    while (!line.later.empty() && line.later.front().reads <= 0) {
        const auto& bytes = line.later.front().bytes;
        line.to_host.insert(line.to_host.end(), bytes.begin(), bytes.end());
        line.later.pop_front();
    }
}

void take_packet(const unsigned char* bytes, int size) {
    const bool is_one = size == 16 && bytes[0] == '<' && bytes[15] == '>' &&
                        std::all_of(bytes + 1, bytes + 15, [](int b) { return b >= 'A'; });
    if (!is_one) {
        ++mock.state.bad_packets;
        return;
    }
    ++mock.state.packets;
    for (std::size_t i = 0; i < 3; ++i) {
        mock.state.motors[i] = number_at(bytes + 1 + 4 * i);
        mock.state.largest_motor =
            std::max(mock.state.largest_motor, std::abs(mock.state.motors[i]));
    }
    mock.state.lights = static_cast<unsigned>(bytes[13] - 'A') & 14U;
    if (mock.state.silent_packets > 0) {
        --mock.state.silent_packets;
    } else {
        answer();
    }
}

void take_firmware(const unsigned char* bytes, int size) {
    if (!line.loads) {
        line.loads = size == 1 && bytes[0] == 'A' && !line.dtr;
        if (line.loads) send({0x13, 0x41});
        return;
    }
    for (int i = 0; i < size; ++i, ++line.loaded) {
        const bool is_wrong = mock.state.failing_loads > 0 && line.loaded == 100;
        line.came_back_wrong |= is_wrong;
        send({is_wrong ? bytes[i] ^ 1 : bytes[i]});
    }
}

int result(bool is_good = true) {
    return mock.state.is_unplugged || !is_good ? no_device : 0;
}

}  // namespace

MOCK_EXPORT MockFtdi* mock_ftdi() {
    return &mock;
}

MOCK_EXPORT void* ftdi_new() {
    const std::lock_guard lock(mock.mutex);
    ++mock.state.contexts;
    return &mock;
}

MOCK_EXPORT void ftdi_free(void*) {
    const std::lock_guard lock(mock.mutex);
    --mock.state.contexts;
}

MOCK_EXPORT int ftdi_usb_find_all(void*, void** list, int vendor, int product) {
    const std::lock_guard lock(mock.mutex);
    *list = std::malloc(1);
    return vendor == 0x0403 && product == 0xcb48 ? mock.state.count : 0;
}

MOCK_EXPORT void ftdi_list_free(void** list) {
    std::free(*list);
    *list = nullptr;
}

MOCK_EXPORT int ftdi_usb_open_desc_index(void*, int, int, const char*, const char*,
                                         unsigned int index) {
    mock.meanwhile(&MockFtdiState::while_opening);
    const std::lock_guard lock(mock.mutex);
    ++mock.state.opens;
    line = {};
    return result(!mock.state.refuses_open && static_cast<int>(index) < mock.state.count);
}

MOCK_EXPORT int ftdi_usb_close(void*) {
    return 0;
}

MOCK_EXPORT int ftdi_usb_reset(void*) {
    const std::lock_guard lock(mock.mutex);
    line = {};
    return result();
}

MOCK_EXPORT int ftdi_set_baudrate(void*, int rate) {
    const std::lock_guard lock(mock.mutex);
    line.rate = rate;
    if (rate == 1'456'312 && line.loads) {
        ++mock.state.loads;
        if (line.loaded == mock.state.firmware_size && !line.came_back_wrong) {
            mock.state.firmware_size = 0;
        }
        if (line.came_back_wrong) --mock.state.failing_loads;
        line.loads = false;
    }
    return result();
}

MOCK_EXPORT int ftdi_set_line_property(void*, int bits, int stop_bits, int parity) {
    const std::lock_guard lock(mock.mutex);
    return result(bits == 8 && stop_bits == 0 && parity == 0);
}

MOCK_EXPORT int ftdi_setflowctrl(void*, int kind) {
    const std::lock_guard lock(mock.mutex);
    return result(kind == 0);
}

MOCK_EXPORT int ftdi_setdtr(void*, int on) {
    const std::lock_guard lock(mock.mutex);
    line.dtr = on != 0;
    return result();
}

#ifndef MOCK_FTDI_LACKS_RTS
MOCK_EXPORT int ftdi_setrts(void*, int) {
    const std::lock_guard lock(mock.mutex);
    return result();
}
#endif

MOCK_EXPORT int ftdi_set_latency_timer(void*, unsigned char ms) {
    const std::lock_guard lock(mock.mutex);
    line.latency = ms;
    return result();
}

MOCK_EXPORT int ftdi_read_data(void*, unsigned char* bytes, int size) {
    int latency = 0;
    {
        const std::lock_guard lock(mock.mutex);
        if (mock.state.is_unplugged) return no_device;
        arrive(0);
        if (!line.to_host.empty()) {
            const int most = mock.state.split > 0 ? std::min(size, mock.state.split) : size;
            const int got = std::min(most, static_cast<int>(line.to_host.size()));
            std::copy_n(line.to_host.begin(), got, bytes);
            line.to_host.erase(line.to_host.begin(), line.to_host.begin() + got);
            return got;
        }
        arrive(1);
        latency = line.latency;
    }
    mock.meanwhile(&MockFtdiState::while_waiting, latency);
    return 0;
}

MOCK_EXPORT int ftdi_write_data(void*, const unsigned char* bytes, int size) {
    const std::lock_guard lock(mock.mutex);
    if (mock.state.is_unplugged) {
        mock.state.motors = {};
        return no_device;
    }
    if (line.rate == 9600 && line.dtr && line.latency == 16 && !mock.state.loader_is_dead) {
        if (size == 3 && bytes[0] == 0x0a && bytes[1] == 0x43 && bytes[2] == 0x0d) {
            send({0x0a, 0x44, 0x2c, 0x0d});
        }
    } else if (line.rate == 140'000 && mock.state.firmware_size > 0) {
        take_firmware(bytes, size);
    } else if (line.rate == 1'456'312 && line.latency == 1 && mock.state.firmware_size == 0) {
        take_packet(bytes, size);
    }
    return size;
}

MOCK_EXPORT const char* ftdi_get_error_string(void*) {
    return "device disconnected";
}
