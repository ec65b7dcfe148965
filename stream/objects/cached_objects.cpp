// Remote objects with a cache on the disk.
#include <algorithm>
#include <atomic>
#include <random>
#include <span>
#include <string_view>

#include "stream/objects/disk_cache.hpp"
#include "stream/objects/remote_objects.hpp"

namespace palpate::stream {
namespace {

std::string random_text() {
    std::random_device device;
    return std::to_string(device()) + ' ' + std::to_string(device());
}

class CachedObjects : public Objects {
  public:
    CachedObjects(std::shared_ptr<const Objects> objects, const std::filesystem::path& folder,
                  std::uint64_t most_bytes)
        : objects_(std::move(objects)), cache_(folder, most_bytes) {}

    std::string name_of(const std::string& key) const override { return objects_->name_of(key); }
    std::optional<std::uint64_t> size_of(const std::string& key) const override {
        return objects_->size_of(key);
    }
    Traffic traffic() const override {
        Traffic traffic = objects_->traffic();
        traffic.cached = found_.load();
        return traffic;
    }

    std::string version() const override { return objects_->version(); }
    bool tells_changes() const override { return objects_->tells_changes(); }
    std::string note() const override {
        if (!cache_.problem().empty() || tells_changes()) return cache_.problem();
        return "the server does not tell when its data change (neither ETag nor Last-Modified): "
               "what the cache keeps is used in this session only";
    }

    std::optional<Bytes> get(const Wanted& wanted, std::stop_token stop) const override {
        if (!wanted.lasting) return objects_->get(wanted, std::move(stop));
        const std::string name = entry_name(wanted);
        if (!wanted.again) {
            auto bytes = cache_.find(name);
            if (bytes && wanted.identity) bytes = without_identity(wanted, *std::move(bytes));
            if (bytes && bytes->size() <= wanted.most) {
                found_.fetch_add(1, std::memory_order_relaxed);
                return bytes;
            }
        }
        auto bytes = objects_->get(wanted, std::move(stop));
        // That an object is not there is not kept: it may be written any time.
        if (bytes) cache_.put(name, wanted.identity ? with_identity(wanted, *bytes) : *bytes);
        return bytes;
    }

    std::vector<std::optional<Bytes>> get_all(std::span<const Wanted> wanted, std::uint64_t most,
                                              std::stop_token stop) const override {
        for (const Wanted& one : wanted) {
            if (one.lasting) return Objects::get_all(wanted, most, std::move(stop));
        }
        return objects_->get_all(wanted, most, std::move(stop));
    }

  private:
    /// Identities lie before the bytes, with a zero between.
    static Bytes with_identity(const Wanted& wanted, const Bytes& bytes) {
        const auto identity =
            std::as_bytes(std::span(wanted.identity->c_str(), wanted.identity->size() + 1));
        Bytes all(identity.begin(), identity.end());
        all.insert(all.end(), bytes.begin(), bytes.end());
        return all;
    }
    static Bytes without_identity(const Wanted& wanted, Bytes all) {
        const auto zero = std::ranges::find(all, std::byte{0});
        const std::string_view text(reinterpret_cast<const char*>(all.data()),
                                    static_cast<std::size_t>(zero - all.begin()));
        *wanted.identity = text;
        all.erase(all.begin(), zero == all.end() ? zero : zero + 1);
        return all;
    }

    /// A store that is written anew does not meet the entries of the old one. Without a validator
    /// an answer may not be used again later (RFC 9111, 4.3).
    std::string entry_name(const Wanted& wanted) const {
        std::string name = objects_->name_of(wanted.key) + '\n' + objects_->version();
        if (!tells_changes()) name += "\nsession " + session_;
        if (wanted.identity) name += "\nwith identity";
        if (wanted.range) {
            name += '\n' + std::to_string(wanted.range->offset) +
                    (wanted.range->from_end ? "e" : "+") + std::to_string(wanted.range->length);
        }
        return name;
    }

    std::shared_ptr<const Objects> objects_;
    DiskCache cache_;
    const std::string session_ = random_text();
    mutable std::atomic<std::uint64_t> found_ = 0;
};

}  // namespace

std::shared_ptr<const Objects> cached_objects(std::shared_ptr<const Objects> objects,
                                              const std::filesystem::path& folder,
                                              std::uint64_t most_bytes) {
    return std::make_shared<CachedObjects>(std::move(objects), folder, most_bytes);
}

}  // namespace palpate::stream
