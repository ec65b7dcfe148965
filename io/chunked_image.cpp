// The description of the image in a file of chunks, as JSON. See the header.
#include "io/chunked_image.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "palpate/io/error.hpp"

namespace palpate::io {
namespace {

constexpr std::size_t most_listed = 4096;  // channels, notes, levels

std::vector<std::string> lines_from(const nlohmann::json& list, std::size_t longest) {
    std::vector<std::string> lines;
    for (const auto& line : list) {
        if (lines.size() == most_listed) throw std::invalid_argument("a list is too long");
        lines.push_back(one_line(line.get<std::string>().substr(0, longest)));
    }
    return lines;
}

std::int64_t whole_from(const nlohmann::json& number) {
    if (!number.is_number_integer()) throw std::invalid_argument("a number is not whole");
    return number.get<std::int64_t>();
}

std::array<std::int64_t, 3> sizes_from(const nlohmann::json& list) {
    return {whole_from(list.at(0)), whole_from(list.at(1)), whole_from(list.at(2))};
}

ImageArray array_from(const nlohmann::json& json) {
    ImageArray array;
    array.id = json.at("id").get<std::string>();
    array.shape = sizes_from(json.at("shape"));
    array.chunk = sizes_from(json.at("chunk"));
    array.stored = stored_named(json.at("stored").get<std::string>()).value();
    array.swapped = json.at("swapped").get<bool>();
    array.values = {json.value("slope", 1.0), json.value("intercept", 0.0)};
    array.fill = json.at("fill").get<double>();
    array.codecs = lines_from(json.at("codecs"), 64);
    array.scale = json.at("scale").get<std::array<double, 3>>();
    array.translation = json.at("translation").get<std::array<double, 3>>();
    return array;
}

}  // namespace

double factor_between(std::int64_t fine, std::int64_t coarse) {
    return std::max(1.0, std::round(static_cast<double>(fine) / static_cast<double>(coarse)));
}

void place(ImageArray& level, const std::array<double, 3>& spacing,
           const std::array<double, 3>& origin, const std::array<double, 3>& factor) {
    for (std::size_t a = 0; a < 3; ++a) {
        level.scale[a] = spacing[a] * factor[a];
        level.translation[a] = origin[a] + spacing[a] * (factor[a] - 1) / 2;
    }
}

int number_of_time(int time, const std::vector<int>& numbers, std::vector<std::string>& notes) {
    const int number = numbers.at(static_cast<std::size_t>(time));
    if (number != time) {
        notes.push_back("its times are numbered from " + std::to_string(numbers.front()) + " to " +
                        std::to_string(numbers.back()) + ": time " + std::to_string(time) +
                        " is its timepoint " + std::to_string(number));
    }
    return number;
}

nlohmann::json json_from(const ChunkedImage& image) {
    nlohmann::json json = {{"format", image.format},     {"unit", image.unit},
                           {"measured", image.measured}, {"channels", image.channels},
                           {"times", image.times},       {"frame_interval", image.frame_interval},
                           {"notes", image.notes},       {"levels", nlohmann::json::array()}};
    if (image.range) json["range"] = *image.range;
    for (const ImageArray& array : image.levels) {
        json["levels"].push_back({{"id", array.id},
                                  {"shape", array.shape},
                                  {"chunk", array.chunk},
                                  {"stored", name_of(array.stored)},
                                  {"swapped", array.swapped},
                                  {"slope", array.values.slope},
                                  {"intercept", array.values.intercept},
                                  {"fill", array.fill},
                                  {"codecs", array.codecs},
                                  {"scale", array.scale},
                                  {"translation", array.translation}});
    }
    return json;
}

ChunkedImage chunked_image_from(const nlohmann::json& json) {
    constexpr std::size_t longest_name = 64, longest_note = 400;
    ChunkedImage image;
    image.format = one_line(json.at("format").get<std::string>().substr(0, longest_name));
    image.unit = json.at("unit").get<std::string>();
    image.measured = json.at("measured").get<bool>();
    image.channels = lines_from(json.at("channels"), longest_name);
    image.times =
        static_cast<int>(std::clamp<std::int64_t>(whole_from(json.at("times")), 0, 1 << 30));
    image.frame_interval = json.at("frame_interval").get<double>();
    if (json.contains("range")) image.range = json["range"].get<std::array<double, 2>>();
    image.notes = lines_from(json.at("notes"), longest_note);
    for (const auto& level : json.at("levels")) {
        if (image.levels.size() == most_listed) throw std::invalid_argument("too many levels");
        image.levels.push_back(array_from(level));
    }
    return image;
}

}  // namespace palpate::io
