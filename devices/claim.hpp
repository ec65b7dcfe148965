// A physical device serves one hand of a process.
#pragma once

#include <string>

namespace palpate::devices {

/// While it exists, the devices that this thread opens are those of `hand`. A hand may open its
/// device again before it closes the first one, as when its options change.
class OpenedBy {
  public:
    explicit OpenedBy(const void* hand);
    ~OpenedBy();
    OpenedBy(const OpenedBy&) = delete;
    OpenedBy& operator=(const OpenedBy&) = delete;
};

/// Keeps a device from other hands until its end. Any thread may make one.
class Claim {
  public:
    /// `device` tells it from all others of the backend, as in "Inverse3 049D at 127.0.0.1".
    /// Throws DeviceError if another hand has it.
    explicit Claim(std::string device);
    ~Claim();
    Claim(const Claim&) = delete;
    Claim& operator=(const Claim&) = delete;

    const std::string& device() const { return device_; }

  private:
    std::string device_;
};

}  // namespace palpate::devices
