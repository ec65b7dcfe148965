// Keeps a control at what the user has set while snapshots still show the state before.
#pragma once

namespace palpate::viewer {

/// Snapshots come thirty times a second and a command takes effect within a tick: after a change up
/// to three snapshots may still differ from it. A fourth means that it was not carried out.
class AwaitedChange {
  public:
    void begin() { left_ = 3; }
    void end() { left_ = 0; }
    /// Whether to ignore a snapshot. `same`: it agrees with the control, so that nothing more is
    /// awaited.
    bool passes_over(bool same) {
        if (same) left_ = 0;
        return left_ > 0 && left_-- > 0;
    }

  private:
    int left_ = 0;  // snapshots that may still differ
};

}  // namespace palpate::viewer
