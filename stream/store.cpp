// Chooses the kind of store that an address names.
#include "palpate/stream/store.hpp"

#include "io/plain_samples.hpp"
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

/// The metadata of a Zarr group or array, of either version.
bool is_zarr_folder(const std::filesystem::path& folder) {
    std::error_code error;
    if (!std::filesystem::is_directory(folder, error)) return false;
    for (const char* name : {"zarr.json", ".zattrs", ".zgroup", ".zarray"}) {
        if (std::filesystem::exists(folder / name, error)) return true;
    }
    return folder.extension() == ".zarr";
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

bool is_store(const std::string& address, const StoreOptions& options) {
    return is_remote(address) || is_zarr_folder(address) || is_plain(address, options);
}

std::shared_ptr<const Store> open_store(const std::string& address, const StoreOptions& options) {
    if (is_remote(address)) {
        auto objects = http_objects(address, options);
        if (!options.cache_folder.empty() && options.cache_bytes > 0) {
            objects = cached_objects(objects, options.cache_folder, options.cache_bytes);
        }
        return open_zarr(objects, address, options);
    }
    if (holds_edits(address)) return open_edits(address, options);
    if (is_zarr_folder(address)) return open_zarr(folder_objects(address), address, options);
    return open_plain_file(address, options);
}

}  // namespace palpate::stream
