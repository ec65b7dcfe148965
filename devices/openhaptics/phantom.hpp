// An open OpenHaptics device: attached to the driver, with its servo loop running.
#pragma once

#include <list>
#include <memory>
#include <string>

#include "devices/claim.hpp"
#include "devices/openhaptics/frames.hpp"

namespace palpate::devices::openhaptics {

struct Settings {
    std::string name;    ///< as in the vendor's setup; empty: its default device
    bool reset = false;  ///< the arm stands in its reset pose: zero its encoders
    double rate = 1000;  ///< [Hz] of the servo
};

/// Of the one device. The driver has one servo loop and one current device per process.
Claim claim_for(const Settings& settings);

/// Opens a device of the driver and closes it when destroyed. Throws DeviceError.
class Attachment {
  public:
    Attachment(const Hd& hd, Claim claim, const std::string& name);
    ~Attachment();
    Attachment(const Attachment&) = delete;
    Attachment& operator=(const Attachment&) = delete;

    const Hd& hd() const { return *hd_; }
    /// Shared, because calls may still come after this object is destroyed.
    const std::shared_ptr<const Hd>& shared_hd() const { return hd_; }
    Handle device() const { return device_; }

  private:
    const Claim claim_;
    std::shared_ptr<const Hd> hd_;
    Handle device_ = no_handle;
};

class Phantom final : public Device {
  public:
    /// Starts the driver's servo loop. Throws DeviceError.
    Phantom(const Hd& library, Claim claim, const Settings& settings, const Timing& timing = {});
    ~Phantom() override;

    DeviceInfo info() const override { return info_; }
    std::string problem() const override;
    DeviceReading read(double) noexcept override { return frames_->link().read(timing_.now()); }
    void write(const Wrench& wrench, double) noexcept override {
        frames_->link().write(wrench, timing_.now());
    }
    void stop() noexcept override { frames_->link().stop(); }
    bool is_stopping() const noexcept override { return frames_->link().stopping(); }

  private:
    void start();
    void end_loop() noexcept;
    void check(const char* step) const;
    std::string calibration_words(Trouble::Kind kind) const;

    const Timing timing_;
    const Attachment attachment_;
    DeviceInfo info_;
    unsigned int styles_ = 0;  // of calibration
    std::shared_ptr<Frames> frames_;
    std::list<std::shared_ptr<Frames>> kept_;  // the same, so that to keep it needs no memory
    unsigned long scheduled_ = 0;
    bool is_scheduled_ = false;
};

}  // namespace palpate::devices::openhaptics
