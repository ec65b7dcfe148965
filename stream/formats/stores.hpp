// The kinds of stores, which open_store() chooses from. Private to stream/.
#pragma once

#include <memory>
#include <string>

#include "palpate/stream/store.hpp"
#include "stream/objects/objects.hpp"

namespace palpate::stream {

/// open_store() on this thread. Throws Cancelled soon after `stop` is requested while a server is
/// waited for.
std::shared_ptr<const Store> open_until(const std::stop_token& stop, const std::string& address,
                                        const StoreOptions& options);

/// Raw, NRRD, MetaImage and NIfTI files whose samples are not compressed.
std::shared_ptr<const Store> open_plain_file(const std::string& path, const StoreOptions& options);

/// HDF5 and tiled TIFF, whose chunks the helper process locates: a file of a folder, here or
/// elsewhere.
std::shared_ptr<const Store> open_located(const std::stop_token& stop,
                                          std::shared_ptr<const Objects> folder,
                                          const std::string& name, const StoreOptions& options);

/// Zarr or N5 below the objects' root; null if there are no metadata of the format. `address` is
/// how messages name it.
std::shared_ptr<const Store> open_zarr(std::shared_ptr<const Objects> objects,
                                       const std::string& address, const StoreOptions& options);

std::shared_ptr<const Store> open_n5(std::shared_ptr<const Objects> objects,
                                     const std::string& address, const StoreOptions& options);

/// Throws io::InputError about options.time or options.channel that a store does not have.
void check_choice(const StoreInfo& info, const StoreOptions& options);

}  // namespace palpate::stream
