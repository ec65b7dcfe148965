// Saves the edits of a store as an OME-Zarr of the changed chunks. It opens as the edited volume as
// long as the original exists.
#pragma once

#include <filesystem>

#include "palpate/stream/store.hpp"

namespace palpate::stream {

/// How a store was opened.
struct Opened {
    std::string address;
    StoreOptions options;
    /// The result of content_below_edits() at that time. Empty: not known.
    std::string content = {};
    /// Saves the edits without reading the original, which may be gone, unreachable or replaced.
    /// Only the edited level is saved. The edits open only over the original that was opened.
    bool is_rescue = false;
};

/// The content of the original, from a level of `from` on. The original is `from` or, if that
/// consists of saved edits, their original. Passes on exceptions of the store, and throws Cancelled
/// as soon as `stop` is requested.
std::string content_below_edits(const Store& from, int level, const std::stop_token& stop = {});

/// Throws std::invalid_argument unless the name ends with .zarr.
void check_edits_name(const std::filesystem::path& out);

/// Throws as save_edits() would because of the name or of existing files, before there are edits.
void check_edits_place(const std::filesystem::path& out, const Opened& opened);

/// Writes `edits`, samples of a level of the store `from`, to the folder `out`: the changed chunks
/// of that level, and those of the coarser levels. Coarser samples above edited ones are made as
/// those of the original are, and the others stay as they were. The folder names its original.
/// If `from` consists of saved edits, this is the original of those, and the earlier edits are
/// included. The folder is OME-Zarr 0.5, in which other programs see 0 in all unedited chunks. It
/// is first made under another name, and then replaces an older folder of edits, and nothing else,
/// in one step. If that fails, the edits are kept next to it, and the error names the place. If the
/// data of the original has changed since it was opened, saving is refused. Throws io::OutputError,
/// as check_edits_name() does, and passes on exceptions of `progress` and of the store.
void save_edits(const Store& from, const Opened& opened, int level, const Samples& edits,
                const std::filesystem::path& out, const io::Progress& progress);

}  // namespace palpate::stream
