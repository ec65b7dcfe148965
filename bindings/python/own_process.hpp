// Tells a forked child, in which there are no threads but one, from the process that made an
// object.
#pragma once

#include <unistd.h>

#include <memory>
#include <stdexcept>

namespace palpate::python {

/// Remembers the process that made it.
class OwnProcess {
  public:
    bool is_here() const { return ::getpid() == process_; }
    /// Throws std::logic_error, a RuntimeError in Python, in a child that was forked since.
    void check() const {
        if (is_here()) return;
        throw std::logic_error(
            "this process was forked from the one that runs this, and has no thread of it: stop it "
            "there, and start processes before it or with the method 'spawn'");
    }

  private:
    pid_t process_ = ::getpid();
};

/// The same object, which a forked child never destroys: it would wait for threads that it has not.
template <class T>
std::shared_ptr<T> destroyed_here_only(std::shared_ptr<T> object) {
    T* const pointer = object.get();
    return {pointer,
            [kept = new std::shared_ptr<T>(std::move(object)), process = OwnProcess()](T*) {
                if (process.is_here()) delete kept;
            }};
}

}  // namespace palpate::python
