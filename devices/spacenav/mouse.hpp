// An open 3D mouse: a connection to spacenavd, and a thread that moves the hand.
#pragma once

#include <array>
#include <atomic>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "devices/link.hpp"
#include "devices/spacenav/puck.hpp"
#include "devices/spacenav/socket.hpp"

namespace palpate::devices::spacenav {

class Mouse final : public Device {
  public:
    /// `socket` is connected to `path`. All `paths` are tried when the connection breaks.
    Mouse(Socket socket, const std::string& path, std::vector<std::string> paths, const Feel& feel,
          double rate);
    ~Mouse() override;

    DeviceInfo info() const override { return info_; }
    std::string problem() const override;
    DeviceReading read(double) noexcept override { return link_.read(); }
    void write(const Wrench&, double) noexcept override {}
    void stop() noexcept override { link_.stop(); }

  private:
    // Called by the thread only.
    void run(Socket socket);
    void take_events(Socket& socket, EventReader& events);
    bool reconnect(Socket& socket) const;
    void report() noexcept;

    const std::vector<std::string> paths_;
    const Feel feel_;
    DeviceInfo info_;
    Link link_;
    std::atomic<bool> connected_{true}, quit_{false};
    Hand hand_;  // used by the thread only
    std::thread thread_;
};

/// Connects to the first that works and says which. Throws DeviceError.
std::string connect_to_any(Socket& socket, const std::vector<std::string>& paths);

}  // namespace palpate::devices::spacenav
