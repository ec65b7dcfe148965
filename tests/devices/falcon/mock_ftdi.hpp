// The state of a stand-in for libftdi1.so.2 with a Falcon behind it, for tests to set and to read.
// They find it by the function mock_ftdi().
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "devices/stand_in.hpp"

namespace palpate::support {

struct MockFtdiState {
    // The device.
    int count = 1;
    std::size_t firmware_size = 0;  // of the one that it takes; 0: it has one
    std::array<int, 3> encoders{};
    unsigned buttons = 0;
    bool is_homed = true;

    // How it misbehaves.
    bool refuses_open = false;
    bool is_unplugged = false;  // every call fails
    int silent_packets = 0;     // that it does not answer
    int answers_after = 0;      // so many empty reads
    std::string noise;          // before each answer
    int failing_loads = 0;      // that send a byte back wrong
    bool loader_is_dead = false;
    int split = 0;  // most bytes of a read; 0: any

    // Called without the lock by a read that brings nothing: its latency [ms] passes there.
    std::function<void(int)> while_waiting;
    // The same by ftdi_usb_open_desc_index.
    std::function<void()> while_opening;

    // What it saw.
    std::array<int, 3> motors{};
    int largest_motor = 0;
    unsigned lights = 0;
    long packets = 0;
    int bad_packets = 0;  // that no Falcon understands
    int loads = 0, opens = 0;
    int contexts = 0;  // that were made and not freed
};

using MockFtdi = StandIn<MockFtdiState>;

}  // namespace palpate::support

/// The stand-in's one and only.
extern "C" palpate::support::MockFtdi* mock_ftdi();
