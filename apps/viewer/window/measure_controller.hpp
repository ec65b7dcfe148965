// Measures lengths and angles by clicks in scene and slices.
#pragma once

#include <optional>
#include <vector>

#include "apps/viewer/model/measurement.hpp"
#include "apps/viewer/window/desk.hpp"

namespace palpate::viewer {

class MeasureController : public Controller {
    Q_OBJECT

  public:
    explicit MeasureController(const Desk& desk);

    /// The next clicks are its points.
    void begin(Measure kind);
    /// Gives up the one that is being made. False if there is none.
    bool cancel();
    bool measuring() const { return made_.has_value(); }
    void remove_last();
    void remove_all();

    /// The complete ones.
    const std::vector<Measurement>& measurements() const { return done_; }
    void set_measurements(const std::vector<Measurement>& measurements);
    /// There are some that are in no session file.
    bool unsaved() const { return !done_.empty() && done_ != saved_; }
    void set_saved() { saved_ = done_; }

  private:
    void add_point(const Vec3& at);
    void show(const std::optional<Vec3>& pointed_at = {});

    std::vector<Measurement> done_, saved_;
    std::optional<Measurement> made_;
};

}  // namespace palpate::viewer
