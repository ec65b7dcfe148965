// On Windows there are no helper programs: the libraries that they isolate are not built there.
#include <io.h>

#include <cerrno>
#include <system_error>

#include "io/process/helper_process.hpp"

namespace palpate::io {
namespace {

const char* const no_helper =
    "Palpate for Windows reads and writes this kind of file not yet: convert it with Palpate on "
    "Linux (docs/windows.md says what is read)";

}  // namespace

Descriptor::~Descriptor() {
    close_now();
}

void Descriptor::close_now() {
    if (number_ >= 0) ::_close(number_);
    number_ = -1;
}

Descriptor shared_memory() {
    throw std::system_error(std::make_error_code(std::errc::not_supported), no_helper);
}

Descriptor shared_memory(std::size_t) {
    return shared_memory();
}

std::shared_ptr<void> map_shared(const Descriptor&, std::size_t) {
    throw std::system_error(std::make_error_code(std::errc::not_supported), no_helper);
}

HelperResult run_helper(const HelperJob&) {
    return {{}, no_helper};
}

}  // namespace palpate::io
