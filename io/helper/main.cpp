// palpate-io-helper: reads or writes one volume, or reads a mesh, with the formats' libraries and
// reports as described in protocol.hpp. It exists so that a crash of a library does not crash the
// caller.
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <string>
#include <vector>

#include "io/helper/child.hpp"
#include "io/helper/images.hpp"
#include "io/helper/library_words.hpp"
#include "io/helper/mirrored.hpp"
#include "io/helper/protocol.hpp"
#include "io/helper/readers.hpp"
#include "io/helper/report.hpp"
#include "io/leftovers.hpp"
#include "palpate/io/written_formats.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;

// What a writer leaves in its folder, for the signal handler, which may not allocate.
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

void limit_this_process(const nlohmann::json& asked, std::uint64_t memory) {
    go_with_caller(asked.at("caller").get<pid_t>());
    limit_memory(memory);
}

bool ends_with(const std::string& text, const std::string& end) {
    return text.size() >= end.size() &&
           text.compare(text.size() - end.size(), end.size(), end) == 0;
}

std::string extension_of(const fs::path& path) {
    const std::string name = lower(path.filename().string());
    return ends_with(name, ".nii.gz") ? ".nii.gz" : lower(path.extension().string());
}

/// Whether a file of this name is a volume, whole.
bool names_a_volume(const fs::path& path) {
    const std::string extension = extension_of(path);
    return std::ranges::any_of(
        std::array{".nrrd", ".nhdr", ".mha", ".mhd", ".nii", ".nii.gz", ".vti"},
        [&](const char* known) { return extension == known; });
}

/// "a.nrrd, b.nrrd and 3 more"
std::string listed(std::vector<std::string> names) {
    constexpr std::size_t most = 3;
    std::ranges::sort(names);
    std::string text;
    for (std::size_t i = 0; i < std::min(most, names.size()); ++i) {
        text += (i > 0 ? ", " : "") + names[i];
    }
    return names.size() > most ? text + " and " + std::to_string(names.size() - most) + " more"
                               : text;
}

Result read_folder(const Request& request) {
    int dicom = 0, tiff = 0;
    bool folders = false;
    std::vector<std::string> volumes;
    for (const auto& entry : fs::directory_iterator(request.path)) {
        folders |= entry.is_directory();
        if (!entry.is_regular_file()) continue;
        if (names_a_volume(entry.path())) volumes.push_back(entry.path().filename().string());
        // Not every one of ten thousand has to be looked into.
        dicom += dicom < 2 && looks_like_dicom(entry.path());
        tiff += dicom == 0 && tiff < 2 && looks_like_tiff(entry.path());
    }
    if (!volumes.empty() && dicom + tiff <= 1) {
        throw Failure(std::string("is a folder of volumes") +
                      (dicom + tiff == 1 ? " with a single slice" : "") + ": give one of them (" +
                      listed(volumes) + ")" + (dicom + tiff == 1 ? ", or the slice itself" : ""));
    }
    if (dicom > 0) return read_dicom_folder(request);
    if (tiff > 0) return read_tiff_folder(request);
    throw Failure(std::string("is a folder with no DICOM or TIFF slices in it; ") +
                  (folders ? "give one of the folders in it, or a volume file"
                           : "give a volume file or another folder"));
}

