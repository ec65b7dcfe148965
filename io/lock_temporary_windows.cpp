// Windows needs no locks on temporary files: one that is open cannot be removed.
#include "io/leftovers.hpp"

namespace palpate::io {

int lock_temporary(const std::filesystem::path&) {
    return -1;
}

}  // namespace palpate::io
