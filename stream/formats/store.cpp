// Chooses the kind of store that an address names.
#include "palpate/stream/store.hpp"

#include <algorithm>
#include <charconv>

#include "io/plain_samples.hpp"
#include "io/process/located_chunks.hpp"
#include "io/tiff_peek.hpp"
#include "palpate/io/address.hpp"
#include "palpate/io/error.hpp"
#include "stream/formats/edited_store.hpp"
#include "stream/formats/stores.hpp"
#include "stream/objects/remote_objects.hpp"
#include "stream/while_telling.hpp"

namespace palpate::stream {
namespace {

bool is_plain(const std::string& address, const StoreOptions& options) {
    io::ReadOptions read;
    read.raw = options.raw;
    return io::may_be_plain(address, read);
}

/// HDF5, or TIFF in tiles, unless it is said to have no header.
bool is_located(const std::string& address, const StoreOptions& options) {
    std::error_code error;
    if (options.raw || !std::filesystem::is_regular_file(address, error)) return false;
    if (io::is_hdf5_name(address)) return true;
    const auto tiff = io::peek_tiff(address);
    return tiff && tiff->tiled;
}

/// TIFF without coarser levels is read whole, unless it is large.
bool is_pyramid(const std::string& address) {
    const auto tiff = io::peek_tiff(address);
    return tiff && tiff->tiled && tiff->has_levels;
}

/// True if its name or its metadata are those of a chunked format.
bool is_chunked_folder(const std::filesystem::path& folder) {
    std::error_code error;
    if (!std::filesystem::is_directory(folder, error)) return false;
    for (const char* name :
         {"zarr.json", ".zattrs", ".zgroup", ".zarray", "attributes.json", "s0/attributes.json",
          "setup0/attributes.json", "timepoint0/s0/attributes.json", "c0/s0/attributes.json"}) {
        if (std::filesystem::exists(folder / name, error)) return true;
    }
    return folder.extension() == ".zarr" || folder.extension() == ".n5";
}

/// The format that the name tells is looked for first: of a remote store, each costs a round trip.
std::shared_ptr<const Store> open_chunked(const std::shared_ptr<const Objects>& objects,
                                          const std::string& address, const StoreOptions& options) {
    const bool named_n5 = address.find(".n5") != std::string::npos;
    for (const auto open : {named_n5 ? open_n5 : open_zarr, named_n5 ? open_zarr : open_n5}) {
        if (auto store = open(objects, address, options)) return store;
    }
    throw io::InputError(
        address +
        ": has no metadata of Zarr (zarr.json, .zgroup, .zarray) or N5 (attributes.json); check "
        "the name" +
        (io::is_web_address(address) ? ", and download a file of another format than HDF5 and TIFF"
                                     : ""));
}

/// A file of chunks elsewhere: the address of its folder, and its name there.
struct RemoteFile {
    std::string folder, name;
};

std::string without_escapes(const std::string& text) {
    std::string plain;
    for (std::size_t i = 0; i < text.size(); ++i) {
        unsigned byte = 0;
        const char* const digits = text.data() + i + 1;
        const bool escaped = text[i] == '%' && i + 2 < text.size() &&
                             std::from_chars(digits, digits + 2, byte, 16).ptr == digits + 2;
        plain += escaped ? static_cast<char>(byte) : text[i];
        i += escaped ? 2 : 0;
    }
    return plain;
}

/// Returns nothing if the name is not that of HDF5 or TIFF.
std::optional<RemoteFile> remote_file(const std::string& address) {
    const std::size_t question = std::min(address.find('?'), address.size());
    const std::string place = address.substr(0, question);
    const std::size_t slash = place.rfind('/');
    const std::string name = without_escapes(place.substr(slash + 1));
    if (!io::is_hdf5_name(name) && !io::is_tiff_name(name)) return std::nullopt;
    return RemoteFile{place.substr(0, slash) + address.substr(question), name};
}

std::shared_ptr<const Objects> remote_objects(const std::string& address,
                                              const StoreOptions& options,
                                              const std::stop_token& stop) {
    auto objects = http_objects(address, options, stop);
    if (options.cache_folder.empty() || options.cache_bytes == 0) return objects;
    return cached_objects(objects, options.cache_folder, options.cache_bytes);
}

}  // namespace

bool is_chunked(const std::string& address) {
    std::error_code error;
    return io::is_web_address(address) || is_chunked_folder(address) || is_pyramid(address) ||
           (io::is_hdf5_name(address) && std::filesystem::is_regular_file(address, error));
}

bool is_store(const std::string& address, const StoreOptions& options) {
    return io::is_web_address(address) || is_chunked_folder(address) ||
           is_located(address, options) || is_plain(address, options);
}

std::shared_ptr<const Store> open_until(const std::stop_token& stop, const std::string& address,
                                        const StoreOptions& options) {
    if (io::is_web_address(address)) {
        // Text that a browser adds to an address is not for the server.
        const bool is_s3 = address.find("://") == 2;  // where it is a part of the name
        const std::size_t fragment = is_s3 ? address.npos : address.find('#');
        if (fragment != address.npos) return open_until(stop, address.substr(0, fragment), options);
        if (const auto file = remote_file(address)) {
            return open_located(stop, remote_objects(file->folder, options, stop), file->name,
                                options);
        }
        return open_chunked(remote_objects(address, options, stop), address, options);
    }
    if (holds_edits(address)) return open_edits(stop, address, options);
    if (is_chunked_folder(address)) {
        return open_chunked(folder_objects(address, stop), address, options);
    }
    if (is_located(address, options)) {
        const std::filesystem::path path(address);
        return open_located(stop, folder_objects(path.parent_path()), path.filename().string(),
                            options);
    }
    return open_plain_file(address, options);
}

std::shared_ptr<const Store> open_store(const std::string& address, const StoreOptions& options,
                                        const io::Progress& progress) {
    return while_telling(
        progress, [&](const std::stop_token& stop) { return open_until(stop, address, options); });
}

}  // namespace palpate::stream
