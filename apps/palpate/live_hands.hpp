// The hands of a live session on the command line: a run each, on the same data, and the requests
// to it.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/palpate/live_commands.hpp"
#include "palpate/run/run.hpp"

namespace palpate::app {

struct LiveHand {
    std::unique_ptr<run::Run> run;
    DeviceInfo device;      ///< as it was opened
    std::string name = {};  ///< "hand 2, device haply"; of the only hand "device haply"
    LiveCommands commands;  ///< words change its settings, which are its device's
    std::vector<TimedRequest> requests = {};
    std::size_t next = 0;  ///< of those

    bool has_failed() const { return run->device_failure() != DeviceFailure::none; }
    /// At this time of the session [s].
    bool is_due(std::size_t request, double time) const {
        return request < requests.size() && requests[request].time <= time;
    }
    /// Requests and commands that were due and are not carried out.
    std::int64_t left_over(double time) const;
};

/// Opens the devices, in this order. Throws as run::Run.
std::vector<LiveHand> open_hands(const std::shared_ptr<run::Data>& data,
                                 const std::vector<run::Setup>& setups);
/// Of each hand; see the function of one.
void read_commands(const std::string& path, std::vector<LiveHand>& hands);
/// The brush of all hands from the start, in the words of the command.
void take_up_brush(std::vector<LiveHand>& hands, const std::string& words);
/// On data with Pace::by_steps: moves all hands on by so many seconds of the session. Data that is
/// being read goes at its own pace.
void step(std::vector<LiveHand>& hands, double seconds);
/// Records all hands into one file.
void record(std::vector<LiveHand>& hands, const std::string& path);
/// The ticks of each hand; empty without a recording. Throws io::OutputError.
std::vector<std::int64_t> stop_recording(std::vector<LiveHand>& hands, const OnProgress& progress);
/// What is wrong with the devices that have failed; empty: none has.
std::string failure_of(const std::vector<LiveHand>& hands);

}  // namespace palpate::app
