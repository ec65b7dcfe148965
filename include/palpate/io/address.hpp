// Web addresses: recognises them, and removes the parts that give access before files store them.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "palpate/io/error.hpp"

namespace palpate::io {

/// An address with http://, https:// or s3://, in letters of any case.
inline bool is_web_address(std::string_view name) {
    const auto small = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
    constexpr std::array<std::string_view, 3> schemes = {"http://", "https://", "s3://"};
    return std::ranges::any_of(schemes, [&](std::string_view scheme) {
        return std::ranges::equal(name.substr(0, scheme.size()), scheme, {}, small);
    });
}

/// A web address as files may store it: without user, password and query, which may give access.
/// The version of an object in a query stays. Other names are returned unchanged.
inline std::string address_to_keep(const std::string& address) {
    const std::size_t query = address.find('?');
    if (address.find("://") == address.npos) return address;
    const std::string place = without_secrets(address.substr(0, query));
    const std::size_t version = query == address.npos ? query : address.find("versionId=", query);
    if (version == address.npos) return place;
    return place + '?' + address.substr(version, address.find('&', version) - version);
}

}  // namespace palpate::io
