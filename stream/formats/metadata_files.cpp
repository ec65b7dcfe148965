// Files of metadata in JSON. See the header.
#include "stream/formats/metadata_files.hpp"

#include <algorithm>

#include "io/json_text.hpp"
#include "stream/formats/unpacking_room.hpp"

namespace palpate::stream {

using Json = nlohmann::json;

namespace {

/// Python's json writes NaN and Infinity, which JSON does not have: here they become texts, as Zarr
/// has them for fill values.
std::string with_quoted_numbers(std::string_view text) {
    std::string quoted;
    bool in_text = false;
    for (std::size_t i = 0; i < text.size();) {
        std::size_t length = 1;
        for (const std::string_view word : {"NaN", "Infinity", "-Infinity"}) {
            if (!in_text && text.substr(i).starts_with(word)) length = word.size();
        }
        if (text[i] == '\\' && in_text) length = std::min<std::size_t>(2, text.size() - i);
        in_text ^= text[i] == '"';
        const std::string_view mark = length > 2 ? "\"" : "";
        quoted.append(mark).append(text.substr(i, length)).append(mark);
        i += length;
    }
    return quoted;
}

}  // namespace

Wanted metadata_file(const std::string& folder, const std::string& name) {
    constexpr std::uint64_t most_bytes = 8 << 20;
    return {key_below(folder, name), std::nullopt, most_bytes, false, false, true};
}

std::size_t room_for_metadata(const StoreOptions& options) {
    return std::min<std::uint64_t>(io::most_json_bytes,
                                   UnpackingRoom(options.unpacking).most() / 4);
}

Json parsed(std::optional<Bytes> bytes, const std::string& name, std::size_t& room) {
    if (!bytes) return nullptr;
    const std::string_view text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
    try {
        const bool is_plain = text.find("NaN") == text.npos && text.find("Infinity") == text.npos;
        return io::parsed_json_within(room, is_plain ? text : with_quoted_numbers(text));
    } catch (const Json::other_error& error) {
        const std::string words = error.what(), flaw = words.substr(words.find("] ") + 2);
        throw io::InputError(name + ": is not read: " + flaw +
                             (flaw.starts_with("its values take") ? "; allow more memory"
                                                                  : "; its metadata are damaged"));
    } catch (const Json::exception&) {
        // A server's page about a login or an error, although its status says that all is well.
        const std::size_t begin = text.find_first_not_of(" \t\r\n");
        if (begin != text.npos && text[begin] == '<') {
            throw io::InputError(name +
                                 ": the server gives a web page in its place, perhaps one that "
                                 "asks for a login; check the address");
        }
        throw io::InputError(name + ": is not JSON; the metadata are damaged: copy them again");
    }
}

std::vector<Json> metadata_in(const Objects& objects, const std::vector<std::string>& folders,
                              const std::string& name, std::size_t& room) {
    std::vector<Wanted> wanted;
    for (const std::string& folder : folders) wanted.push_back(metadata_file(folder, name));
    auto all = objects.get_all(wanted, room, {});
    std::vector<Json> found;
    for (std::size_t i = 0; i < all.size(); ++i) {
        found.push_back(parsed(std::move(all[i]), objects.name_of(wanted[i].key), room));
    }
    return found;
}

const Json& member(const Json& object, const char* name) {
    static const Json none;
    const auto found = object.find(name);  // of what is no object, the end
    return found == object.end() ? none : *found;
}

std::string text_member(const Json& object, const char* name, const char* otherwise) {
    const Json& text = member(object, name);
    return text.is_null() ? otherwise : text.get<std::string>();
}

std::vector<std::int64_t> sizes_of(const Json& list, const char* member) {
    std::vector<std::int64_t> sizes;
    if (!list.is_array() || list.size() > 32) {
        throw BadMetadata(std::string("its metadata have no sensible '") + member + "'");
    }
    for (const Json& size : list) {
        if (!size.is_number_integer()) {
            throw BadMetadata(std::string("its '") + member + "' is no list of whole numbers");
        }
        sizes.push_back(size.get<std::int64_t>());
    }
    return sizes;
}

}  // namespace palpate::stream
