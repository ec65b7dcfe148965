// Web addresses as files may keep them, without what gives access.
#pragma once

#include <string>

#include "palpate/io/error.hpp"

namespace palpate::io {

/// A web address as files may keep it: without user, password and query, which may give access; of
/// a query, the version of an object stays. Other names stay as they are.
inline std::string address_to_keep(const std::string& address) {
    const std::size_t query = address.find('?');
    if (address.find("://") == address.npos) return address;
    const std::string place = without_secrets(address.substr(0, query));
    const std::size_t version = query == address.npos ? query : address.find("versionId=", query);
    if (version == address.npos) return place;
    return place + '?' + address.substr(version, address.find('&', version) - version);
}

}  // namespace palpate::io
