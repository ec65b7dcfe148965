// Finds the samples in a volume file. See the header.
#include "io/plain_samples.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>

#include "io/helper/protocol.hpp"
#include "io/inflate.hpp"
#include "io/process/helper_process.hpp"
#include "io/process/io_helper.hpp"
#include "io/raw_file.hpp"
#include "io/words.hpp"
#include "palpate/io/error.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;

/// Formats whose samples may lie in a file as they are.
bool is_plain_name(const fs::path& path) {
    const std::string name = lower(path.filename().string());
    return std::ranges::any_of(
        std::array{".nrrd", ".nhdr", ".mha", ".mhd", ".nii", ".nii.gz", ".mgh", ".mgz", ".mgh.gz",
                   ".mrc", ".map", ".rec", ".ccp4", ".vtk"},
        [&](const char* end) { return name.ends_with(end); });
}

PlainSamples raw_samples(const fs::path& path, const ReadOptions& options) {
    const RawLayout raw = checked_layout(path, options);
    PlainSamples plain;
    plain.format = "raw";
    plain.geometry = geometry_of(raw, options);
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
    plain.value_map.slope = done.at("slope").get<double>();
    plain.value_map.intercept = done.at("intercept").get<double>();
    plain.times = done.at("times").get<int>();
    plain.frame_interval = done.at("frame_interval").get<double>();
    for (const auto& note : done.at("notes")) {
        plain.notes.push_back(one_line(note.get<std::string>()));
    }
    return plain;
}

/// Facts that the helper finds in the header.
nlohmann::json located(const fs::path& path, const ReadOptions& options) {
    nlohmann::json request = {{"caller", getpid()}, {"own_memory", own_memory(0, 0)}};
    add_to(request, {options.spacing, options.orientation});
    constexpr double seconds = 60;  // for a header
    const double limit = options.time_limit_s > 0 ? options.time_limit_s : seconds;
    const HelperJob job{
        io_helper, options.helper, {"locate", path.string(), line_from(request)}, nullptr, {},
        limit,     limit};
    return result_of(path, job).done;
}

}  // namespace

bool may_be_plain(const fs::path& path, const ReadOptions& options) {
    std::error_code error;
    if (!fs::is_regular_file(path, error) || is_gzip(path)) return false;
    if (options.raw) return true;
    if (!is_plain_name(path)) return false;
    try {
        return asked_of_helper(path,
                               [&] { return !located(path, options).contains("only_whole"); });
    } catch (const InputError&) {
        return true;  // opening it says why
    }
}

PlainSamples locate_samples(const fs::path& path, const ReadOptions& options) {
    check_readable(path);
    if (options.raw) return raw_samples(path, options);
    return asked_of_helper(path, [&] {
        const nlohmann::json done = located(path, options);
        if (done.contains("only_whole")) {
            throw InputError(path.string() + ": " +
                             one_line(done["only_whole"].get<std::string>()));
        }
        return plain_from(done);
    });
}

}  // namespace palpate::io
