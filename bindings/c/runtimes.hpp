// Requirements of other languages' runtimes for a thread that runs their code.
#pragma once

namespace palpate::c {

/// Runtimes that collect garbage (Mono, Boehm's collector) stop the threads that run their code, on
/// Linux by signals of their own. Blocked, those would stop the whole program for good.
void let_runtimes_stop_this_thread() noexcept;

}  // namespace palpate::c
