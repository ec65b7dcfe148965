// Recognises the files that Palpate writes into folders of results by their places and names, so
// that nothing else is removed or replaced with them. Linux. Private to io/ and stream/.
#pragma once

#include <filesystem>
#include <string>

namespace palpate::io {

/// What a folder holds: a GrowingFolder, or an OME-Zarr image with or without a note of edits.
enum class OwnFolder { growing, image };

/// The marker of a GrowingFolder and the note of a folder of edits.
inline constexpr const char* growing_marker = "palpate-partial.json";
inline constexpr const char* edits_note = "palpate-edits.json";

/// The first file, link or folder at any depth that Palpate does not write there, as a path from
/// `folder`; empty if there is none. Throws OutputError if the folder cannot be read.
std::string unknown_below(const std::filesystem::path& folder, OwnFolder kind);

/// Removes the folder with all that Palpate writes there. Returns what is left, as above.
std::string remove_known(const std::filesystem::path& folder, OwnFolder kind) noexcept;

}  // namespace palpate::io
