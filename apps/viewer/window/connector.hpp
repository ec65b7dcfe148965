// Opens devices in the background: those of a volume that is to be felt, another one for a hand,
// and that of a second hand.
#pragma once

#include <exception>
#include <functional>
#include <memory>
#include <vector>

#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/desk.hpp"
#include "apps/viewer/window/messages.hpp"

namespace palpate::viewer {

/// A driver that does not answer delays its device, not the window. Only one task at a time: the
/// next one ends it, and so does the end of the run.
class Connector : public Controller {
    Q_OBJECT

  public:
    explicit Connector(const Desk& desk);

    /// Closes what is open, and feels this volume. `then` runs once it is felt. If a device cannot
    /// be opened, nothing is open afterwards, and `otherwise` gets the exception. Without
    /// `otherwise`, a message shows it.
    void feel(std::shared_ptr<Opened> volume, std::vector<run::Setup> setups,
              std::function<void()> then,
              std::function<void(const std::exception_ptr&)> otherwise = {});
    /// Another device for the chosen hand. The same one is closed first; if it cannot be opened
    /// with these options, it is opened as it was.
    void use_device(const devices::DeviceChoice& device);
    /// One more hand. It is chosen.
    void add_hand(const devices::DeviceChoice& device);

    BackgroundTask& task() { return task_; }

  private:
    struct Hands;
    struct Change;
    void open(const std::shared_ptr<Change>& change, const io::Progress& progress);
    void take_away(const std::shared_ptr<Change>& change, const io::Progress& progress);
    void tell_given_up(const Change& change);
    void tell_ended(const RunCloser::Ended& how);

    BackgroundTask task_;
};

}  // namespace palpate::viewer
