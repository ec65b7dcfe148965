// Gets pages of a file that lies elsewhere from the caller (far_file.hpp).
#include "io/helper/far_file.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <optional>
#include <vector>

#include "io/helper/report.hpp"

namespace palpate::io {
namespace {

constexpr std::size_t most_pages = 256;

std::optional<std::uint64_t> size_of_file;
std::map<std::uint64_t, std::vector<std::byte>> kept_pages;  // by their number

const std::vector<std::byte>& page_at(std::uint64_t number) {
    if (const auto found = kept_pages.find(number); found != kept_pages.end()) return found->second;
    if (kept_pages.size() == most_pages) kept_pages.clear();
    const std::uint64_t offset = number * far_page;
    std::vector<std::byte> page(std::min(far_page, far_size() - offset));
    report({{"read", {offset, page.size()}}});
    for (std::size_t got = 0; got < page.size();) {
        const ssize_t more = read(samples_descriptor, page.data() + got, page.size() - got);
        if (more <= 0) std::_Exit(1);
        got += static_cast<std::size_t>(more);
    }
    return kept_pages.emplace(number, std::move(page)).first->second;
}

}  // namespace

void use_far_file(std::uint64_t size) {
    size_of_file = size;
}

bool is_far() {
    return size_of_file.has_value();
}

std::uint64_t far_size() {
    return size_of_file.value_or(0);
}

bool read_far(std::uint64_t offset, std::span<std::byte> to) {
    if (offset > far_size() || to.size() > far_size() - offset) return false;
    while (!to.empty()) {
        const std::vector<std::byte>& page = page_at(offset / far_page);
        const std::uint64_t at = offset % far_page;
        const std::size_t count = std::min(to.size(), page.size() - at);
        std::copy_n(page.begin() + static_cast<std::ptrdiff_t>(at), count, to.begin());
        to = to.subspan(count);
        offset += count;
    }
    return true;
}

}  // namespace palpate::io