Result read(const Request& request) {
    if (fs::is_directory(request.path)) return read_folder(request);
    const std::string extension = extension_of(request.path);
    if (extension == ".nrrd" || extension == ".nhdr") return read_nrrd(request);
    if (extension == ".mha" || extension == ".mhd") return read_meta_image(request);
    if (extension == ".nii" || extension == ".nii.gz") return read_nifti(request);
    if (extension == ".vti") return read_vti(request);
    if (extension == ".tif" || extension == ".tiff") return read_tiff_file(request);
    if (extension == ".dcm" || extension == ".dicom" || extension == ".ima" ||
        looks_like_dicom(request.path)) {
        return read_dicom_file(request);
    }
    throw Failure(
        "has no extension of a known format (nrrd, nhdr, mha, mhd, nii, nii.gz, dcm, tif, vti); if "
        "it holds nothing but samples, give its dims and type");
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

nlohmann::json run_locate(const fs::path& path, const nlohmann::json& asked) {
    Request request;
    request.path = path;
    if (asked.contains("spacing")) request.spacing = vec3_from(asked["spacing"]);
    limit_this_process(asked, 1 << 30);
    const std::string extension = extension_of(path);
    const PlainLayout plain = extension == ".nrrd" || extension == ".nhdr" ? nrrd_samples(request)
                              : extension == ".nii"                        ? nifti_samples(request)
                                                    : meta_image_samples(request);
    return {{"format", plain.about.format},
            {"geometry", json_from(plain.about.geometry)},
            {"stored", name_of(plain.stored)},
            {"file", plain.place.file.string()},
            {"offset", plain.place.offset},
            {"swapped", plain.place.swapped},
            {"slope", plain.slope},
            {"intercept", plain.intercept},
            {"times", plain.about.time_steps},
            {"frame_interval", plain.about.times.interval},
            {"notes", plain.about.notes}};
}

/// What `work` gives; of a mirror of which something is missing, what that is. Libraries may take a
/// part that they cannot read for one that is not there, and go on.
template <class Work>
nlohmann::json with_mirror(const nlohmann::json& asked, Work&& work) {
    if (!asked.contains("mirror")) return work();
    use_mirror();
    const auto missing = [] {
        return nlohmann::json{{"missing", {missing_part()->offset, missing_part()->length}}};
    };
    try {
        nlohmann::json result = work();
        return missing_part() ? missing() : result;
    } catch (const std::exception&) {
        if (!missing_part()) throw;
        return missing();
    }
}

nlohmann::json run_describe(const fs::path& path, const nlohmann::json& asked) {
    limit_this_process(asked, 1 << 30);
    const auto image_of = looks_like_tiff(path) ? tiff_image : hdf5_image;
    return with_mirror(asked, [&] {
        return json_from(
            image_of(path, asked.at("channel").get<int>(), asked.at("time").get<int>()));
    });
}

nlohmann::json run_chunks(const fs::path& path, const nlohmann::json& asked) {
    limit_this_process(asked, 1 << 30);
    ChunkBox box;
    box.array = asked.at("array").get<std::string>();
    box.first = asked.at("first").get<std::array<std::int64_t, 3>>();
    box.count = asked.at("count").get<std::array<std::int64_t, 3>>();
    const auto count = static_cast<std::size_t>(box.count[0] * box.count[1] * box.count[2]);
    const std::span<std::byte> memory = shared_samples(count * sizeof(ChunkPlace));
    const auto look_up = looks_like_tiff(path) ? tiff_places : hdf5_places;
    return with_mirror(asked, [&] {
        look_up(path, box, {reinterpret_cast<ChunkPlace*>(memory.data()), count});
        return nlohmann::json::object();
    });
}

nlohmann::json run_read(const fs::path& path, const nlohmann::json& asked) {
    Request request;
    request.path = path;
    request.series = asked.at("series").get<std::string>();
    request.time_step = asked.at("time_step").get<int>();
    request.memory_limit = asked.at("memory").get<std::uint64_t>();
    if (asked.contains("spacing")) request.spacing = vec3_from(asked["spacing"]);
    request.pictures = asked.value("pictures", false);
    limit_this_process(asked, request.memory_limit);
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

/// The folder in which a file is written: under its own name, because headers name their data
/// files, in a folder of its own, so that no unfinished file is visible.
class Workshop {
  public:
    Workshop(const fs::path& folder, const fs::path& target)
        : folder_(folder), target_(target), inside_(folder / target.filename()) {
        remember(unfinished[0], inside_);
        remember(unfinished[1], fs::path(inside_).replace_extension(".raw"));
        remember(unfinished[2], fs::path(inside_).replace_extension(".zraw"));
        remember(unfinished_folder, folder);
        // SIGPIPE: a dying caller's pipes close before its death is announced (PR_SET_PDEATHSIG),
        // and a report between the two would end this process with its file left behind.
        for (const int s : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGXCPU}) signal(s, clean_up_and_go);
    }

    void open() const {
        std::error_code error;
        fs::create_directory(folder_, error);
        if (error) {
            throw Failure("cannot be written there (" + error.message() +
                          "); choose another folder");
        }
        (void)lock_temporary(folder_);  // until this process ends
    }
    const fs::path& inside() const { return inside_; }

    /// Data files first: a header never points to data that are not there.
    void move_out() const {
        std::vector<fs::path> made;
        for (const auto& entry : fs::directory_iterator(folder_)) {
            if (entry.path() != inside_) made.push_back(entry.path());
        }
        made.push_back(inside_);
        for (const fs::path& file : made) {
            std::error_code error;
            fs::rename(file, target_.parent_path() / file.filename(), error);
            if (error) throw Failure("cannot be put in its place (" + error.message() + ")");
        }
        fs::remove(folder_);
    }

  private:
    static void remember(char* to, const fs::path& path) {
        std::snprintf(to, sizeof unfinished_folder, "%s", path.c_str());
    }
    fs::path folder_, target_, inside_;
};

nlohmann::json run_write(const fs::path& path, const nlohmann::json& asked,
                         const fs::path& folder) {
    const Workshop workshop(folder, path);
    const Geometry geometry = geometry_from(asked.at("geometry"));
    const SampleType type = sample_type_from(asked.at("type").get<std::string>());
    const bool compress = asked.at("compress").get<bool>();
    check_geometry(geometry);
    const auto bytes = static_cast<std::size_t>(sample_count(geometry)) * size_of(type);
    limit_this_process(asked, std::max<std::uint64_t>(4 * bytes, 1 << 30));
    void* const samples = mmap(nullptr, bytes, PROT_READ, MAP_SHARED, samples_descriptor, 0);
    if (samples == MAP_FAILED) throw std::bad_alloc();
    const std::string extension(written_extension_of(path));
    workshop.open();
    if (extension == ".vti") {
        write_vti(workshop.inside(), geometry, type, samples, compress);
    } else if (extension == ".tif" || extension == ".tiff") {
        write_tiff(workshop.inside(), geometry, type, samples, compress);
    } else {
        write_with_itk(workshop.inside(), extension, geometry, type, samples,
                       compress || extension == ".nii.gz");
    }
    workshop.move_out();
    return nlohmann::json::object();
}

nlohmann::json run_read_mesh(const fs::path& path, const nlohmann::json& asked) {
    limit_this_process(asked, asked.at("memory").get<std::uint64_t>());
    const MeshSize size = read_mesh(path, extension_of(path), [](const MeshSize& wanted) {
        const std::size_t bytes = mesh_bytes(wanted.vertices, wanted.triangles);
        if (ftruncate(samples_descriptor, static_cast<off_t>(bytes)) != 0) throw std::bad_alloc();
        void* const memory =
            mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, samples_descriptor, 0);
        if (memory == MAP_FAILED) throw std::bad_alloc();
        return memory;
    });
    return {{"vertices", size.vertices}, {"triangles", size.triangles}};
}

