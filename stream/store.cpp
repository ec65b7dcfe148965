// Chooses the kind of store that an address names.
#include "palpate/stream/store.hpp"

#include "io/located_chunks.hpp"
#include "io/plain_samples.hpp"
#include "io/tiff_peek.hpp"
#include "palpate/io/error.hpp"
#include "stream/edited_store.hpp"
#include "stream/remote_objects.hpp"
#include "stream/stores.hpp"

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
    throw io::InputError(address +
                         ": has no metadata of Zarr (zarr.json, .zgroup, .zarray) or N5 "
                         "(attributes.json); check the name");
}

/// The libraries that find chunks in a file need it on this machine.
void check_not_located(const std::string& address) {
    if (!io::is_hdf5_name(address) && !address.ends_with(".tif") && !address.ends_with(".tiff")) {
        return;
    }
    throw io::InputError(address +
                         ": HDF5 and TIFF are read from this machine's disks only; download it, or "
                         "convert it to OME-Zarr where it lies");
}

void check_number(const std::string& address, const std::string& what, int wanted, int count) {
    if (wanted >= 0 && wanted < count) return;
    throw io::InputError(address + ": there is no " + what + " " + std::to_string(wanted) +
                         ": it has " + std::to_string(count) +
                         (count == 1 ? ", number 0" : ", numbered from 0; choose one of them"));
}

}  // namespace

void check_choice(const StoreInfo& info, const StoreOptions& options) {
    check_number(info.address, "time", options.time, info.times);
    check_number(info.address, "channel", options.channel,
                 info.channels.empty() ? 1 : static_cast<int>(info.channels.size()));
}

bool is_chunked(const std::string& address) {
    std::error_code error;
    return is_remote(address) || is_chunked_folder(address) || is_pyramid(address) ||
           (io::is_hdf5_name(address) && std::filesystem::is_regular_file(address, error));
}

bool is_store(const std::string& address, const StoreOptions& options) {
    return is_remote(address) || is_chunked_folder(address) || is_located(address, options) ||
           is_plain(address, options);
}

std::shared_ptr<const Store> open_store(const std::string& address, const StoreOptions& options) {
    if (is_remote(address)) {
        check_not_located(address);
        auto objects = http_objects(address, options);
        if (!options.cache_folder.empty() && options.cache_bytes > 0) {
            objects = cached_objects(objects, options.cache_folder, options.cache_bytes);
        }
        return open_chunked(objects, address, options);
    }
    if (holds_edits(address)) return open_edits(address, options);
    if (is_chunked_folder(address)) {
        return open_chunked(folder_objects(address), address, options);
    }
    if (is_located(address, options)) return open_located(address, options);
    return open_plain_file(address, options);
}

}  // namespace palpate::stream
