// Sources as the names and values that recordings and session files keep.
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "io/system/number.hpp"
#include "io/tiff_peek.hpp"
#include "palpate/io/address.hpp"
#include "palpate/io/orientation.hpp"
#include "palpate/io/raw_options.hpp"
#include "palpate/run/source.hpp"

namespace palpate::run {
namespace {

constexpr std::string_view synthetic_prefix = "synthetic:";
constexpr std::string_view live_prefix = "live:";

using Names = std::map<std::string, std::string>;

std::string value_of(const Names& names, const char* name) {
    const auto found = names.find(name);
    return found == names.end() ? std::string() : found->second;
}

std::string number_text(double value) {
    std::string text;
    io::append_number(text, value);
    return text;
}

std::string spacing_text(const Vec3& spacing) {
    return number_text(spacing[0]) + "," + number_text(spacing[1]) + "," + number_text(spacing[2]);
}

void add_names(Names& names, const FileSource& file) {
    if (file.raw) {
        const Index3& size = file.raw->size;
        names["dims"] =
            std::to_string(size[0]) + "x" + std::to_string(size[1]) + "x" + std::to_string(size[2]);
        names["type"] = name_of(file.raw->type);
        if (file.raw->skip > 0) names["skip"] = std::to_string(file.raw->skip);
        if (file.raw->big_endian) names["byte-order"] = "big";
    }
    if (file.spacing) names["spacing"] = spacing_text(*file.spacing);
    if (!file.orientation.empty()) names["orientation"] = file.orientation;
    if (!file.series.empty()) names["series"] = file.series;
}

void add_names(Names& names, const SyntheticSource& synthetic) {
    if (synthetic.type) names["type"] = name_of(*synthetic.type);
}

void add_names(Names&, const LiveSource&) {}

void add_names(Names& names, const StoreSource& store) {
    add_names(
        names,
        FileSource{{}, store.options.raw, store.options.spacing, {}, store.options.orientation});
    names["level"] = std::to_string(store.loader.level);
    if (store.options.channel > 0) names["channel"] = std::to_string(store.options.channel);
    if (store.loader.whole_process) names["memory"] = std::to_string(store.loader.memory);
    if (store.loader.coarse_first) names["coarse-first"] = "yes";
    if (store.all_times) names["all-times"] = "yes";
    if (store.options.forbidden_is_missing) names["forbidden-is-missing"] = "yes";
    const std::string kept = io::address_to_keep(store.address);
    if (store.lacks_secrets || kept != store.address) names["secrets"] = "left out";
    names["volume"] = kept;
}

/// Options that only files have.
FileSource with_layout(FileSource file, const Names& names) {
    const std::string dims = value_of(names, "dims"), type = value_of(names, "type");
    const std::string spacing = value_of(names, "spacing");
    const auto skip = io::number_from<std::uint64_t>(value_of(names, "skip")).value_or(0);
    const std::string order = value_of(names, "byte-order");
    if (!order.empty() && order != "little" && order != "big") {
        throw std::invalid_argument("byte-order " + order + ": it is little or big");
    }
    if (!dims.empty() || !type.empty()) {
        file.raw = io::raw_layout_from(dims, type, spacing, skip);
        file.raw->big_endian = order == "big";
    }
    if (!spacing.empty()) file.spacing = io::spacing_from(spacing);
    file.orientation = value_of(names, "orientation");
    if (!file.orientation.empty()) (void)io::direction_from(file.orientation);
    file.series = value_of(names, "series");
    return file;
}

/// A plain file of at least this size is read while it is touched [bytes].
constexpr std::uintmax_t large_file = std::uintmax_t{2} << 30;

bool is_large(const std::string& path) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    return !error && size >= large_file;
}

int count_of(const Names& names, const char* name) {
    return io::number_from<int>(value_of(names, name)).value_or(0);
}

/// The store that a file, folder or address is read as; nothing: it is read as a whole.
std::optional<StoreSource> store_of(const FileSource& file, const Names& names) {
    stream::StoreOptions options;
    options.raw = file.raw;
    options.spacing = file.spacing;
    options.orientation = file.orientation;
    options.channel = count_of(names, "channel");
    const bool asked = names.contains("level") || names.contains("memory") ||
                       names.contains("all-times") ||
                       (options.channel > 0 && io::is_tiff_name(file.path));  // may have channels
    const bool chunked = !file.raw && stream::is_chunked(file.path);
    if (!asked && !chunked && !is_large(file.path)) return std::nullopt;
    if (!io::is_web_address(file.path) && !stream::is_store(file.path, options)) {
        if (!asked) return std::nullopt;
        throw std::invalid_argument(
            file.path +
            ": level, channel, memory and all times are for what can be read in parts "
            "(docs/streaming.md); this is read as a whole");
    }
    StoreSource store{file.path, options, {}};
    store.all_times = value_of(names, "all-times") == "yes";
    store.options.forbidden_is_missing = value_of(names, "forbidden-is-missing") == "yes";
    store.lacks_secrets =
        names.contains("secrets") && io::address_to_keep(store.address) == store.address;
    store.loader.level = count_of(names, "level");
    if (const auto memory = io::number_from<std::uint64_t>(value_of(names, "memory"))) {
        store.loader.memory = *memory;
        store.loader.whole_process = true;
    }
    store.loader.coarse_first = value_of(names, "coarse-first") == "yes";
    // Only a network has to be waited for; each thread has a stack in memory that is locked.
    if (!io::is_web_address(file.path)) store.loader.threads = 4;
    return store;
}

SyntheticSource with_type(SyntheticSource synthetic, const Names& names) {
    if (names.contains("dims") || names.contains("spacing") || names.contains("orientation")) {
        throw std::invalid_argument(
            "dims, spacing and orientation are for files; a synthetic volume's size is part of its "
            "name: "
            "synthetic:NAME:WxHxD");
    }
    const auto skip = io::number_from<std::uint64_t>(value_of(names, "skip")).value_or(0);
    if (names.contains("series") || names.contains("byte-order") || skip != 0) {
        throw std::invalid_argument("series, byte-order and skip are for files");
    }
    const std::string type = value_of(names, "type");
    if (!type.empty()) synthetic.type = sample_type_from(type);
    return synthetic;
}

struct NameOf {
    std::string operator()(const FileSource& file) const { return file.path; }
    std::string operator()(const SyntheticSource& synthetic) const {
        return std::string(synthetic_prefix) + synthetic.scene;
    }
    std::string operator()(const LiveSource& live) const {
        return std::string(live_prefix) + live.path;
    }
    std::string operator()(const StoreSource& store) const { return store.address; }
};

}  // namespace

