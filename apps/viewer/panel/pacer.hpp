// Passes the newest of a fast stream of wishes on at a bearable pace: what a drag asks for.
#pragma once

#include <QElapsedTimer>
#include <QObject>
#include <QTimer>

#include <functional>

namespace palpate::viewer {

/// The first wish goes through at once; those that follow within the interval are held back, and
/// the last of them goes through when it is over. None that counts is lost: the last always comes.
class Pacer : public QObject {
    Q_OBJECT

  public:
    /// `interval` [ms]: about 60 a second.
    explicit Pacer(QObject* parent, int interval = 16);

    /// Calls `wish` now or a little later, unless a newer one comes.
    void put(std::function<void()> wish);
    /// Lets what waits through at once: the drag is over.
    void flush();
    /// Forgets what waits.
    void drop();

  private:
    void pass();

    QTimer timer_;
    QElapsedTimer since_;
    std::function<void()> waiting_;
};

}  // namespace palpate::viewer
