// Constructs runs on the thread of a task, and starts them on the window's.
#include "apps/viewer/window/connector.hpp"

#include <atomic>
#include <chrono>
#include <thread>
#include <utility>

#include "apps/viewer/scene/threads.hpp"
#include "devices/absent_device.hpp"

namespace palpate::viewer {
namespace {

/// For devices of runs that have ended, which may be those that are opened next.
constexpr std::chrono::seconds patience{2};

/// Of a device that is closed, to be opened again.
constexpr const char* problem_of_away =
    "it was closed, to be opened again: if that does not happen, choose it once more";

QString connecting_words(const devices::DeviceChoice& device) {
    return Connector::tr("Connecting to %1").arg(QString::fromStdString(run::text_of(device)));
}

/// The result of open(progress), which may take any time. Throws if a person has cancelled it.
template <class Open>
auto opened(const io::Progress& progress, const Open& open) {
    auto result = open([progress](double) { progress(0); });
    progress(0);
    return result;
}

}  // namespace

/// Hands that were opened. Those that nobody takes are closed without keeping a thread waiting.
struct Connector::Hands {
    explicit Hands(RunCloser& used) : closer(used) {}
    ~Hands() {
        std::vector<std::unique_ptr<run::Run>> runs;
        for (LiveHand& hand : all) {
            if (hand.run) runs.push_back(std::move(hand.run));
        }
        if (!runs.empty()) closer.close(std::move(runs));
    }
    Hands(const Hands&) = delete;
    Hands& operator=(const Hands&) = delete;

    RunCloser& closer;
    std::vector<LiveHand> all;
    std::exception_ptr error;  // why there are none, or not those that were wanted
};

/// A change of the device of one hand.
struct Connector::Change {
    explicit Change(RunCloser& closer) : next(closer) {}

    Hands next;
    std::shared_ptr<run::Data> data;
    run::Setup before, wanted;
    std::shared_ptr<const HandKey> key;
    DeviceInfo info;       // of the device before
    bool is_away = false;  // it was closed
    const std::shared_ptr<std::atomic<bool>> is_answered = std::make_shared<std::atomic<bool>>();
    std::atomic<bool> is_given_up{false};  // the task was cancelled
};

Connector::Connector(const Desk& desk) : Controller(desk), task_(messages_) {
    connect(&content_, &Content::runs_ended, this, &Connector::tell_ended);
    connect(&content_, &Content::closing, &task_, &BackgroundTask::abandon);
}

/// Says so if a force may still be on.
void Connector::tell_ended(const RunCloser::Ended& how) {
    if (!how.unanswered.empty()) messages_.show_problem(QString::fromStdString(how.unanswered));
}

void Connector::feel(std::shared_ptr<Opened> volume, std::vector<run::Setup> setups,
                     std::function<void()> then,
                     std::function<void(const std::exception_ptr&)> otherwise) {
    const auto result = std::make_shared<Hands>(content_.closer());
    const QString words = connecting_words(setups.front().device);
    content_.close();
    task_.start(
        words,
        [=](const io::Progress& progress) {
            result->closer.closes_within(patience, [&] { progress(0); });
            try {
                result->all = opened(progress, [&](const OnProgress& waits) {
                    return make_hands(*volume, setups, waits);
                });
            } catch (const std::exception&) {
                result->error = std::current_exception();
            }
        },
        [=, this] {
            if (result->error && otherwise) return otherwise(result->error);
            if (result->error) std::rethrow_exception(result->error);
            content_.start_run(volume, std::move(result->all));
            then();
        });
}

/// On the task's thread: the hand goes on with no device until its own is closed.
void Connector::take_away(const std::shared_ptr<Change>& change, const io::Progress& progress) {
    const auto take = [this, change] {
        run::Setup setup = change->before;
        setup.open_device = [info = change->info](const auto&, const auto&) {
            return std::make_unique<devices::AbsentDevice>(info, problem_of_away);
        };
        Hands away(content_.closer());
        away.all.push_back(LiveHand::with(change->data, setup, change->key, {}));
        content_.replace_hand(std::move(away.all.front()),
                              [answered = change->is_answered] { *answered = true; });
    };
    hand_over(this, [this, change, take] {
        if (change->is_given_up) return;
        change->is_away = true;  // before the answer, which comes from another thread
        if (messages_.guarded(take)) return;
        change->is_away = false;
        *change->is_answered = true;
    });
    while (!*change->is_answered) {
        progress(0);
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    // A hand that was removed meanwhile closes its device, too.
    content_.closer().closes_within(patience, [&] { progress(0); });
}

/// On the task's thread: with the wanted device, or else with the one before if that was closed.
void Connector::open(const std::shared_ptr<Change>& change, const io::Progress& progress) {
    const auto use = [&](const run::Setup& setup, const std::function<void()>& close) {
        change->next.all.push_back(opened(progress, [&](const OnProgress& waits) {
            return LiveHand::with(change->data, setup, change->key, close, waits);
        }));
    };
    try {
        use(change->wanted, [&] { take_away(change, progress); });
    } catch (const std::exception&) {
        change->next.error = std::current_exception();
    }
    if (!change->next.error || !change->is_away) return;
    try {
        use(change->before, {});
    } catch (const std::exception&) {  // the first error says why
    }
}

/// On the window's thread, when a person has cancelled it: no device may be left.
void Connector::tell_given_up(const Change& change) {
    if (!change.is_away || !content_.has_hand(change.key)) return;
    messages_.show_problem(QString::fromStdString(change.info.name + ": " + problem_of_away));
}

void Connector::use_device(const devices::DeviceChoice& device) {
    const run::Run* live = content_.live();
    if (!live) return;
    const auto change = std::make_shared<Change>(content_.closer());
    change->data = content_.data();
    change->before = change->wanted = content_.setup_with(live->setup().device);
    change->wanted.device = device;
    change->key = content_.key();
    change->info = live->device();
    task_.start(
        connecting_words(device),
        [this, change](const io::Progress& progress) {
            try {
                open(change, progress);
            } catch (...) {
                change->is_given_up = true;
                hand_over(this, [this, change] { tell_given_up(*change); });
                throw;
            }
        },
        [this, change] {
            Hands& next = change->next;
            if (!next.all.empty()) content_.replace_hand(std::move(next.all.front()));
            if (next.error) std::rethrow_exception(next.error);
        });
}

void Connector::add_hand(const devices::DeviceChoice& device) {
    if (!content_.live() || content_.hands() == most_hands) return;
    const auto added = std::make_shared<Hands>(content_.closer());
    const run::Setup setup = content_.setup_with(device);
    task_.start(
        connecting_words(device),
        [added, setup, data = content_.data()](const io::Progress& progress) {
            added->all.push_back(opened(progress, [&](const OnProgress& waits) {
                return LiveHand::with(data, setup, new_key(), {}, waits);
            }));
        },
        [this, added] { content_.add_hand(std::move(added->all.front())); });
}

}  // namespace palpate::viewer
