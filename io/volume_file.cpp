// Reads and writes volumes: checks paths, hands the work to the helper program and takes its
// answer.
#include "palpate/io/volume_file.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <system_error>

#include "io/helper/protocol.hpp"
#include "io/process/helper_process.hpp"
#include "io/process/io_helper.hpp"
#include "io/raw_file.hpp"
#include "io/system/leftovers.hpp"
#include "io/system/removal.hpp"
#include "io/system/system.hpp"
#include "palpate/io/output.hpp"
#include "palpate/io/written_formats.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;

/// Notes of the helper on the file. They may quote its header.
std::vector<std::string> notes_of(const nlohmann::json& done) {
    auto notes = done.at("notes").get<std::vector<std::string>>();
    for (std::string& note : notes) note = one_line(std::move(note));
    return notes;
}

ValueInfo values_of(const nlohmann::json& j) {
    // As long as DICOM's short texts are.
    const auto word = [&](const char* name) {
        return one_line(j.at(name).get<std::string>().substr(0, 16));
    };
    ValueInfo values;
    values.modality = word("modality");
    values.units = word("units");
    if (j.contains("padding")) values.padding = j["padding"].get<double>();
    if (j.contains("window")) {
        values.window = {j["window"].at(0).get<double>(), j["window"].at(1).get<double>()};
    }
    for (const nlohmann::json& label : j.value("labels", nlohmann::json::array())) {
        constexpr std::size_t longest = 64;
        values.labels.push_back({label.at("value").get<int>(),
                                 one_line(label.at("name").get<std::string>().substr(0, longest)),
                                 label.at("colour").get<std::array<double, 3>>()});
    }
    return values;
}

std::vector<SeriesInfo> series_from(const nlohmann::json& list) {
    std::vector<SeriesInfo> all;
    for (const nlohmann::json& j : list) {
        SeriesInfo s;
        const auto text = [&](const char* name) { return one_line(j.at(name).get<std::string>()); };
        s.uid = text("uid");
        s.patient = text("patient");
        s.study = text("study");
        s.description = text("description");
        s.modality = text("modality");
        s.stack = text("stack");
        s.slices = j.at("slices").get<int>();
        s.size = j.at("size").get<std::array<int, 2>>();
        s.spacing = vec3_from(j.at("spacing"));
        const auto size = j.at("picture").get<std::array<int, 2>>();
        s.picture = {size[0], size[1], j.at("grey").get<std::vector<std::uint8_t>>()};
        if (s.picture.grey.size() !=
            static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1])) {
            s.picture = {};
        }
        all.push_back(std::move(s));
    }
    return all;
}

VolumeFile volume_from(const nlohmann::json& done, const Descriptor& samples) {
    const Geometry geometry = geometry_from(done.at("geometry"));
    const SampleType type = sample_type_from(done.at("type").get<std::string>());
    check(geometry);
    const auto bytes = static_cast<std::size_t>(sample_count(geometry)) * size_of(type);
    struct stat status {};
    if (fstat(samples.number(), &status) != 0 || status.st_size != static_cast<off_t>(bytes)) {
        throw std::invalid_argument("the helper process gave too few samples");
    }
    return {Volume(geometry, type, map_shared(samples, bytes), bytes),
            done.at("format").get<std::string>(),
            done.at("time_steps").get<int>(),
            notes_of(done),
            done.value("frame_interval", 0.0),
            done.value("first_time", 0.0),
            values_of(done.at("values"))};
}

}  // namespace

VolumeFile read_volume(const fs::path& path, const ReadOptions& options) {
    check_readable(path);
    ReadOptions limited = options;
    if (limited.memory_limit_bytes == 0) limited.memory_limit_bytes = machine_memory();
    if (options.raw) {
        if (fs::is_directory(path)) {
            throw InputError(path.string() + ": is a folder; dims and type are for one file");
        }
        return read_raw(path, limited);
    }
    nlohmann::json request = {{"caller", getpid()},
                              {"series", options.series},
                              {"pictures", options.series_pictures},
                              {"time_step", options.time_step},
                              {"memory", limited.memory_limit_bytes},
                              {"own_memory", own_memory(bytes_in(path), 4)}};
    add_to(request, {options.spacing, options.orientation});
    return asked_of_helper(path, [&] {
        const Descriptor samples = shared_memory();
        const TimeLimits limits(options.time_limit_s, bytes_in(path));
        const HelperJob job{
            io_helper,         options.helper,   {"read", path.string(), line_from(request)},
            &samples,          options.progress, limits.wall_s,
            limits.processor_s};
        const HelperResult result = result_of(path, job);
        if (result.done.contains("choose")) {
            throw SeriesChoice(path.string() + ": " + result.done.at("why").get<std::string>(),
                               series_from(result.done["choose"]));
        }
        return volume_from(result.done, samples);
    });
}

