// Where the samples of a volume file lie; see the header.
#include "io/plain_samples.hpp"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <fstream>

#include "io/helper/protocol.hpp"
#include "io/helper_process.hpp"
#include "io/inflate.hpp"
#include "io/io_helper.hpp"
#include "io/raw_file.hpp"
#include "palpate/io/error.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;

std::string lower_case(std::string text) {
    std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
}

std::string extension_of(const fs::path& path) {
    return lower_case(path.extension().string());
}

/// The beginning of a text header, without blanks, in lower case.
std::string header_words(const fs::path& path) {
    constexpr std::size_t looked_at = 16384;
    std::string text(looked_at, '\0');
    std::ifstream in(path, std::ios::binary);
    in.read(text.data(), looked_at);
    text.resize(static_cast<std::size_t>(in.gcount()));
    std::erase_if(text, [](char c) { return c == ' ' || c == '\t' || c == '\r'; });
    return lower_case(text);
}

PlainSamples raw_samples(const fs::path& path, const ReadOptions& options) {
    const RawLayout raw = checked_layout(path, options);
    PlainSamples plain;
    plain.format = "raw";
    plain.geometry.size = raw.size;
    plain.geometry.spacing = raw.spacing;
    plain.stored = *stored_named(name_of(raw.type));
    plain.file = path;
    plain.offset = raw.skip;
    plain.swapped = raw.big_endian;
    return plain;
}

PlainSamples plain_from(const nlohmann::json& done) {
    PlainSamples plain;
    plain.format = done.at("format").get<std::string>();
    plain.geometry = geometry_from(done.at("geometry"));
    check(plain.geometry);
    plain.stored = stored_named(done.at("stored").get<std::string>()).value();
    plain.file = done.at("file").get<std::string>();
    plain.offset = done.at("offset").get<std::uint64_t>();
    plain.swapped = done.at("swapped").get<bool>();
    plain.slope = done.at("slope").get<double>();
    plain.intercept = done.at("intercept").get<double>();
    plain.times = done.at("times").get<int>();
    plain.frame_interval = done.at("frame_interval").get<double>();
    for (const auto& note : done.at("notes")) {
        plain.notes.push_back(one_line(note.get<std::string>()));
    }
    return plain;
}

}  // namespace

bool may_be_plain(const fs::path& path, const ReadOptions& options) {
    std::error_code error;
    if (!fs::is_regular_file(path, error)) return false;
    if (is_gzip(path)) return false;
    if (options.raw) return true;
    const std::string extension = extension_of(path);
    if (extension == ".nii") return true;
    if (extension == ".nrrd" || extension == ".nhdr") {
        return header_words(path).find("\nencoding:raw\n") != std::string::npos;
    }
    if (extension != ".mha" && extension != ".mhd") return false;
    const std::string words = header_words(path);
    return words.find("\nelementdatafile=") != std::string::npos &&
           words.find("compresseddata=true") == std::string::npos;
}

PlainSamples locate_samples(const fs::path& path, const ReadOptions& options) {
    check_readable(path);
    if (options.raw) return raw_samples(path, options);
    nlohmann::json request = {{"caller", getpid()}};
    if (options.spacing) request["spacing"] = json_from(*options.spacing);
    return asked_of_helper(path, [&] {
        constexpr double seconds = 60;  // for a header
        const double limit = options.time_limit_s > 0 ? options.time_limit_s : seconds;
        const HelperJob job{
            io_helper, options.helper, {"locate", path.string(), line_from(request)}, nullptr, {},
            limit,     limit};
        const HelperResult result = result_of(path, job);
        return plain_from(result.done);
    });
}

}  // namespace palpate::io
