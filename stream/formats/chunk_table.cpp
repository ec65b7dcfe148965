// Finds the chunks of an array in its one file. See the header.
#include "stream/formats/chunk_table.hpp"

#include <algorithm>

#include "palpate/stream/store.hpp"

namespace palpate::stream {
namespace {

constexpr std::int64_t page_side = 16;  // [chunks]
constexpr std::size_t most_pages = 256;

}  // namespace

std::optional<io::ChunkPlace> ChunkTable::find(std::span<const std::int64_t> chunk,
                                               const std::stop_token& stop) const {
    PageIndex page{}, first{}, count{};
    std::size_t at = 0;
    for (std::size_t a = 0; a < 3; ++a) {
        page[a] = chunk[a] / page_side;
        first[a] = page[a] * page_side;
        count[a] = std::min(page_side, chunks_[a] - first[a]);
        at =
            at * static_cast<std::size_t>(count[a]) + static_cast<std::size_t>(chunk[a] - first[a]);
    }
    const UnpackingRoom::Share own(turn_, 1, stop);
    auto found = pages_.find(page);
    if (found == pages_.end()) {
        const UnpackingRoom::Share turn(file_->turn, 1, stop);
        found = pages_.emplace(page, file_->file.locate(id_, first, count, stop)).first;
        order_.push_back(page);
        if (order_.size() > most_pages) {
            pages_.erase(order_.front());
            order_.pop_front();
        }
    }
    const io::ChunkPlace& place = found->second[at];
    if (place.length == 0) return std::nullopt;
    return place;
}

}  // namespace palpate::stream