using Job = nlohmann::json (*)(const fs::path& path, const nlohmann::json& asked);

/// By the first word of the command line; null for others and for "write".
Job job_named(const std::string& name) {
    static constexpr std::pair<const char*, Job> jobs[] = {{"read", run_read},
                                                           {"locate", run_locate},
                                                           {"describe", run_describe},
                                                           {"chunks", run_chunks},
                                                           {"read-mesh", run_read_mesh}};
    for (const auto& [known, job] : jobs) {
        if (name == known) return job;
    }
    return nullptr;
}

int run(int argc, char** argv) {
    const Job reading = argc == 4 ? job_named(argv[1]) : nullptr;
    const bool writing = argc == 5 && std::strcmp(argv[1], "write") == 0;
    const auto work = [&] {
        const auto asked = nlohmann::json::parse(argv[3]);
        return reading ? reading(argv[2], asked) : run_write(argv[2], asked, argv[4]);
    };
    const auto words_of = [&](const std::exception& e) -> std::string {
        if (dynamic_cast<const Failure*>(&e)) return e.what();
        if (dynamic_cast<const std::bad_alloc*>(&e)) {
            return reading == run_read_mesh ? "not enough memory; simplify the mesh"
                                            : "not enough memory; crop or downsample the volume";
        }
        return "the format's library refused it (" + library_words(e.what(), 300) + "); " +
               (reading ? "it is damaged or of a kind that is not read" : "is the disk full?");
    };
    return helper_status("palpate-io-helper", reading || writing, work, words_of);
}

}  // namespace
}  // namespace palpate::io

int main(int argc, char** argv) {
    const int status = palpate::io::run(argc, argv);
    // No destructors of the libraries: some of them crash on what a damaged file left behind.
    std::_Exit(status);
}
