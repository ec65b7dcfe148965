// Constructs runs on the thread of a task, and starts them on the window's.
#include "apps/viewer/window/connector.hpp"

#include <atomic>
#include <chrono>
#include <thread>
#include <utility>

#include "apps/viewer/scene/threads.hpp"

namespace palpate::viewer {
namespace {

/// For devices of runs that have ended, which may be those that are opened next.
constexpr std::chrono::seconds patience{2};

/// In place of a device that is closed, to be opened again.
class Away final : public Device {
  public:
    explicit Away(DeviceInfo info) : info_(std::move(info)) {}

    DeviceInfo info() const override { return info_; }
    std::string problem() const override {
        return "it was closed, to be opened again: if that does not happen, choose it once more";
    }
    DeviceReading read(double) override { return {.status = DeviceStatus::lost}; }
    void write(const Wrench&, double) override {}
    void stop() noexcept override {}

  private:
    const DeviceInfo info_;
};

QString connecting_words(const devices::DeviceChoice& device) {
    return Connector::tr("Connecting to %1").arg(QString::fromStdString(run::text_of(device)));
}

/// open(progress) for as long as that takes, which is not known. A person may have cancelled it
/// meanwhile.
template <class Open>
auto opened(const io::Progress& progress, const Open& open) {
    auto result = open([progress](double) { progress(0); });
    progress(0);
    return result;
}

}  // namespace

/// Of the device of one hand.
struct Connector::Change {
    std::shared_ptr<run::Data> data;
    run::Setup before, wanted;
    std::shared_ptr<const int> key;
    DeviceInfo info;  // of the device before
    LiveHand next;
    std::exception_ptr error;
    bool is_away = false;
    std::atomic<bool> is_closed{false};
    std::atomic<bool> is_given_up{false};  // the task was cancelled
};

Connector::Connector(const Desk& desk) : Controller(desk), task_(messages_) {
    connect(&content_, &Content::runs_ended, this, &Connector::tell_ended);
}

/// A force that may still be on.
void Connector::tell_ended(const RunCloser::Ended& how) {
    if (!how.unanswered.empty()) messages_.show_problem(QString::fromStdString(how.unanswered));
}

void Connector::feel(std::shared_ptr<Opened> volume, std::vector<run::Setup> setups,
                     std::function<void()> then,
                     std::function<void(const std::exception_ptr&)> otherwise) {
    struct Result {
        std::vector<LiveHand> hands;
        std::exception_ptr error;
    };
    const auto result = std::make_shared<Result>();
    const QString words = connecting_words(setups.front().device);
    content_.close();
    task_.start(
        words,
        [=, &closer = content_.closer()](const io::Progress& progress) {
            closer.closes_within(patience, [&] { progress(0); });
            try {
                result->hands = opened(progress, [&](const OnProgress& waits) {
                    return make_hands(*volume, setups, waits);
                });
            } catch (const std::exception&) {
                result->error = std::current_exception();
            }
        },
        [=, this] {
            if (result->error && otherwise) return otherwise(result->error);
            if (result->error) std::rethrow_exception(result->error);
            content_.start_run(volume, std::move(result->hands));
            then();
        });
}

/// On the task's thread: the hand goes on with no device until its own is closed.
void Connector::take_away(const std::shared_ptr<Change>& change, const io::Progress& progress) {
    change->is_away = true;
    const auto take = [this, change] {
        run::Setup setup = change->before;
        setup.open_device = [info = change->info](const auto&, const auto&) {
            return std::make_unique<Away>(info);
        };
        content_.replace_hand(LiveHand::with(change->data, setup, change->key, {}),
                              [change] { change->is_closed = true; });
    };
    hand_over(this, [this, change, take] {
        if (change->is_given_up) return;
        if (!messages_.guarded(take)) change->is_closed = true;
    });
    try {
        while (!change->is_closed) {
            progress(0);
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        }
    } catch (...) {
        change->is_given_up = true;
        throw;
    }
}

void Connector::use_device(const devices::DeviceChoice& device) {
    const run::Run* live = content_.live();
    if (!live) return;
    const auto change = std::make_shared<Change>();
    change->data = content_.data();
    change->before = content_.setup_with(live->setup().device);
    change->wanted = change->before;
    change->wanted.device = device;
    change->key = content_.key();
    change->info = live->device();
    task_.start(
        connecting_words(device),
        [this, change](const io::Progress& progress) {
            const auto open = [&](const run::Setup& setup, const std::function<void()>& close) {
                return opened(progress, [&](const OnProgress& waits) {
                    return LiveHand::with(change->data, setup, change->key, close, waits);
                });
            };
            try {
                change->next = open(change->wanted, [&] { take_away(change, progress); });
            } catch (const std::exception&) {
                change->error = std::current_exception();
                if (change->is_away) change->next = open(change->before, {});
            }
        },
        [this, change] {
            if (change->next.run) content_.replace_hand(std::move(change->next));
            if (change->error) std::rethrow_exception(change->error);
        });
}

void Connector::add_hand(const devices::DeviceChoice& device) {
    if (!content_.live() || content_.hands() == most_hands) return;
    const auto added = std::make_shared<LiveHand>();
    const run::Setup setup = content_.setup_with(device);
    task_.start(
        connecting_words(device),
        [added, setup, data = content_.data()](const io::Progress& progress) {
            *added = opened(progress, [&](const OnProgress& waits) {
                return LiveHand::with(data, setup, new_key(), {}, waits);
            });
        },
        [this, added] {
            // Another volume may be felt by now.
            if (content_.data() == added->run->shared_data()) content_.add_hand(std::move(*added));
        });
}

}  // namespace palpate::viewer
