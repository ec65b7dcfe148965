// Finds out whether the chunks of a Zarr array lie as its metadata say. See the header.
#include <algorithm>

#include "io/words.hpp"
#include "stream/formats/metadata_files.hpp"
#include "stream/formats/zarr_metadata.hpp"

namespace palpate::stream {
namespace {

/// How chunks are named: "0.0.0", "0/0/0", "c/0/0/0", ...
struct Layout {
    std::string prefix;
    char separator;
    bool operator==(const Layout&) const = default;
};

/// `count` whole numbers with dots between them.
bool are_numbers(std::string_view text, std::size_t count) {
    if (text.empty() || text.find_first_not_of("0123456789.") != text.npos) return false;
    if (text.front() == '.' || text.back() == '.' || text.find("..") != text.npos) return false;
    return static_cast<std::size_t>(std::ranges::count(text, '.')) + 1 == count;
}

/// False if a folder is known to hold no chunk that is named so.
bool may_hold(const Objects& objects, const std::string& folder, const Layout& layout,
              std::size_t axes) {
    if (layout.prefix.ends_with('/')) {
        return may_hold(objects, key_below(folder, layout.prefix), {"", layout.separator}, axes);
    }
    const bool nested = layout.separator == '/' && axes > 1;
    const std::size_t numbers = nested ? 1 : axes;
    bool found = false;
    const bool listed = objects.list(folder, [&](const std::string& name, bool is_folder) {
        found = is_folder == nested && name.starts_with(layout.prefix) &&
                are_numbers(std::string_view(name).substr(layout.prefix.size()), numbers) &&
                (!nested || may_hold(objects, key_below(folder, name), {"", '/'}, axes - 1));
        return found;
    });
    return found || !listed;
}

std::string first_name(ChunkedArray array) {
    array.folder.clear();
    return key_of(array, std::vector<std::int64_t>(array.axes(), 0));
}

}  // namespace

void take_stored_layout(const Objects& objects, ChunkedArray& array,
                        std::vector<std::string>& notes) {
    const Layout declared{array.prefix, array.separator};
    if (may_hold(objects, array.folder, declared, array.axes())) return;
    std::vector<ChunkedArray> stored;
    for (const Layout& layout : {Layout{"", '.'}, Layout{"", '/'}, Layout{"c/", '/'},
                                 Layout{"c.", '.'}, Layout{"c/", '.'}}) {
        if (layout == declared || !may_hold(objects, array.folder, layout, array.axes())) continue;
        ChunkedArray& other = stored.emplace_back(array);
        other.prefix = layout.prefix;
        other.separator = layout.separator;
    }
    const std::string level =
        array.folder.empty() ? "it" : "its level '" + io::one_line(array.folder) + "'";
    if (stored.size() > 1) {
        throw BadMetadata(level + " has chunks named " + first_name(stored[0]) + " and " +
                          first_name(stored[1]) + ", and none named " + first_name(array) +
                          " as its metadata say; store it again");
    }
    if (stored.empty()) {
        notes.push_back(level + " has no chunk at all: all of it is the fill value");
        return;
    }
    io::add_note(notes, "its chunks are named " + first_name(stored[0]) + ", not " +
                            first_name(array) + " as its metadata say: they were read");
    array = stored[0];
}

}  // namespace palpate::stream
