// Lowers the priority of threads for which nobody has to wait.
#pragma once

namespace palpate::viewer {

/// Lowers the priority of the calling thread and of those that it starts below the servo's and the
/// window's. Does nothing where the system does not support it.
void lower_thread_priority() noexcept;

}  // namespace palpate::viewer
