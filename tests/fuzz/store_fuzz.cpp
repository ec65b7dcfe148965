// Any metadata, shards and chunks make a store whose samples can be read, or an error of one line.
// The input is JSON with the files of a folder of Zarr or N5: {"s0/attributes.json": {...},
// "c/0/0/0": "00ff.."}. Metadata is plain JSON, and bytes are hexadecimal digits. "located" is the
// answer of the helper process for a file of HDF5 or TIFF.
#include <cctype>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "fuzz/require.hpp"
#include "io/chunked_image.hpp"
#include "palpate/io/error.hpp"
#include "stream/formats/located_file.hpp"
#include "stream/formats/stores.hpp"

namespace {

using namespace palpate::stream;
using Json = nlohmann::json;

constexpr std::uint64_t most_bytes = 1 << 20;  // that an object may have; longer ones are not there

unsigned digit(char c) {
    const auto byte = static_cast<unsigned char>(c);
    return std::isdigit(byte) != 0 ? byte - '0' : (byte - 'a' + 10U) & 15U;
}

class JsonObjects : public Objects {
  public:
    explicit JsonObjects(Json all) : all_(std::move(all)) {}

    std::string name_of(const std::string& key) const override { return "store/" + key; }
    Traffic traffic() const override { return {}; }
    std::optional<std::uint64_t> size_of(const std::string& key) const override {
        return all_.contains(key) ? std::optional(bytes_of(all_[key]).size()) : std::nullopt;
    }

    std::optional<Bytes> get(const Wanted& wanted, std::stop_token) const override {
        // No name leads out of the folder.
        require(("/" + wanted.key + "/").find("/../") == std::string::npos);
        if (!all_.contains(wanted.key)) return std::nullopt;
        if (!wanted.probe && wanted.most > most_bytes) return std::nullopt;
        Bytes bytes = bytes_of(all_[wanted.key]);
        if (!wanted.range) return bytes;
        const ByteRange& range = *wanted.range;
        if (range.length > bytes.size() ||
            (!range.from_end && range.offset > bytes.size() - range.length)) {
            throw palpate::io::InputError(name_of(wanted.key) + ": is shorter than that");
        }
        const std::size_t at = range.from_end ? bytes.size() - range.length : range.offset;
        return Bytes(bytes.begin() + std::ptrdiff_t(at),
                     bytes.begin() + std::ptrdiff_t(at + range.length));
    }

  private:
    static Bytes bytes_of(const Json& value) {
        Bytes bytes;
        if (!value.is_string()) {
            for (const char c : value.dump(-1, ' ', true, Json::error_handler_t::replace)) {
                bytes.push_back(static_cast<std::byte>(c));
            }
            return bytes;
        }
        const auto& text = value.get_ref<const std::string&>();
        for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
            bytes.push_back(static_cast<std::byte>(digit(text[i]) << 4 | digit(text[i + 1])));
        }
        return bytes;
    }

    Json all_;
};

void check_info(const StoreInfo& info) {
    require(!info.levels.empty() && info.times >= 1 && std::isfinite(info.frame_interval));
    for (const Level& level : info.levels) {
        palpate::check(level.geometry);
        require((level.chunk.array() >= 1).all());
    }
    for (const std::string& note : info.notes) require_one_line(note);
    require(!info.range || info.range->minimum <= info.range->maximum);
}

/// Reads a few samples at both ends of a level.
void read_ends(const Store& store, int level) {
    const palpate::Index3 last =
        store.info().levels[static_cast<std::size_t>(level)].geometry.size.array() - 1;
    const palpate::Index3 few = last.cwiseMin(palpate::Index3(2, 2, 2));
    for (const auto& box :
         {palpate::SampleBox{palpate::Index3::Zero(), few}, palpate::SampleBox{last - few, last}}) {
        const auto count = static_cast<std::size_t>((few.array() + 1).prod());
        std::vector<std::byte> samples(count * palpate::size_of(store.info().type));
        try {
            store.read(level, box, samples, {});
        } catch (const palpate::io::InputError& error) {
            require_one_line(error.what());
        }
    }
}

template <class Open>
void try_store(Open&& open) {
    try {
        const std::shared_ptr<const Store> store = open();
        if (!store) return;
        check_info(store->info());
        for (std::size_t level = 0; level < store->info().levels.size(); ++level) {
            read_ends(*store, static_cast<int>(level));
        }
    } catch (const palpate::io::InputError& error) {
        require_one_line(error.what());
    }
}

void try_located(const Json& json) {
    try {
        const auto image = palpate::io::chunked_image_from(json);
        const std::string name = "file.ims";
        const auto file = std::make_shared<LocatedFile>(palpate::io::ChunkFile(name), name);
        check_info(located_volume(image, file, {}).info);
    } catch (const Json::exception&) {  // the caller says that the helper gave no sensible answer
    } catch (const std::bad_optional_access&) {
    } catch (const std::exception& error) {
        require_one_line(error.what());
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    Json all = Json::parse(data, data + size, nullptr, false);
    if (!all.is_object()) return 0;
    if (all.contains("located")) try_located(all["located"]);
    const auto objects = std::make_shared<const JsonObjects>(std::move(all));
    try_store([&] { return open_zarr(objects, "store", {}); });
    try_store([&] { return open_n5(objects, "store", {}); });
    StoreOptions other;
    other.channel = other.time = 1;
    other.spacing = palpate::Vec3(1, 2, 3);
    try_store([&] { return open_zarr(objects, "store", other); });
    try_store([&] { return open_n5(objects, "store", other); });
    return 0;
}
