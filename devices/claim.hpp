// A physical device serves one hand of a process, and is open once.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>

namespace palpate::devices {

/// While it exists, the devices that this thread opens are those of `hand`.
class OpenedBy {
  public:
    /// `close` closes the device that the hand has. It is called before that device is opened
    /// again, as when its options change: drivers have one handle per device.
    OpenedBy(const void* hand, std::function<void()> close);
    ~OpenedBy();
    OpenedBy(const OpenedBy&) = delete;
    OpenedBy& operator=(const OpenedBy&) = delete;

  private:
    friend class Claim;
    friend const void* opening_hand();
    const void* hand_;
    std::function<void()> close_;
};

/// That which this thread opens devices for; null: none that is known.
const void* opening_hand();

/// Keeps a device from other hands until its end. Any thread may make one.
class Claim {
  public:
    /// `device` tells it from all others of the backend, as in "Inverse3 049D at 127.0.0.1".
    /// Throws DeviceError if another hand has it, or if leave() was called for it.
    explicit Claim(std::string device, const void* hand = opening_hand());
    ~Claim();
    Claim(Claim&& other) noexcept
        : device_(std::exchange(other.device_, {})), number_(other.number_) {}
    Claim& operator=(Claim&&) = delete;

    /// For a device that cannot be closed when its hand goes, or whose opening was stopped before
    /// its driver returned: no hand has it until this ends.
    void leave() const { leaving()(); }
    /// leave() as a function that may be called later, by any thread, also after the end of this.
    std::function<void()> leaving() const;

    const std::string& device() const { return device_; }

  private:
    std::string device_;  // empty: moved away
    std::uint64_t number_ = 0;
};

}  // namespace palpate::devices
