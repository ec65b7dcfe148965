// Requests to a live run by OpenIGTLink, carried out by the run's own thread.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/palpate/live_commands.hpp"
#include "apps/palpate/request_queue.hpp"
#include "bridge/bridge.hpp"
#include "palpate/run/run.hpp"

namespace palpate::app {

class Remote {
  public:
    explicit Remote(const bridge::Settings& settings) : bridge_(settings) {}

    int port() const { return bridge_.port(); }
    std::vector<std::string> notes() { return bridge_.notes(); }

    /// One round: shows the state to all, carries out what they asked for. `carry_out` may throw
    /// std::invalid_argument, which is what the peer is told. Surfaces are made in `queue`. False
    /// when the run has to end for another volume: take_pushed().
    bool serve(run::Run& run, const Snapshot& now, LiveCommands& commands, RequestQueue& queue,
               const std::function<void(const Request&)>& carry_out);
    /// The volume to go on with; null: none.
    std::shared_ptr<run::Data> take_pushed() { return std::exchange(pushed_, nullptr); }

  private:
    void answer(run::Run& run, const Snapshot& now, LiveCommands& commands, RequestQueue& queue,
                const std::function<void(const Request&)>& carry_out, bridge::Request& asked);
    void send_surface(const run::Run& run, const Snapshot& now, RequestQueue& queue, int peer);
    std::string take_volume(run::Run& run, bridge::VolumePushed& volume);

    bridge::Bridge bridge_;
    std::shared_ptr<run::Data> pushed_;
    std::atomic<bool> surface_under_way_{false};
};

/// By the options --igtl and --igtl-connect; null if both are empty. Warns on standard error of an
/// address that other machines reach, and tells the port unless `quiet`. Throws
/// std::invalid_argument.
std::unique_ptr<Remote> make_remote(const std::string& listen, const std::string& connect,
                                    bool quiet);

/// The request in these words, if strangers may ask for it: nothing that reads or writes files,
/// ends the run or switches forces on. Throws std::invalid_argument.
Request remote_request(LiveCommands& commands, const std::string& words);

}  // namespace palpate::app
