// A stand-in for Haply's Inverse Service in virtual time, without a socket and without a thread: it
// answers each message with one, well or badly.
#pragma once

#include <chrono>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "devices/haply/force_in.hpp"
#include "devices/haply/socket.hpp"
#include "support/virtual_time.hpp"

namespace palpate::support {

class FakeService {
  public:
    struct Reply {
        std::string text;
        bool binary = false;
    };
    /// One reply to a message, or none.
    using Answer = std::function<std::optional<Reply>(const std::string& message)>;

    // How it behaves from now on.
    void greet(std::string snapshot) { greeting_ = std::move(snapshot); }
    void answer(Answer answer) { answer_ = std::move(answer); }
    void answer(std::string text) {  ///< always this
        answer_ = [text = std::move(text)](const std::string&) { return Reply{text}; };
    }
    void delay(std::chrono::milliseconds late) { late_ = late; }  ///< every answer, in order
    void hang(bool on) { hangs_ = on; }      ///< neither reads nor writes nor shakes hands
    void mute(bool on) { mute_ = on; }       ///< reads, but answers nothing
    void refuse(bool on) { refuses_ = on; }  ///< no connections
    void drop() { open_ = false; }           ///< closes the connection

    // What it saw.
    const devices::haply::Address& address() const { return address_; }  ///< connected to last
    int connections() const { return connections_; }                     ///< that shook hands
    int attempts() const { return attempts_; }
    bool closed_politely() const { return closed_politely_; }
    std::size_t messages() const { return messages_; }
    const std::string& last_message() const { return last_message_; }
    /// Forces of all the commands, oldest first [N, service axes].
    const std::vector<Vec3>& forces() const { return forces_; }

    /// A connection to it, which must not outlive it. One at a time.
    std::unique_ptr<devices::haply::Channel> channel() { return std::make_unique<Channel>(*this); }

  private:
    using Clock = devices::haply::Clock;
    using Received = devices::haply::Received;

    static Clock::time_point now() {
        return Clock::time_point(std::chrono::nanoseconds(virtual_now()));
    }
    static void pass_to(Clock::time_point time) {
        pass_until(std::chrono::nanoseconds(time.time_since_epoch()).count());
    }

    struct Due {
        Clock::time_point at;
        Reply reply;
    };

    class Channel final : public devices::haply::Channel {
      public:
        explicit Channel(FakeService& service) : service_(service) {}

        bool connect(const devices::haply::Address& address, Clock::time_point deadline) override {
            error_ = service_.connect(address, deadline);
            return error_.empty();
        }
        bool send(std::string_view message, Clock::time_point) override {
            if (!service_.open_) return error_ = "it is gone", false;
            service_.unread_.emplace_back(message);
            service_.read_all();
            return true;
        }
        Received receive(Clock::time_point deadline) override {
            service_.read_all();
            if (!service_.open_)
                return error_ = "it is gone", Received{Received::What::closed, false, {}};
            std::deque<Due>& due = service_.due_;
            if (service_.hangs_ || due.empty() || due.front().at > deadline) {
                pass_to(deadline);
                return {};
            }
            pass_to(due.front().at);
            received_ = std::move(due.front().reply);
            due.pop_front();
            return {Received::What::message, received_.binary, received_.text};
        }
        void close(Clock::time_point deadline) override {
            if (service_.hangs_) pass_to(deadline);
            service_.closed_politely_ = service_.open_ && !service_.hangs_;
            service_.open_ = false;
        }
        void drop() noexcept override { service_.open_ = false; }
        const std::string& error() const override { return error_; }

      private:
        FakeService& service_;
        Reply received_;
        std::string error_;
    };

    std::string connect(const devices::haply::Address& address, Clock::time_point deadline) {
        address_ = address;
        open_ = false;
        ++attempts_;
        if (refuses_) return "it is not there";
        if (hangs_) {
            pass_to(deadline);
            return "it does not shake hands";
        }
        ++connections_;
        open_ = true;
        unread_.clear();
        due_.clear();
        if (!greeting_.empty()) due_.push_back({now(), {greeting_}});
        return {};
    }
    void read_all() {
        for (; !hangs_ && !unread_.empty(); unread_.pop_front()) {
            last_message_ = unread_.front();
            ++messages_;
            if (const auto force = force_in(last_message_)) forces_.push_back(*force);
            if (mute_ || !answer_) continue;
            if (auto reply = answer_(last_message_)) due_.push_back({now() + late_, *reply});
        }
    }

    std::string greeting_, last_message_;
    Answer answer_;
    std::chrono::milliseconds late_{0};
    bool hangs_ = false, mute_ = false, refuses_ = false, open_ = false, closed_politely_ = false;
    devices::haply::Address address_;
    int connections_ = 0, attempts_ = 0;
    std::size_t messages_ = 0;
    std::vector<Vec3> forces_;
    std::deque<std::string> unread_;
    std::deque<Due> due_;
};

}  // namespace palpate::support
