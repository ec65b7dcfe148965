// Passes a device's latest problem from its own thread to any other. For backends whose
// `Trouble` has a `kind` (with `none`) and whose status_of(kind) gives the status that the servo
// sees.
#pragma once

#include "devices/link.hpp"

namespace palpate::devices {

template <class Trouble>
class LatestTrouble {
  public:
    /// The device's thread: sends the reading to the servo, or the trouble's status in its place.
    void report(Link& link, const Trouble& trouble, const DeviceReading& reading,
                std::int64_t now) noexcept {
        if (trouble != last_) {
            last_ = trouble;
            shared_.put(trouble);
        }
        if (trouble.kind == Trouble::Kind::none) {
            DeviceReading ready = reading;
            ready.status = DeviceStatus::ready;
            link.report(ready, now);
        } else {
            link.report(status_of(trouble.kind), now);
        }
    }
    /// Any thread.
    Trouble get() const { return shared_.get().value_or(Trouble{}); }

  private:
    Trouble last_;  // the device's thread's
    Newest<Trouble> shared_;
};

}  // namespace palpate::devices
