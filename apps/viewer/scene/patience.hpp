// Threads that others need not wait for.
#pragma once

namespace palpate::viewer {

/// The calling thread, and those that it starts, get less of the processors than others: the
/// servo's thread and the window come first. Nothing where the system has no such thing.
void stand_back() noexcept;

}  // namespace palpate::viewer
