// Opens, steps and records the hands of a live session.
#include "apps/palpate/live_hands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "apps/palpate/commands.hpp"

namespace palpate::app {

std::int64_t LiveHand::left_over(double time) const {
    std::size_t end = next;
    while (is_due(end, time)) ++end;
    return static_cast<std::int64_t>(end - next) + run->waiting();
}

std::vector<LiveHand> open_hands(const std::shared_ptr<run::Data>& data,
                                 const std::vector<run::Setup>& setups) {
    std::vector<LiveHand> hands;
    for (const run::Setup& setup : setups) {
        auto run = std::make_unique<run::Run>(data, setup, stop_if_interrupted);
        const DeviceInfo device = run->device();
        LiveCommands commands(*run);
        std::string name = "device " + device.name;
        if (setups.size() > 1) name = fmt::format("hand {}, {}", hands.size() + 1, name);
        hands.push_back({.run = std::move(run),
                         .device = device,
                         .name = std::move(name),
                         .commands = std::move(commands)});
    }
    return hands;
}

void read_commands(const std::string& path, std::vector<LiveHand>& hands) {
    const int count = static_cast<int>(hands.size());
    for (int i = 0; i < count; ++i) {
        LiveHand& hand = hands[static_cast<std::size_t>(i)];
        hand.requests = read_commands(path, hand.commands, {.number = i + 1, .count = count});
    }
}

void take_up_brush(std::vector<LiveHand>& hands, const std::string& words) {
    for (LiveHand& hand : hands) {
        const Request brush = hand.commands.from_words("brush " + words);
        std::get<DataRequest>(brush)(hand.run->data(), hand.run->field(), hand.run->isovalue(), {});
    }
}

void step(std::vector<LiveHand>& hands, double seconds) {
    std::vector<double> passed(hands.size());
    while (true) {
        const auto least = std::ranges::min_element(passed);
        if (*least >= seconds - 1e-9) return;
        run::Run& run = *hands[static_cast<std::size_t>(least - passed.begin())].run;
        if (!run.data().is_settled()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        run.step();
        *least += run.period();
    }
}

void record(std::vector<LiveHand>& hands, const std::string& path) {
    std::vector<run::Run*> runs;
    for (LiveHand& hand : hands) runs.push_back(hand.run.get());
    run::Run::record_together(runs, path, stop_if_interrupted);
}

std::vector<std::int64_t> stop_recording(std::vector<LiveHand>& hands, const OnProgress& progress) {
    std::vector<std::int64_t> ticks;
    for (LiveHand& hand : hands) {
        if (hand.run->recording()) ticks.push_back(hand.run->stop_recording(progress));
    }
    return ticks;
}

std::string failure_of(const std::vector<LiveHand>& hands) {
    std::string failures;
    for (const LiveHand& hand : hands) {
        if (!hand.has_failed()) continue;
        if (!failures.empty()) failures += "; ";
        failures += hand.name + ": " + hand.run->device_problem();
    }
    return failures;
}

}  // namespace palpate::app
