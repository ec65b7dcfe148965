// Values of Python that a call moves without the GIL, such as a Renderer in follow().
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

#include "bindings/python/casters.hpp"

namespace palpate::python {

/// While a call moves it without the GIL, other threads may look at it, as it was before, and copy
/// it.
template <class Value>
struct Shared : Value {
    const char* moved_by = nullptr;  ///< a call

    explicit Shared(Value value) : Value(std::move(value)) {}
    Shared copied() const { return Shared(Value(*this)); }
    /// Throws std::logic_error, a RuntimeError in Python, while it moves.
    Shared& changeable() {
        if (!moved_by) return *this;
        const std::string name = py::str(py::type::of<Shared>().attr("__name__"));
        throw std::logic_error("another thread moves this " + name + ", in " + moved_by +
                               ": wait for its end, or use a copy");
    }
};

/// Other threads cannot change the value while this exists, also if the GIL is released.
template <class Value>
class Moving {
  public:
    Moving(Shared<Value>& value, const char* call) : value_(value.changeable()) {
        value_.moved_by = call;
    }
    ~Moving() { value_.moved_by = nullptr; }
    Moving(const Moving&) = delete;
    Moving& operator=(const Moving&) = delete;

    /// Calls move(copy) without the GIL. Afterwards the value is as that copy; if it throws, as
    /// before.
    template <class Move>
    void without_gil(const Move& move) {
        Value own = value_;
        {
            const GilReleased unlocked;
            move(own);
        }
        static_cast<Value&>(value_) = std::move(own);
    }

  private:
    Shared<Value>& value_;
};

}  // namespace palpate::python
