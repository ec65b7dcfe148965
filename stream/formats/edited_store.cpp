// A store with edits on top, and the note that names its original. See the header.
#include "stream/formats/edited_store.hpp"

#include <nlohmann/json.hpp>
#include <vector>

#include "io/json_text.hpp"
#include "io/path_json.hpp"
#include "io/system/number.hpp"
#include "io/system/own_names.hpp"
#include "palpate/io/address.hpp"
#include "palpate/io/error.hpp"
#include "palpate/io/sequence.hpp"
#include "palpate/stream/read_files.hpp"
#include "stream/formats/codecs.hpp"
#include "stream/formats/content.hpp"
#include "stream/formats/stores.hpp"
#include "stream/objects/held_folder.hpp"
#include "stream/objects/remote_objects.hpp"
#include "stream/sample_bytes.hpp"

namespace palpate::stream {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::uintmax_t longest_note = std::uintmax_t{64} << 20;
/// What its values may take: the list of chunks of large edits is longer than io::parsed_json()
/// allows.
constexpr std::size_t most_note_bytes = 8 * longest_note;
constexpr std::size_t most_edited_levels = 64;

template <class Vector>
Json list_of(const Vector& v) {
    return {v[0], v[1], v[2]};
}
template <class Vector>
Vector three_of(const Json& list) {
    if (!list.is_array() || list.size() != 3) throw std::invalid_argument("not three numbers");
    using Number = typename Vector::Scalar;
    return {list[0].get<Number>(), list[1].get<Number>(), list[2].get<Number>()};
}

/// Without "..", links on the way and a slash at the end, so that one can be relative to another.
fs::path placed(const fs::path& path) {
    const fs::path whole = fs::absolute(path.has_filename() ? path : path.parent_path());
    std::error_code error;
    const fs::path folder = fs::weakly_canonical(whole.parent_path(), error);
    return error ? whole : folder / whole.filename();
}

/// Of all members but those about the place of the original, which a person may correct.
std::uint32_t note_checksum(Json note) {
    for (const char* of_place : {"checksum", "of", "beside", "secrets"}) note.erase(of_place);
    const std::string text = note.dump();
    return crc32c_of(std::as_bytes(std::span(text)));
}

/// A chunk, as a path from the folder.
fs::path place_of(std::size_t level, const Index3& chunk) {
    return fs::path(std::to_string(level)) / "c" / std::to_string(chunk[2]) /
           std::to_string(chunk[1]) / std::to_string(chunk[0]);
}

Json json_of(const EditsNote& note, const fs::path& out) {
    const StoreOptions& options = note.of.options;
    const std::string kept = io::address_to_keep(note.of.address);
    Json json = {
        {"of", io::json_of_path(kept)}, {"content", note.content},
        {"level", note.level},          {"channel", options.channel},
        {"time", options.time},         {"bounds", {note.bounds.minimum, note.bounds.maximum}},
        {"chunk", note.chunk}};
    if (note.lacks_secrets || kept != note.of.address) json["secrets"] = "left out";
    if (!io::is_web_address(note.of.address)) {
        json["of"] = io::json_of_path(fs::absolute(note.of.address));
        const fs::path beside =
            placed(note.of.address).lexically_relative(placed(out).parent_path());
        if (!beside.empty()) json["beside"] = io::json_of_path(beside);
    }
    if (options.raw) {
        json["raw"] = {{"size", list_of(options.raw->size)},
                       {"type", name_of(options.raw->type)},
                       {"spacing", list_of(options.raw->spacing)},
                       {"skip", options.raw->skip},
                       {"big_endian", options.raw->big_endian}};
    }
    if (!note.guessed.empty()) json["guessed"] = note.guessed;
    if (options.forbidden_is_missing) json["forbidden_is_missing"] = true;
    if (options.spacing) json["spacing"] = list_of(*options.spacing);
    if (!options.orientation.empty()) json["orientation"] = options.orientation;
    for (const ChunkSet& level : note.chunks) {
        Json chunks = Json::array();
        for (const auto& chunk : level) {
            for (const int at : chunk) chunks.push_back(at);
        }
        json["chunks"].push_back(std::move(chunks));
    }
    json["checksum"] = note_checksum(json);
    return json;
}

/// `folder`: where the note lies. What does not come from the note is as `options` say.
EditsNote note_from(const Json& json, const fs::path& folder, const StoreOptions& options) {
    EditsNote note;
    note.is_whole = json.contains("checksum");
    if (note.is_whole && json["checksum"] != note_checksum(json)) {
        throw std::invalid_argument("does not have its checksum");
    }
    note.of = {io::path_from_json(json.at("of")).string(), options};
    note.content = json.value("content", std::string());
    note.guessed = json.value("guessed", std::string());
    note.chunk = json.value("chunk", note.chunk);
    if (note.chunk < 1) throw std::invalid_argument("chunks without samples");
    note.lacks_secrets = json.contains("secrets") && io::is_web_address(note.of.address) &&
                         io::address_to_keep(note.of.address) == note.of.address;
    const fs::path relative = io::path_from_json(json.value("beside", Json("")));
    const fs::path beside = placed(folder).parent_path() / relative;
    std::error_code error;
    if (!relative.empty() && fs::exists(beside, error)) note.beside = beside.string();
    StoreOptions& of = note.of.options;
    of.channel = json.at("channel").get<int>();
    of.time = json.at("time").get<int>();
    of.forbidden_is_missing |= json.value("forbidden_is_missing", false);
    of.raw.reset();
    of.spacing.reset();
    if (json.contains("raw")) {
        const Json& raw = json["raw"];
        of.raw = io::RawLayout{
            three_of<Index3>(raw.at("size")), sample_type_from(raw.at("type").get<std::string>()),
            three_of<Vec3>(raw.at("spacing")), raw.at("skip").get<std::uint64_t>(),
            raw.at("big_endian").get<bool>()};
    }
    if (json.contains("spacing")) of.spacing = three_of<Vec3>(json["spacing"]);
    of.orientation = json.value("orientation", std::string());
    note.level = json.at("level").get<int>();
    note.bounds = {json.at("bounds").at(0).get<double>(), json.at("bounds").at(1).get<double>()};
    const Json& levels = json.at("chunks");
    if (!levels.is_array() || levels.size() > most_edited_levels) {
        throw std::invalid_argument("more than 64 levels");
    }
    for (const Json& level : levels) {
        const auto numbers = level.get<std::vector<int>>();
        if (numbers.size() % 3 != 0) throw std::invalid_argument("not three numbers a chunk");
        ChunkSet& chunks = note.chunks.emplace_back();
        for (std::size_t i = 0; i < numbers.size(); i += 3) {
            chunks.insert(Index3(numbers[i], numbers[i + 1], numbers[i + 2]));
        }
    }
    return note;
}

EditsNote read_note(const fs::path& folder, const StoreOptions& options) {
    const fs::path path = folder / io::edits_note;
    const auto bytes = folder_objects(folder)->get({io::edits_note, {}, longest_note}, {});
    if (!bytes) throw io::InputError(path.string() + ": is not there");
    const std::string_view text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
    std::size_t room = most_note_bytes;
    try {
        return note_from(io::parsed_json_within(room, text), folder, options);
    } catch (const std::exception&) {  // of the library, or above
        throw io::InputError(path.string() +
                             ": is damaged; without it the edits are of no known volume");
    }
}

/// A chunk that is gone would count as one of zeros. Earlier versions did not store those.
void check_stored(const EditsNote& note, const fs::path& folder) {
    std::error_code error;
    for (std::size_t l = 0; note.is_whole && l < note.chunks.size(); ++l) {
        for (const Index3& chunk : note.chunks[l]) {
            const fs::path file = folder / place_of(l, chunk);
            if (fs::is_regular_file(file, error)) continue;
            throw io::InputError(file.string() +
                                 ": is not there, so that an edit is missing; copy the folder "
                                 "again");
        }
    }
}

void check_chunks(const EditsNote& note, const StoreInfo& original) {
    const std::size_t levels = original.levels.size();
    const auto level = static_cast<std::size_t>(note.level);
    if (note.level < 0 || level >= levels || note.chunks.empty() ||
        note.chunks.size() > levels - level) {
        throw std::invalid_argument("has other levels now");
    }
    for (std::size_t i = 0; i < note.chunks.size(); ++i) {
        const Index3& size = original.levels[level + i].geometry.size;
        const Index3 last = (size.array() - 1) / note.chunk;
        for (const Index3& chunk : note.chunks[i]) {
            if (chunk.minCoeff() < 0 || (chunk.array() > last.array()).any()) {
                throw std::invalid_argument("has another size now");
            }
        }
    }
}

/// Another volume of the same size may have taken the original's place.
void check_content(const std::stop_token& stop, const Store& original, const EditsNote& note) {
    const auto levels = static_cast<int>(original.info().levels.size());
    if (note.content.empty() || note.level < 0 || note.level >= levels) return;
    if (content_of(original, note.level, stop) == note.content) return;
    throw std::invalid_argument("holds other data than when they were saved");
}

}  // namespace

