// On Windows, garbage collectors stop threads by the system's own call: nothing is in their way.
#include "bindings/c/runtimes.hpp"

namespace palpate::c {

void let_runtimes_stop_this_thread() noexcept {}

}  // namespace palpate::c
