// The kinds of stores, which open_store() chooses from. Private to stream/.
#pragma once

#include <memory>
#include <string>

#include "palpate/stream/store.hpp"

namespace palpate::stream {

/// Raw, NRRD, MetaImage and NIfTI files whose samples are not compressed.
std::shared_ptr<const Store> open_plain_file(const std::string& path, const StoreOptions& options);

/// Throws io::InputError about options.time or options.channel that a store does not have.
void check_choice(const StoreInfo& info, const StoreOptions& options);

}  // namespace palpate::stream