EditedStore::EditedStore(std::shared_ptr<const Store> original, std::shared_ptr<const Store> chunks,
                         EditsNote note)
    : original_(std::move(original)), chunks_(std::move(chunks)), note_(std::move(note)) {
    info_ = original_->info();
    check_chunks(note_, info_);
    info_.levels.erase(info_.levels.begin(), info_.levels.begin() + note_.level);
    info_.levels.resize(note_.chunks.size());
    // Else one of ours would be unpacked for each of several smaller ones.
    for (Level& level : info_.levels) {
        const Index3 times = (note_.chunk - 1 + level.chunk.array()) / level.chunk.array();
        level.chunk = level.chunk.cwiseProduct(times);
    }
    const StoreInfo& ours = chunks_->info();
    bool fits = ours.type == info_.type && ours.levels.size() >= info_.levels.size();
    for (std::size_t i = 0; fits && i < info_.levels.size(); ++i) {
        fits = ours.levels[i].geometry.size == info_.levels[i].geometry.size;
    }
    if (!fits) throw std::invalid_argument("has another size or type now");
    info_.notes.push_back("it is " + info_.address + " with edits");
    if (note_.lacks_secrets) {
        info_.notes.emplace_back(
            "the address of the original was saved without its password and query");
    }
    if (note_.content.empty()) {
        info_.notes.push_back(
            "the edits do not identify their original: they were rescued without it, or are "
            "of an earlier version");
    }
    if (!note_.guessed.empty()) {
        info_.notes.push_back(
            "how the coarser levels of its original were made cannot be told: each sample above "
            "an edit is " +
            std::string(note_.guessed == guessed_mean ? "the mean of finer samples"
                                                      : "one of the finer samples"));
    }
    info_.address = ours.address;
    info_.channels.clear();
    info_.times = 1;
    if (info_.range) {
        info_.range->minimum = std::min(info_.range->minimum, note_.bounds.minimum);
        info_.range->maximum = std::max(info_.range->maximum, note_.bounds.maximum);
    }
}

