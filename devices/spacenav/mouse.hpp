// An open 3D mouse: a connection to spacenavd, and a thread that moves the hand.
#pragma once

#include <array>
#include <atomic>
#include <string>
#include <string_view>
#include <vector>

#include "devices/linked_device.hpp"
#include "devices/spacenav/puck.hpp"
#include "devices/spacenav/socket.hpp"

namespace palpate::devices::spacenav {

class Mouse final : public LinkedDevice {
  public:
    /// `socket` is connected to `path`. All `paths` are tried when the connection breaks.
    Mouse(Socket socket, const std::string& path, std::vector<std::string> paths, const Feel& feel,
          double rate, const Timing& timing = {});
    ~Mouse() override;

    /// Takes the events that have come, moves the hand and reports its pose: 1000 times a second,
    /// and when there are events. Connects again, every 250 ms at most. Never waits.
    void step() override;

    DeviceInfo info() const override { return info_; }
    std::string problem() const override;
    bool is_stopping() const noexcept override { return false; }  // it has no force

  private:
    static constexpr std::int64_t period = 1'000'000;  // [ns]

    // Called by the thread only.
    void wait() override { socket_.wait_until(timing_.now() + period); }
    void take_events();
    bool reconnect();
    void ask_for_protocol_1();
    void report(std::int64_t now) noexcept;

    const std::vector<std::string> paths_;
    const Feel feel_;
    DeviceInfo info_;
    std::atomic<bool> connected_{true}, unplugged_{false};

    // Used by the thread only.
    Socket socket_;
    EventReader events_;
    Hand hand_;
    std::int64_t stepped_;           // [ns] the last time
    std::int64_t next_attempt_ = 0;  // [ns] to connect again
};

/// Connects to the first that works and says which. Throws DeviceError.
std::string connect_to_any(Socket& socket, const std::vector<std::string>& paths);

}  // namespace palpate::devices::spacenav
