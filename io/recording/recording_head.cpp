// Converts the head of a recording, which describes the run, to JSON and back.
#include "io/recording/recording_head.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>

#include "palpate/names.hpp"

namespace palpate::io {
namespace {

/// Members that are the same for all hands.
constexpr std::array shared_members{"version", "begun", "volume"};

std::string text_of(const Json& json, const char* name) {
    const Json& value = member(json, name);
    if (!value.is_string()) {
        throw std::invalid_argument(std::string("'") + name + "' must be text");
    }
    return value.get<std::string>();
}

VolumeIdentity volume_from_json(const Json& json) {
    VolumeIdentity volume;
    const Json& options = member(json, "options");
    if (!options.is_object()) throw std::invalid_argument("'options' must be an object");
    for (const auto& [name, value] : options.items()) {
        if (!value.is_string()) throw std::invalid_argument("'options' must hold text only");
        volume.options[name] = value.get<std::string>();
    }
    text_of(options, "volume");
    const Json& size = member(json, "size");
    if (!size.is_array() || size.size() != 3) {
        throw std::invalid_argument("'size' must be three numbers");
    }
    for (int a = 0; a < 3; ++a) {
        const double edge = number_from_json(size[static_cast<std::size_t>(a)], "size");
        if (!(edge >= 1 && edge <= 1e6)) throw std::invalid_argument("'size' is out of range");
        volume.size[a] = static_cast<int>(edge);
    }
    volume.type = sample_type_from(text_of(json, "type"));
    const double crc = number_from_json(member(json, "crc32"), "crc32");
    if (!(crc >= 0 && crc <= 4294967295.0)) throw std::invalid_argument("'crc32' is out of range");
    volume.crc32 = static_cast<std::uint32_t>(crc);
    return volume;
}

Json json_of_one(const RecordingHead& head) {
    Json json;
    json["version"] = head.version;
    json["begun"] = head.begun;
    json["volume"] = {{"options", head.volume.options},
                      {"size", {head.volume.size[0], head.volume.size[1], head.volume.size[2]}},
                      {"type", name_of(head.volume.type)},
                      {"crc32", head.volume.crc32}};
    json["solid"] = enum_name(head.solid);
    json["field"] = name_of(head.interpolation);
    json["background"] = number_to_json(head.background);
    json["isovalue"] = number_to_json(head.isovalue);
    json["device"] = head.device;
    json["rate"] = head.rate;
    json["method"] = head.method;
    json["budget"] = "work";
    json["settings"] = to_json(head.settings);
    json["session"] = to_json(head.session);
    return json;
}

RecordingHead head_from_json(const Json& json) {
    RecordingHead head;
    head.version = text_of(json, "version");
    head.begun = text_of(json, "begun");
    head.volume = volume_from_json(member(json, "volume"));
    head.solid = named<Solid>(text_of(json, "solid"));
    // Recordings made before there was a choice have none.
    if (json.contains("field")) head.interpolation = interpolation_from(text_of(json, "field"));
    head.background = number_from_json(member(json, "background"), "background");
    head.isovalue = number_from_json(member(json, "isovalue"), "isovalue");
    head.device = text_of(json, "device");
    head.rate = number_from_json(member(json, "rate"), "rate");
    head.method = text_of(json, "method");
    from_json(member(json, "settings"), head.settings);
    // Before budgets counted work they counted tetrahedra, some of which take more than one unit.
    if (int& budget = head.settings.proxy.step_budget; !json.contains("budget")) {
        constexpr int most = 64;
        budget = most * std::clamp(budget, 0, std::numeric_limits<int>::max() / most);
    }
    from_json(member(json, "session"), head.session);
    return head;
}

}  // namespace

std::uint32_t checksum_with(std::string_view line, std::uint32_t before) {
    const auto* bytes = reinterpret_cast<const Bytef*>(line.data());
    return static_cast<std::uint32_t>(::crc32_z(before, bytes, line.size()));
}

VolumeIdentity identify(const Volume& volume, std::map<std::string, std::string> options,
                        const OnProgress& progress) {
    constexpr std::size_t slice = std::size_t{4} << 20;
    std::string_view left(static_cast<const char*>(volume.data()), volume.bytes());
    ReportedItems work(progress, left.size(), slice);
    std::uint32_t crc = 0;
    while (!left.empty()) {
        const std::string_view part = left.substr(0, slice);
        crc = checksum_with(part, crc);
        left.remove_prefix(part.size());
        work.done(part.size());
    }
    return {std::move(options), volume.geometry().size, volume.type(), crc};
}

Json to_json(std::span<const RecordingHead> heads) {
    Json json = json_of_one(heads.front());
    if (heads.size() == 1) return json;
    Json hands = Json::array();
    for (const RecordingHead& head : heads) {
        hands.push_back(json_of_one(head));
        for (const char* member : shared_members) hands.back().erase(member);
    }
    for (const auto& [member, value] : hands.front().items()) json.erase(member);
    json["hands"] = std::move(hands);
    return json;
}

std::vector<RecordingHead> heads_from_json(const Json& json, int format) {
    if (format <= format_of_one_hand) return {head_from_json(json)};
    const Json& hands = member(json, "hands");
    if (!hands.is_array() || hands.empty()) {
        throw std::invalid_argument("'hands' must be a list of at least one");
    }
    std::vector<RecordingHead> heads;
    for (const Json& own : hands) {
        if (!own.is_object()) throw std::invalid_argument("'hands' must hold objects only");
        Json whole = own;
        for (const char* shared : shared_members) whole[shared] = member(json, shared);
        heads.push_back(head_from_json(whole));
    }
    return heads;
}

}  // namespace palpate::io
