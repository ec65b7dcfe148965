// Rounds of a live session at the terminal.
#include "apps/palpate/run_terminal.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "apps/options/say.hpp"
#include "apps/palpate/live_status.hpp"

namespace palpate::app {

RunTerminal::RunTerminal(std::vector<LiveHand>& hands, const RunOptions& options, Remote* remote)
    : hands_(hands),
      told_(hands.size()),
      now_(hands.size()),
      remote_(remote),
      options_(options),
      line_(!options.source.quiet && ::isatty(STDERR_FILENO)) {
    if (keys_.available() && !options.source.quiet) note(LiveCommands::key_help());
}

RunTerminal::~RunTerminal() {
    if (line_) std::fputs("\r\033[K", stderr);
}

bool RunTerminal::update() {
    if (std::ranges::all_of(hands_, &LiveHand::has_failed)) return false;
    for (std::size_t i = 0; i < hands_.size(); ++i) now_[i] = hands_[i].run->snapshot();
    const bool all_begun =
        std::ranges::all_of(now_, [](const auto& now) { return now.has_value(); });
    if (!all_begun && std::ranges::none_of(hands_, &LiveHand::has_failed)) return true;
    // The first comes last, which has what is for none by itself: the end.
    for (std::size_t i = is_ending_ ? 0 : hands_.size(); i-- > 0;) {
        if (now_[i] && !obey_due(i)) return false;
    }
    if (now_.front() && !serve(*now_.front())) return false;
    if (const auto key = keys_.next(); key && !press(*key)) return false;
    ++rounds_;
    print_messages();
    for (std::size_t i = 0; i < hands_.size(); ++i) {
        if (now_[i]) watch_device(hands_[i], told_[i], now_[i]->session.device.status);
    }
    if (rounds_ % 25 == 0) watch_files();
    show_line();
    if (options_.unpaced) queue_.finish();  // what was asked for takes no time of the session
    is_ending_ = std::ranges::any_of(now_, [this](const auto& now) {
        return now && options_.seconds > 0 && now->session.tick.time >= options_.seconds;
    });
    if (are_all_over()) return false;
    return !is_ending_ || is_any_waiting();  // what came before the end is felt, and recorded
}

std::string RunTerminal::finish() {
    queue_.finish();
    queue_.end();  // after Ctrl-C a volume may still be written, or fail to be
    print_messages();
    watch_files();
    tell_what_was_left_out();
    return queue_.problem();
}

void RunTerminal::note(const std::string& text) const {
    say("{}{}\n", line_ ? "\r\033[K" : "", text);
}

/// As they were in this round.
bool RunTerminal::are_all_over() const {
    for (std::size_t i = 0; i < hands_.size(); ++i) {
        const bool finished = now_[i] && now_[i]->session.device.status == DeviceStatus::finished;
        if (!finished && !hands_[i].has_failed()) return false;
    }
    return true;
}

/// Time of a hand's session [s]. If its device has failed, the time of the other hands counts.
double RunTerminal::time_of(std::size_t hand) const {
    if (!hands_[hand].has_failed()) return now_[hand]->session.tick.time;
    double time = 0;
    for (const auto& now : now_) time = std::max(time, now ? now->session.tick.time : 0);
    return time;
}

bool RunTerminal::is_any_waiting() const {
    return std::ranges::any_of(
        hands_, [](const LiveHand& hand) { return !hand.has_failed() && hand.run->waiting() > 0; });
}

/// Carries out the requests that are due, as far as there is room: the others wait for the next
/// rounds, in their order. False for one to end.
bool RunTerminal::obey_due(std::size_t number) {
    LiveHand& hand = hands_[number];
    const double time = time_of(number);
    for (; hand.is_due(hand.next, time); ++hand.next) {
        const Request& request = hand.requests[hand.next].request;
        const bool ends = std::holds_alternative<Quit>(request);
        if (ends && is_any_waiting()) return true;  // first what came before
        const Obeyed obeyed = obey(request, hand, *now_[number], true);
        if (obeyed == Obeyed::quit) return false;
        if (obeyed == Obeyed::yes) continue;
        // Once, however many rounds they wait.
        if (std::exchange(told_[number].some_wait, true)) return true;
        note(fmt::format(
            "{} commands are due, more than fit into one tick: carried out in order, late",
            hand.left_over(time)));
        return true;
    }
    return true;
}

/// Carries out requests of other programs. False if one of them is another volume.
bool RunTerminal::serve(const Snapshot& now) {
    if (!remote_) return true;
    for (const std::string& text : remote_->notes()) note(text);
    LiveHand& hand = hands_.front();
    return remote_->serve(*hand.run, now, hand.commands, queue_,
                          [&](const Request& request) { carry_out(request, hand, now); });
}

/// For every hand, but what is done once for the first; false for the key that ends the session.
bool RunTerminal::press(char key) {
    for (std::size_t i = 0; i < hands_.size(); ++i) {
        LiveHand& hand = hands_[i];
        if (!now_[i]) continue;
        const auto request = hand.commands.from_key(key, *now_[i]);
        if (!request || (i > 0 && !std::holds_alternative<Command>(*request))) continue;
        const Obeyed obeyed = obey(*request, hand, *now_[i]);
        if (obeyed == Obeyed::quit) return false;
        if (obeyed == Obeyed::no_room) note("too many commands at once: one was left out");
    }
    return true;
}

/// Throws std::invalid_argument, and run::QueueFull.
void RunTerminal::carry_out(const Request& request, LiveHand& hand, const Snapshot& now,
                            bool is_scripted) {
    const Overloaded how{
        [](Quit) {},
        [&](Help) { note(LiveCommands::key_help()); },
        [&](const DataRequest& data) {
            const double isovalue = now.session.tick.proxy.isovalue;
            const auto work = [&run = *hand.run, data, isovalue](const std::stop_token& stop) {
                const auto until_stop = [&stop](double) {
                    if (stop.stop_requested()) throw io::Cancelled{};
                };
                return data(run.data(), run.field_now(), isovalue, until_stop);
            };
            queue_.put(work, is_scripted);
        },
        [&](const Command& command) { hand.run->send(command); },
    };
    std::visit(how, request);
}

RunTerminal::Obeyed RunTerminal::obey(const Request& request, LiveHand& hand, const Snapshot& now,
                                      bool is_scripted) {
    try {
        carry_out(request, hand, now, is_scripted);
    } catch (const run::QueueFull&) {
        return Obeyed::no_room;
    } catch (const std::invalid_argument& e) {
        note(e.what());
    }
    return std::holds_alternative<Quit>(request) ? Obeyed::quit : Obeyed::yes;
}

/// After the end. What follows `quit` was not to be carried out.
void RunTerminal::tell_what_was_left_out() const {
    std::size_t left = 0;
    std::int64_t unfelt = 0;
    for (const LiveHand& hand : hands_) {
        unfelt += hand.run->waiting();
        const std::size_t next = hand.next;
        const bool quits = next < hand.requests.size() &&
                           std::holds_alternative<Quit>(hand.requests[next].request);
        if (!quits && !interrupted()) left += hand.requests.size() - next;
    }
    if (left > 0) {
        note(fmt::format("{} not carried out before the end",
                         left == 1 ? "1 command was" : fmt::format("{} commands were", left)));
    }
    if (unfelt > 0) {
        note(fmt::format(
            "{} not felt before the end: a recording does not have {}",
            unfelt == 1 ? "the last change was" : fmt::format("the last {} changes were", unfelt),
            unfelt == 1 ? "it" : "them"));
    }
}

/// Reports when the status of the device changes, or its problem.
void RunTerminal::watch_device(const LiveHand& hand, Told& told, DeviceStatus status) {
    const bool changed = told.status != status;
    if (!changed && rounds_ % 50 != 0) return;
    const std::string problem = hand.run->device_problem();
    if (!changed && problem == told.problem) return;
    told.status = status;
    told.problem = problem;
    if (options_.source.quiet || status == DeviceStatus::finished) return;
    const bool go_on = hand.has_failed() && hands_.size() > 1;
    note(fmt::format("{}: {}{}{}{}", hand.name, name_of(status), problem.empty() ? "" : ": ",
                     problem, go_on ? "; the session continues without it" : ""));
}

void RunTerminal::print_messages() {
    for (const RequestQueue::Message& message : queue_.messages()) {
        if (message.is_problem || !options_.source.quiet) note(message.text);
    }
}

/// Reports problems of data and recording when they are new.
void RunTerminal::watch_files() {
    const auto tell = [&](std::string& told, const std::string& problem) {
        if (std::exchange(told, problem) != problem && !problem.empty()) {
            note("palpate: " + problem);
        }
    };
    tell(data_problem_, first().data().problem());
    if (first().recording()) tell(recording_problem_, first().recording()->problem());
}

/// The hands share its columns.
void RunTerminal::show_line() {
    if (!line_ || rounds_ % 20 != 0) return;
    std::string line;
    for (std::size_t i = 0; i < hands_.size(); ++i) {
        if (!now_[i]) continue;
        const run::Run& run = *hands_[i].run;
        if (i > 0) line += " | ";
        line += status_line(*now_[i], run.settings().layers.get(), run.report(),
                            terminal_columns() / hands_.size() - (i > 0 ? 3 : 1));
    }
    say("\r\033[K{}", line);
}

}  // namespace palpate::app
