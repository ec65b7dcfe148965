// Saves what was edited of a store as an OME-Zarr of the changed chunks, which opens as the edited
// volume as long as the original is there.
#pragma once

#include <filesystem>

#include "palpate/stream/store.hpp"

namespace palpate::stream {

/// How a store was opened.
struct Opened {
    std::string address;
    StoreOptions options;
    /// What content_below_edits() gave then; empty: not known.
    std::string content = {};
    /// Saves the edits without reading the original, which may be gone, silent or replaced: of the
    /// edited level only. They open over the original of before only.
    bool is_rescue = false;
};

/// Recognises the content of the original from a level of `from` on: of `from`, or of what its
/// edits are of. Throws what the store throws, and Cancelled as soon as `stop` is requested.
std::string content_below_edits(const Store& from, int level, const std::stop_token& stop = {});

/// Throws std::invalid_argument unless the name ends with .zarr.
void check_edits_name(const std::filesystem::path& out);

/// Throws as save_edits() would because of its name or of what is there, before there are edits.
void check_edits_place(const std::filesystem::path& out, const Opened& opened);

/// Writes `edits`, samples of a level of the store `from`, to the folder `out`: the chunks of that
/// level that they change, and those of the coarser levels as means of them. The folder names its
/// original, the one that `from` itself names if it is of edits, and has what was edited there,
/// too. It is OME-Zarr 0.5; other programs see 0 where nothing was edited. Made in a folder of its
/// own first, which takes the place of an older folder of edits, and of nothing else, at once. If
/// that fails, they are kept beside it and the error says where. An original that holds other data
/// than when it was opened is refused. Throws io::OutputError, as
/// check_edits_name(), what `progress` throws and what the store throws.
void save_edits(const Store& from, const Opened& opened, int level, const Samples& edits,
                const std::filesystem::path& out, const io::Progress& progress);

}  // namespace palpate::stream
