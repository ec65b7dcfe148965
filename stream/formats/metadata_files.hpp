// Files of metadata in JSON, which chunked formats keep beside their chunks. None of it is
// trusted. Private to stream/.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "palpate/io/error.hpp"
#include "stream/formats/image.hpp"
#include "stream/objects/objects.hpp"

namespace palpate::stream {

/// A request for one that may not be there, of at most 8 MiB.
Wanted metadata_file(const std::string& folder, const std::string& name);

/// What all metadata of a store that are held together may take in memory [bytes]: a quarter of
/// what chunks may, and no more than any JSON.
std::size_t room_for_metadata(const StoreOptions& options);

/// Null if the file is not there. Throws io::InputError, which names it, if it is not JSON, or
/// takes more than `room`, which becomes less.
nlohmann::json parsed(std::optional<Bytes> bytes, const std::string& name, std::size_t& room);

/// The files of one name in several folders, which are asked for at once.
std::vector<nlohmann::json> metadata_in(const Objects& objects,
                                        const std::vector<std::string>& folders,
                                        const std::string& name, std::size_t& room);

/// A member in its place, for metadata may be large; null if there is none, also of what is no
/// object.
const nlohmann::json& member(const nlohmann::json& object, const char* name);
/// The same for a text. Throws nlohmann::json::exception if it is another value.
std::string text_member(const nlohmann::json& object, const char* name, const char* otherwise);

/// Whole numbers, as of a shape. Throws BadMetadata, which names the member.
std::vector<std::int64_t> sizes_of(const nlohmann::json& list, const char* member);

/// What `open` returns; whatever is wrong with metadata becomes an io::InputError about `address`.
template <class F>
auto about(const std::string& address, F&& open) {
    try {
        return open();
    } catch (const BadMetadata& e) {
        throw io::InputError(address + ": " + e.what());
    } catch (const std::invalid_argument& e) {
        throw io::InputError(address + ": " + e.what() + "; its metadata are damaged");
    } catch (const nlohmann::json::exception&) {
        throw io::InputError(
            address + ": its metadata lack what they need; they are damaged: copy them again");
    }
}

}  // namespace palpate::stream