namespace {

/// The folder beside the output in which the helper writes. The helper makes and removes it, on
/// signals too; this removes it after a helper that crashed.
class Workshop {
  public:
    explicit Workshop(const fs::path& output) {
        const fs::path parent = output.has_parent_path() ? output.parent_path() : fs::path(".");
        remove_leftovers(parent);
        folder_ = temporary_in(parent);
    }
    ~Workshop() { remove_tree(folder_); }
    Workshop(const Workshop&) = delete;
    Workshop& operator=(const Workshop&) = delete;

    const fs::path& folder() const { return folder_; }

  private:
    fs::path folder_;
};

/// A pipe, a device or a link, which stay where a file would be replaced.
bool stays(const fs::path& path) {
    std::error_code error;
    const fs::file_status status = fs::symlink_status(path, error);
    return fs::exists(status) && !fs::is_regular_file(status);
}

/// By way of a file, because the formats' libraries write files only.
void write_through_file(const Volume& volume, const fs::path& path, const WriteOptions& options) {
    const std::string extension(written_extension_of(path));
    if (!data_file_of(path, options.compress).empty()) {
        throw OutputError(path.string() + ": is a link or no file, and " + extension +
                          " takes two of them: name it .nrrd or .mha");
    }
    PendingFile stream(path);
    const Workshop workshop(path);
    const fs::path& folder = workshop.folder();
    std::error_code error;
    fs::create_directory(folder, error);
    if (error) throw OutputError(folder.string() + ": cannot be written: " + error.message());
    const Descriptor lock(lock_temporary(folder));
    std::ofstream(folder / temporary_marker) << temporary_marker_text;
    const fs::path file = folder / ("volume" + extension);
    write_volume(volume, file, options);
    std::ifstream in(file, std::ios::binary);
    std::string block(std::size_t{1} << 20, '\0');
    while (in.read(block.data(), static_cast<std::streamsize>(block.size())), in.gcount() > 0) {
        stream.write({block.data(), static_cast<std::size_t>(in.gcount())});
    }
    stream.commit();
}

}  // namespace

void write_volume(const Volume& volume, const fs::path& path, const WriteOptions& options) {
    check_output(path);
    const std::string problem = why_not_written(path, volume.geometry(), options.compress);
    if (!problem.empty()) throw OutputError(problem);
    if (written_extension_of(path) == ".raw") return write_raw(volume, path, options.progress);
    if (stays(path)) return write_through_file(volume, path, options);
    const Workshop workshop(path);
    const nlohmann::json request = {{"caller", getpid()},
                                    {"geometry", json_from(volume.geometry())},
                                    {"type", name_of(volume.type())},
                                    {"own_memory", own_memory(double(volume.bytes()), 4)},
                                    {"compress", options.compress}};
    try {
        const Descriptor samples = shared_memory(volume.bytes());
        std::memcpy(map_shared(samples, volume.bytes()).get(), volume.data(), volume.bytes());
        const TimeLimits limits(options.time_limit_s, static_cast<double>(volume.bytes()));
        const HelperJob job{
            io_helper,
            options.helper,
            {"write", path.string(), line_from(request), workshop.folder().string()},
            &samples,
            options.progress,
            limits.wall_s,
            limits.processor_s};
        const HelperResult result = run_helper(job);
        if (!result.failure.empty()) throw OutputError(path.string() + ": " + result.failure);
    } catch (const std::system_error& e) {
        throw OutputError(path.string() + ": " + e.what());
    }
}

}  // namespace palpate::io
