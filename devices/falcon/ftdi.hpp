// The part of libftdi 1 that is used here, declared anew: its constants, and its functions as
// pointers into the library, which is opened at run time. And an open Falcon behind it.
#pragma once

#include <string>

#include "devices/vendor_library.hpp"

namespace palpate::devices::falcon {

// Each constant has its name in ftdi.h beside it: docs/devices/interfaces.md lists them, and a test
// compares.
constexpr int eight_bits = 8;       // BITS_8
constexpr int one_stop_bit = 0;     // STOP_BIT_1
constexpr int no_parity = 0;        // NONE
constexpr int no_flow_control = 0;  // SIO_DISABLE_FLOW_CTRL

VendorWords words();

/// The functions. Negative results are errors, which error_text() explains. Reading returns what
/// has arrived, after one latency time at most if that is nothing.
struct Ftdi {
    /// Opens `path`; if that is empty, libftdi1.so.2 where the loader finds it. Throws DeviceError.
    explicit Ftdi(const std::string& path);

    VendorLibrary library;

    void* (*make)();
    void (*free)(void* context);
    int (*find_all)(void* context, void** list, int vendor, int product);
    void (*free_list)(void** list);
    int (*open)(void* context, int vendor, int product, const char* description, const char* serial,
                unsigned int index);
    int (*close)(void* context);
    int (*reset)(void* context);
    int (*set_baud_rate)(void* context, int rate);
    int (*set_line)(void* context, int bits, int stop_bits, int parity);
    int (*set_flow_control)(void* context, int kind);
    int (*set_dtr)(void* context, int on);
    int (*set_rts)(void* context, int on);
    int (*set_latency)(void* context, unsigned char ms);
    int (*read)(void* context, unsigned char* bytes, int size);
    int (*write)(void* context, const unsigned char* bytes, int size);
    const char* (*error_text)(void* context);

    /// Falcons that are plugged in; below 0 where the bus cannot be asked.
    int count() const;
};

}  // namespace palpate::devices::falcon