void EditedStore::read(int level, const SampleBox& box, std::span<std::byte> out,
                       std::stop_token stop) const {
    const auto at = static_cast<std::size_t>(level);
    const Geometry& grid = info_.levels.at(at).geometry;
    check_request(grid, box, info_.type, out.size());
    const ChunkSet& edited = note_.chunks[at];
    const Index3 piece = Index3::Constant(note_.chunk);
    bool whole = true;
    for_each_piece(piece, box, [&](const auto& chunk, const SampleBox&) {
        whole = whole && edited.contains(chunk);
    });
    if (!whole) original_->read(note_.level + level, box, out, stop);
    Bytes samples;
    for_each_piece(piece, box, [&](const auto& chunk, const SampleBox& part) {
        if (!edited.contains(chunk)) return;
        samples.resize(bytes_of(part, info_.type));
        chunks_->read(level, part, samples, stop);
        copy_box(part, samples.data(), box, out.data(), size_of(info_.type));
    });
}

bool holds_edits(const fs::path& folder) {
    std::error_code error;
    return fs::is_regular_file(folder / io::edits_note, error);
}

std::string unlisted_chunk(const fs::path& folder) {
    const EditsNote note = read_note(folder, {});
    std::error_code error;
    fs::recursive_directory_iterator entry(folder, error);
    for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
        const fs::path file = entry->path().lexically_relative(folder);
        std::vector<std::string> names;  // LEVEL/c/Z/Y/X
        for (const fs::path& name : file) names.push_back(name.string());
        if (names.size() != 5 || names[1] != "c") continue;
        const auto at = [&](std::size_t i) { return io::number_from<int>(names[i]).value_or(-1); };
        const auto level = static_cast<std::size_t>(at(0));
        const bool is_listed =
            level < note.chunks.size() && note.chunks[level].contains(Index3(at(4), at(3), at(2)));
        if (!is_listed) return file.string();
    }
    return "";
}

