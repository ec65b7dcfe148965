// Web addresses: recognises them, and tells the parts that give access from those that choose an
// object.
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

/// The parameters in the query of an address for which `is_wanted` holds, with "&" between them. It
/// gets the name of each in small letters.
template <typename Wanted>
std::string parameters_of(std::string_view address, const Wanted& is_wanted) {
    std::string all;
    std::size_t at = address.find('?');
    while (at != address.npos) {
        const std::size_t end = address.find('&', at + 1);
        const std::string_view parameter = address.substr(at + 1, end - at - 1);
        std::string name(parameter.substr(0, parameter.find('=')));
        for (char& c : name) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
        if (!parameter.empty() && is_wanted(name)) {
            all.append(all.empty() ? "" : "&").append(parameter);
        }
        at = end;
    }
    return all;
}

/// The part of an address's query that chooses the object: all parameters but those of tokens and
/// of signatures (AWS, Google, CloudFront, Azure), which change each time an address is signed.
inline std::string query_of_object(std::string_view address) {
    constexpr std::array<std::string_view, 6> tokens = {
        "token", "access_token", "auth_token", "awsaccesskeyid", "googleaccessid", "signature"};
    constexpr std::array<std::string_view, 3> signed_by_cloudfront = {"expires", "policy",
                                                                      "key-pair-id"};
    constexpr std::array<std::string_view, 22> signed_by_azure = {
        "sig",   "se",    "st",  "sp",  "sv",  "sr",  "ss",  "srt",   "spr",   "sip",  "si",
        "skoid", "sktid", "skt", "ske", "sks", "skv", "sdd", "saoid", "suoid", "scid", "ses"};
    const auto has = [&](std::string_view sign) {
        return !parameters_of(address, [&](const std::string& name) {
                    return name == sign;
                }).empty();
    };
    // These names are short or common. Without a signature they may choose an object.
    const bool by_cloudfront = has("signature"), by_azure = has("sig");
    return parameters_of(address, [&](const std::string& name) {
        const auto is_in = [&](const auto& names) { return std::ranges::count(names, name) > 0; };
        return !(name.starts_with("x-amz-") || name.starts_with("x-goog-") || is_in(tokens) ||
                 (by_cloudfront && is_in(signed_by_cloudfront)) ||
                 (by_azure && is_in(signed_by_azure)));
    });
}

/// A web address as files may store it: without user, password and query, which may give access.
/// The version of an object in a query stays (S3 and Azure, Google, Azure). Other names are
/// returned unchanged.
inline std::string address_to_keep(const std::string& address) {
    if (address.find("://") == address.npos) return address;
    const std::string place = without_secrets(address.substr(0, address.find('?')));
    const std::string version = parameters_of(address, [](const std::string& name) {
        return name == "versionid" || name == "generation" || name == "snapshot";
    });
    return version.empty() ? place : place + '?' + version;
}

}  // namespace palpate::io
