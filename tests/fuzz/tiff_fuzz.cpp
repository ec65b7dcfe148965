// Any bytes are a TIFF file whose planes have a size, an order and a meaning, or a failure of one
// line.
#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <string>
#include <string_view>

#include "fuzz/require.hpp"
#include "io/helper/tiff_layout.hpp"
#include "io/helper/tiff_page.hpp"

namespace {

using namespace palpate::io;

void read_layout(const std::string& path) {
    std::vector<std::string> notes;
    const Tiff tiff = open_to_read(path);
    const TiffPages pages = pages_of(tiff.get(), path);
    const TiffLayout layout = layout_of(tiff.get(), path, notes);
    for (const std::uint32_t page : layout.image.pages) {
        // Planes behind the only page are numbered as pages are.
        require(layout.plain_from > 0 || page < pages.whole.size() + pages.reduced.size());
    }
    const TiffPage page = page_of(tiff.get(), path, notes);
    require(page.width > 0 && page.height > 0);
    for (const std::string& note : notes) require(note.find('\n') == std::string::npos);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const int file = memfd_create("image", MFD_CLOEXEC);
    if (file < 0) return 0;
    if (write(file, data, size) == static_cast<ssize_t>(size)) {
        try {
            read_layout("/proc/self/fd/" + std::to_string(file));
        } catch (const Failure& failure) {
            require_one_line(failure.what());
        }
    }
    close(file);
    return 0;
}