namespace {

std::shared_ptr<const Store> open_original(const std::stop_token& stop, const std::string& folder,
                                           const EditsNote& note) {
    try {
        return open_until(stop, note.of.address, note.of.options);
    } catch (const io::InputError& e) {
        if (!note.lacks_secrets) throw;
        throw io::InputError(std::string(e.what()) +
                             "; this address was saved without its password and query: write the "
                             "whole one into " +
                             (fs::path(folder) / io::edits_note).string());
    }
}

std::shared_ptr<const Store> open_with_original(const std::stop_token& stop,
                                                const std::string& folder, EditsNote note) {
    if (!io::is_web_address(note.of.address) && holds_edits(note.of.address)) {
        throw io::InputError(folder + ": is of a volume that is of edits itself: it is damaged");
    }
    auto original = open_original(stop, folder, note);
    auto chunks = open_zarr(folder_objects(folder, stop), folder, {});
    try {
        check_content(stop, *original, note);
        if (!chunks) throw std::invalid_argument("is there, but the edited chunks are not");
        return std::make_shared<EditedStore>(std::move(original), std::move(chunks),
                                             std::move(note));
    } catch (const std::invalid_argument& e) {
        throw io::InputError(folder + ": its original, " + note.of.address + ", " + e.what() +
                             ": the edits do not fit it; put the original back");
    }
}

}  // namespace

std::shared_ptr<const Store> open_edits(const std::stop_token& stop, const std::string& folder,
                                        const StoreOptions& options) {
    EditsNote note = read_note(folder, options);
    check_stored(note, folder);
    if (note.beside.empty()) return open_with_original(stop, folder, std::move(note));
    EditsNote moved = note;
    moved.of.address = note.beside;
    try {
        return open_with_original(stop, folder, std::move(moved));
    } catch (const io::InputError&) {
        // Another volume may lie there while the right one is where it was.
        std::error_code error;
        if (note.of.address == note.beside || !fs::exists(note.of.address, error)) throw;
    }
    return open_with_original(stop, folder, std::move(note));
}

bool is_read_from(const fs::path& path, const fs::path& source) {
    if (io::is_read_from(path, source)) return true;
    if (!holds_edits(source)) return false;
    try {
        const EditsNote note = read_note(source, {});
        return io::is_read_from(path, note.of.address) ||
               (!note.beside.empty() && io::is_read_from(path, note.beside));
    } catch (const io::InputError&) {  // opening them says why
        return false;
    }
}

void write_note(const fs::path& folder, const fs::path& out, const EditsNote& note) {
    const std::string text = json_of(note, out).dump(1);
    HeldFolder(folder).put(io::edits_note, std::as_bytes(std::span(text)));
}

}  // namespace palpate::stream
