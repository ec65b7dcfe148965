// Opens files among names that others may have made: a pipe, a device, a folder or a link of that
// name is no file, and none of them holds anybody up. Linux. Private to io/ and stream/.
#pragma once

#include <fcntl.h>

#include <string>

namespace palpate::io {

/// A regular file in an open folder (AT_FDCWD: the working folder, or an absolute name), to read.
/// Below 0, with errno ELOOP for a link, EISDIR for a folder, ENXIO for all else that is no file.
int open_file_in(int folder, const std::string& name, int flags = O_NOFOLLOW);

}  // namespace palpate::io
