// Files of metadata in JSON; see the header.
#include "stream/metadata_files.hpp"

namespace palpate::stream {

using Json = nlohmann::json;

Wanted metadata_file(const std::string& folder, const std::string& name) {
    constexpr std::uint64_t most_bytes = 8 << 20;
    return {key_below(folder, name), std::nullopt, most_bytes, false, false, true};
}

Json parsed(const std::optional<Bytes>& bytes, const std::string& name) {
    if (!bytes) return nullptr;
    try {
        return Json::parse(reinterpret_cast<const char*>(bytes->data()),
                           reinterpret_cast<const char*>(bytes->data() + bytes->size()));
    } catch (const Json::exception&) {
        throw io::InputError(name + ": is not JSON; the metadata are damaged: copy them again");
    }
}

}  // namespace palpate::stream
