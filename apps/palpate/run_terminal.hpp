// The terminal of a live session: commands from a file, keys, notes, the status line.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/options/run_options.hpp"
#include "apps/palpate/live_hands.hpp"
#include "apps/palpate/remote.hpp"
#include "apps/palpate/request_queue.hpp"
#include "apps/palpate/terminal.hpp"

namespace palpate::app {

class RunTerminal {
  public:
    /// `remote` may be null; it shows and changes the first hand. All that is given outlives this.
    RunTerminal(std::vector<LiveHand>& hands, const RunOptions& options, Remote* remote);
    ~RunTerminal();
    RunTerminal(const RunTerminal&) = delete;
    RunTerminal& operator=(const RunTerminal&) = delete;

    /// One round, every 10 ms of the session; false once the session is to end.
    bool update();
    /// Waits for the requests so far, except after Ctrl-C. Returns RequestQueue::problem().
    std::string finish();

  private:
    /// What became of a request.
    enum class Obeyed : std::uint8_t { yes, no_room, quit };
    /// What the person was told of a hand.
    struct Told {
        std::optional<DeviceStatus> status = {};
        std::string problem = {};
        bool some_wait = false;
    };

    run::Run& first() const { return *hands_.front().run; }
    void note(const std::string& text) const;
    bool are_all_over() const;
    double time_of(std::size_t hand) const;
    bool is_any_waiting() const;
    bool obey_due(std::size_t number);
    bool serve(const Snapshot& now);
    bool press(char key);
    void carry_out(const Request& request, LiveHand& hand, const Snapshot& now,
                   bool is_scripted = false);
    Obeyed obey(const Request& request, LiveHand& hand, const Snapshot& now,
                bool is_scripted = false);
    void tell_what_was_left_out() const;
    void watch_device(const LiveHand& hand, Told& told, DeviceStatus status);
    void print_messages();
    void watch_files();
    void show_line();

    std::vector<LiveHand>& hands_;
    std::vector<Told> told_;  // of each hand
    std::vector<std::optional<Snapshot>> now_;
    Remote* remote_;
    RequestQueue queue_;
    bool is_ending_ = false;  // the time of the session is over
    const RunOptions& options_;
    Keys keys_;
    std::string data_problem_, recording_problem_;  // as told
    bool line_;
    int rounds_ = 0;
};

}  // namespace palpate::app