std::filesystem::path place_of(const Source& source) {
    if (const auto* file = std::get_if<FileSource>(&source.from)) return file->path;
    if (const auto* live = std::get_if<LiveSource>(&source.from)) return live->path;
    return {};
}

std::string name_of(const Source& source) {
    return std::visit(NameOf{}, source.from);
}

Source source_named(const std::string& name) {
    Source source;
    if (name.starts_with(synthetic_prefix)) {
        source.from = SyntheticSource{name.substr(synthetic_prefix.size()), {}};
    } else if (name.starts_with(live_prefix)) {
        source.from = LiveSource{name.substr(live_prefix.size())};
    } else {
        source.from = FileSource{name, {}, {}, {}};
    }
    return source;
}

std::map<std::string, std::string> to_names(const Source& source) {
    Names names{{"volume", name_of(source)}};
    std::visit([&](const auto& from) { add_names(names, from); }, source.from);
    if (source.frame) names["time-step"] = std::to_string(*source.frame);
    if (source.frame_interval) names["frame-interval"] = number_text(*source.frame_interval);
    if (source.smooth > 0) names["smooth"] = std::to_string(source.smooth);
    if (source.dequantize > 0) names["dequantize"] = std::to_string(source.dequantize);
    if (source.prefilter) names["prefilter"] = "yes";
    return names;
}

Source source_from(const std::map<std::string, std::string>& names) {
    Source source = source_named(value_of(names, "volume"));
    if (auto* file = std::get_if<FileSource>(&source.from)) {
        *file = with_layout(std::move(*file), names);
        if (auto store = store_of(*file, names)) source.from = std::move(*store);
    } else if (auto* synthetic = std::get_if<SyntheticSource>(&source.from)) {
        *synthetic = with_type(std::move(*synthetic), names);
    }
    source.frame = io::number_from<int>(value_of(names, "time-step"));
    const auto interval = io::number_from<double>(value_of(names, "frame-interval"));
    if (interval && *interval > 0) source.frame_interval = interval;
    source.smooth = io::number_from<int>(value_of(names, "smooth")).value_or(0);
    source.dequantize = io::number_from<int>(value_of(names, "dequantize")).value_or(0);
    source.prefilter = value_of(names, "prefilter") == "yes";
    return source;
}

}  // namespace palpate::run
