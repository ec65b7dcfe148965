// The connection of a page's device: a WebSocket of JavaScript (Line in line.js) as a Channel.
#pragma once

#include <emscripten/val.h>

#include <string>

#include "devices/haply/socket.hpp"

namespace palpate::web {

class PageChannel final : public devices::haply::Channel {
  public:
    explicit PageChannel(emscripten::val line) : line_(std::move(line)) {}

    // None of these waits: a page's events arrive between ticks only.
    bool connect(const devices::haply::Address& address,
                 devices::haply::Clock::time_point deadline) override;
    bool send(std::string_view message, devices::haply::Clock::time_point deadline) override;
    devices::haply::Received receive(devices::haply::Clock::time_point deadline) override;
    void close(devices::haply::Clock::time_point deadline) override;
    void drop() noexcept override;
    const std::string& error() const override { return error_; }

  private:
    emscripten::val line_;
    std::string message_, error_;
};

}  // namespace palpate::web
