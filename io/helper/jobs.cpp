// Requests and answers of all jobs; the formats come as functions.
#include "io/helper/jobs.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <new>

#include "io/helper/child.hpp"
#include "io/helper/far_file.hpp"
#include "io/helper/library_words.hpp"
#include "io/helper/report.hpp"
#include "io/path_json.hpp"
#include "io/system/leftovers.hpp"
#include "io/system/system.hpp"
#include "palpate/io/error.hpp"
#include "palpate/io/written_formats.hpp"

namespace palpate::io {

namespace fs = std::filesystem;

namespace {

// Names of unfinished files, for the signal handler, which may not allocate.
char unfinished[3][4096];
char unfinished_folder[4096];

extern "C" void clean_up_and_go(int signal_number) {
    for (const auto& file : unfinished) {
        if (file[0] != '\0') unlink(file);
    }
    if (unfinished_folder[0] != '\0') rmdir(unfinished_folder);
    signal(signal_number, SIG_DFL);
    raise(signal_number);
}

nlohmann::json json_of(const ValueInfo& values) {
    nlohmann::json json = {{"modality", values.modality}, {"units", values.units}};
    if (values.window) json["window"] = {values.window->centre, values.window->width};
    if (values.padding) json["padding"] = *values.padding;
    for (const LabelName& label : values.labels) {
        json["labels"].push_back(
            {{"value", label.value}, {"name", label.name}, {"colour", label.colour}});
    }
    return json;
}

nlohmann::json json_of(const SeriesInfo& s) {
    return {{"uid", s.uid},
            {"patient", s.patient},
            {"study", s.study},
            {"description", s.description},
            {"modality", s.modality},
            {"stack", s.stack},
            {"slices", s.slices},
            {"size", s.size},
            {"spacing", json_from(s.spacing)},
            {"picture", {s.picture.width, s.picture.height}},
            {"grey", s.picture.grey}};
}

void limit_this_process(const nlohmann::json& asked) {
    go_with_caller(asked.at("caller").get<pid_t>());
    bound_memory(asked.at("own_memory").get<std::uint64_t>());
}

nlohmann::json run_read(const fs::path& path, const nlohmann::json& asked, Read* read) {
    Request request;
    request.path = path;
    request.series = asked.at("series").get<std::string>();
    request.time_step = asked.at("time_step").get<int>();
    request.memory_limit = asked.at("memory").get<std::uint64_t>();
    request.grid = grid_from(asked);
    request.pictures = asked.value("pictures", false);
    limit_this_process(asked);
    Result result;
    try {
        result = read(request);
    } catch (const ChooseSeries& choice) {
        nlohmann::json list = nlohmann::json::array();
        for (const SeriesInfo& series : choice.series) list.push_back(json_of(series));
        return {{"choose", list}, {"why", choice.what()}};
    }
    return {{"geometry", json_from(result.geometry)},
            {"type", name_of(result.type)},
            {"format", result.format},
            {"time_steps", result.time_steps},
            {"frame_interval", result.times.interval},
            {"first_time", result.times.first},
            {"values", json_of(result.values)},
            {"notes", result.notes}};
}

nlohmann::json run_locate(const fs::path& path, const nlohmann::json& asked, Locate* locate) {
    Request request;
    request.path = path;
    request.grid = grid_from(asked);
    limit_this_process(asked);
    if (asked.contains("headers")) {
        nlohmann::json files = nlohmann::json::array();
        for (const nlohmann::json& header : asked["headers"]) {
            for (const fs::path& file : files_read_with(path_from_json(header))) {
                files.push_back(json_of_path(file));
            }
        }
        return {{"files", files}};
    }
    VolumeHeader header;
    try {
        header = locate(request);
    } catch (const OnlyWhole& e) {
        return {{"only_whole", e.what()}};
    }
    return {{"format", header.format},
            {"geometry", json_from(header.geometry)},
            {"stored", name_of(header.stored)},
            {"file", header.places.front().file.string()},
            {"offset", header.places.front().offset},
            {"swapped", header.places.front().swapped},
            {"slope", header.value_map.slope},
            {"intercept", header.value_map.intercept},
            {"times", header.steps},
            {"frame_interval", header.times.interval},
            {"notes", header.notes}};
}

/// The next question; nothing if the caller has closed the socket.
std::optional<nlohmann::json> next_question() {
    std::string line;
    for (char c = 0; read(samples_descriptor, &c, 1) == 1; line += c) {
        if (c == '\n') return nlohmann::json::parse(line);
    }
    return std::nullopt;
}

nlohmann::json run_explore(const fs::path& path, const nlohmann::json& asked, Explore* explore) {
    go_with_socket(samples_descriptor);
    bound_memory(asked.at("own_memory").get<std::uint64_t>());
    if (asked.contains("size")) use_far_file(asked["size"].get<std::uint64_t>());
    while (const auto question = next_question()) {
        report({{"done", explore(path, *question)}});
    }
    return nlohmann::json::object();
}

/// The folder in which a file is written: under its own name, because headers name their
/// data files, in a folder of its own, so that no unfinished file is visible.
class Workshop {
  public:
    Workshop(const fs::path& folder, const fs::path& target, bool compress)
        : folder_(folder),
          target_(target),
          inside_(folder / target.filename()),
          data_(data_file_of(inside_, compress)) {
        remember(unfinished[0], inside_);
        remember(unfinished[1], data_);
        remember(unfinished[2], marker());
        remember(unfinished_folder, folder);
        // SIGPIPE: a dying caller's pipes close before its death is announced (PR_SET_PDEATHSIG),
        // and a report between the two would end this process with its file left behind.
        for (const int s : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGXCPU}) signal(s, clean_up_and_go);
    }

