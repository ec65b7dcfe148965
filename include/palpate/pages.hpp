// Stage 2, pages: a table over a box of places most of which are empty, also for stage 3. Versions
// of it share the pages that did not change (copy on write).
#pragma once

#include <array>
#include <memory>
#include <span>
#include <stdexcept>
#include <unordered_map>
#include <vector>

#include "palpate/volume.hpp"

namespace palpate {

/// A value; copies share their pages of (2^shift)^3 places. An entry is empty where it converts to
/// false.
template <class Entry, int shift>
class Pages {
  public:
    struct Change {
        Index3 place;
        Entry to;
    };

    /// All empty.
    explicit Pages(const Index3& count)
        : count_(count),
          along_((count + Index3::Constant(edge - 1)) / edge),
          pages_(static_cast<std::size_t>(along_.template cast<std::int64_t>().prod())) {}

    /// Places along each axis.
    const Index3& count() const { return count_; }
    /// How many are not empty.
    std::size_t size() const { return size_; }
    /// Null where a whole page is empty. The place must be inside.
    const Entry* at(const Index3& place) const {
        const Page* page = pages_[page_of(place)].get();
        return page ? &(*page)[place_in_page(place)] : nullptr;
    }

    /// The same but for these changes. A place outside throws std::out_of_range.
    Pages with(std::span<const Change> changes) const {
        Pages after = *this;
        std::unordered_map<std::size_t, std::shared_ptr<Page>> changed;
        for (const Change& change : changes) {
            if ((change.place.array() < 0).any() ||
                (change.place.array() >= count_.array()).any()) {
                throw std::out_of_range("a brick outside the grid");
            }
            const std::size_t at = page_of(change.place);
            std::shared_ptr<Page>& page = changed[at];
            if (!page) {
                page = pages_[at] ? std::make_shared<Page>(*pages_[at]) : std::make_shared<Page>();
                after.pages_[at] = page;
            }
            Entry& entry = (*page)[place_in_page(change.place)];
            after.size_ += change.to ? 1 : 0;
            after.size_ -= entry ? 1 : 0;
            entry = change.to;
        }
        for (const auto& [at, page] : changed) {
            bool empty = true;
            for (const Entry& entry : *page) empty = empty && !entry;
            if (empty) after.pages_[at].reset();
        }
        return after;
    }

    /// Calls visit(place, mine, theirs) for each place of the pages that `other`, of as many
    /// places, does not share.
    template <class Visit>
    void for_each_apart(const Pages& other, Visit&& visit) const {
        const Entry none{};
        for (std::size_t at = 0; at < pages_.size(); ++at) {
            const Page *mine = pages_[at].get(), *theirs = other.pages_[at].get();
            if (mine == theirs) continue;
            for (std::size_t in = 0; in < places; ++in) {
                visit(place_of(at, in), mine ? (*mine)[in] : none, theirs ? (*theirs)[in] : none);
            }
        }
    }
    /// Bytes of the table itself that `other` does not share.
    std::size_t bytes_apart(const Pages& other) const {
        std::size_t bytes = pages_.size() * sizeof pages_[0];
        for (std::size_t at = 0; at < pages_.size(); ++at) {
            bytes += pages_[at] && pages_[at] != other.pages_[at] ? sizeof(Page) : 0;
        }
        return bytes;
    }

  private:
    static constexpr int edge = 1 << shift;
    static constexpr std::size_t places = std::size_t{1} << (3 * shift);
    using Page = std::array<Entry, places>;

    std::size_t page_of(const Index3& place) const {
        return (std::size_t(place[2] >> shift) * std::size_t(along_[1]) +
                std::size_t(place[1] >> shift)) *
                   std::size_t(along_[0]) +
               std::size_t(place[0] >> shift);
    }
    static std::size_t place_in_page(const Index3& place) {
        constexpr int mask = edge - 1;
        return std::size_t((((place[2] & mask) << shift | (place[1] & mask)) << shift) |
                           (place[0] & mask));
    }
    Index3 place_of(std::size_t page, std::size_t in) const {
        const auto p = static_cast<int>(page), i = static_cast<int>(in);
        const Index3 first(p % along_[0], p / along_[0] % along_[1], p / along_[0] / along_[1]);
        constexpr int mask = edge - 1;
        return first * edge + Index3(i & mask, i >> shift & mask, i >> (2 * shift));
    }

    Index3 count_, along_;  // places and pages
    std::size_t size_ = 0;
    std::vector<std::shared_ptr<const Page>> pages_;  // null: all of its places are empty
};

}  // namespace palpate
