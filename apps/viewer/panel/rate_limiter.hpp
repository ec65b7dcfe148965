// Limits the requests of a drag to 60 a second; the last is never lost.
#pragma once

#include <QElapsedTimer>
#include <QObject>
#include <QTimer>

#include <functional>

namespace palpate::viewer {

/// The first request goes through at once; of those that follow within the interval the last goes
/// through when the interval is over.
class RateLimiter : public QObject {
  public:
    /// `interval` [ms]: about 60 a second.
    explicit RateLimiter(QObject* parent, int interval = 16);

    /// Calls `request` now or a little later, unless a newer one comes.
    void put(std::function<void()> request);
    /// Lets a waiting request through at once: the drag is over.
    void flush();
    /// Forgets a waiting request.
    void drop();

  private:
    void pass();

    QTimer timer_;
    QElapsedTimer since_;
    std::function<void()> waiting_;
};

}  // namespace palpate::viewer