    void open() const {
        std::error_code error;
        const bool is_new = fs::create_directory(folder_, error);
        if (!is_new) {
            throw Failure("cannot be written there (" + (error ? error.message() : reason(EEXIST)) +
                          "); choose another folder");
        }
        std::ofstream(marker()) << temporary_marker_text;
        // Locked until this process ends: others see that it is in use.
        const int folder = ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
        if (folder >= 0) (void)::flock(folder, LOCK_EX | LOCK_NB);
    }
    const fs::path& inside() const { return inside_; }

    /// The data file first: a header never points to data that are not there. Moves no other file:
    /// only of these two is it known that nothing else is replaced.
    void move_out() const {
        std::vector<fs::path> made;
        for (const auto& entry : fs::directory_iterator(folder_)) {
            const fs::path& file = entry.path();
            if (file == data_) made.push_back(file);
            if (file == data_ || file == inside_ || file == marker()) continue;
            throw Failure("would be written with a file " + file.filename().string() +
                          " that is not known; name it .nrrd");
        }
        made.push_back(inside_);
        const fs::path parent = target_.has_parent_path() ? target_.parent_path() : ".";
        for (const fs::path& file : made) {
            std::error_code ignored;  // a new file has the usual mode
            const auto old = fs::status(parent / file.filename(), ignored);
            if (fs::exists(old) && !give_mode(file, old.permissions())) {
                throw Failure("cannot be given the mode of the file it replaces (" + reason(errno) +
                              ")");
            }
            // Now, because it takes long for a large one and can still be cancelled.
            const int whole = open_to_read(file);
            if (whole >= 0) {
                (void)synchronise(whole);
                ::close(whole);
            }
        }
        report({{"placing", true}});
        for (const fs::path& file : made) {
            if (replace_synced(file, parent / file.filename())) continue;
            throw Failure("cannot be put in its place (" + reason(errno) + ")");
        }
        fs::remove(marker());
        fs::remove(folder_);
    }

  private:
    fs::path marker() const { return folder_ / temporary_marker; }
    static void remember(char* to, const fs::path& path) {
        std::snprintf(to, sizeof unfinished_folder, "%s", path.c_str());
    }
    fs::path folder_, target_, inside_, data_;
};

nlohmann::json run_write(const fs::path& path, const nlohmann::json& asked, const fs::path& folder,
                         Write* write) {
    WrittenVolume volume;
    volume.compress = asked.at("compress").get<bool>();
    const Workshop workshop(folder, path, volume.compress);
    volume.geometry = geometry_from(asked.at("geometry"));
    volume.type = sample_type_from(asked.at("type").get<std::string>());
    check_geometry(volume.geometry);
    const auto bytes =
        static_cast<std::size_t>(sample_count(volume.geometry)) * size_of(volume.type);
    limit_this_process(asked);
    void* const samples = mmap(nullptr, bytes, PROT_READ, MAP_SHARED, samples_descriptor, 0);
    if (samples == MAP_FAILED) throw std::bad_alloc();
    volume.samples = samples;
    workshop.open();
    write(workshop.inside(), volume);
    workshop.move_out();
    return nlohmann::json::object();
}

nlohmann::json run_read_mesh(const fs::path& path, const nlohmann::json& asked,
                             ReadMesh* read_mesh) {
    limit_this_process(asked);
    const MeshSize size = read_mesh(path, extension_of(path));
    return {{"vertices", size.vertices}, {"triangles", size.triangles}};
}

nlohmann::json run(Job job, char** argv, const Formats& formats) {
    const fs::path path = argv[2];
    const auto asked = nlohmann::json::parse(argv[3]);
    switch (job) {
        case Job::read:
            if (formats.read) return run_read(path, asked, formats.read);
            break;
        case Job::locate:
            if (formats.locate) return run_locate(path, asked, formats.locate);
            break;
        case Job::explore:
            if (formats.explore) return run_explore(path, asked, formats.explore);
            break;
        case Job::read_mesh:
            if (formats.read_mesh) return run_read_mesh(path, asked, formats.read_mesh);
            break;
        case Job::write:
            if (formats.write) return run_write(path, asked, argv[4], formats.write);
            break;
        case Job::none:
            break;
    }
    throw Failure("is not for this program; reinstall Palpate");
}

}  // namespace

Job job_of(int argc, char** argv) {
    static constexpr std::pair<std::string_view, Job> jobs[] = {{"read", Job::read},
                                                                {"locate", Job::locate},
                                                                {"explore", Job::explore},
                                                                {"read-mesh", Job::read_mesh},
                                                                {"write", Job::write}};
    for (const auto& [name, job] : jobs) {
        if (argc > 1 && name == argv[1] && argc == (job == Job::write ? 5 : 4)) return job;
    }
    return Job::none;
}

std::string words_of(const std::exception& e, Job job) {
    if (dynamic_cast<const Failure*>(&e)) return e.what();
    if (dynamic_cast<const std::bad_alloc*>(&e)) {
        return job == Job::read_mesh ? "not enough memory; simplify the mesh"
                                     : "not enough memory; crop or downsample the volume";
    }
    if (job == Job::write) return not_written_whole;
    return "the format's library refused it (" + library_words(e.what(), 300) +
           "); it is damaged or of a kind that is not read";
}

void serve(const char* program, const Formats& formats, int argc, char** argv) {
    const Job job = job_of(argc, argv);
    std::_Exit(helper_status(
        program, job != Job::none, [&] { return run(job, argv, formats); },
        [&](const std::exception& e) { return words_of(e, job); }));
}

}  // namespace palpate::io
