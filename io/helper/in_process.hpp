// Runs our own readers in the caller's process, where there is no helper program: on Windows and in
// a page.
#pragma once

#include "io/helper/decode.hpp"
#include "palpate/io/volume_file.hpp"

namespace palpate::io {

/// What `read` makes of the request. Throws InputError, which names the file.
VolumeFile read_in_process(const Request& request, const Progress& progress,
                           const std::function<Result(const Request&)>& read);

}  // namespace palpate::io
