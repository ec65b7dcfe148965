// The jobs of the helper programs. Requests, answers and limits are the same in all of them. They
// differ in the formats, and therefore in the libraries that a program has to load.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "io/helper/headers.hpp"
#include "io/helper/readers.hpp"

namespace palpate::io {

using Read = Result(const Request& request);
using Locate = VolumeHeader(const Request& request);
using Explore = nlohmann::json(const std::filesystem::path& path, const nlohmann::json& question);
using ReadMesh = MeshSize(const std::filesystem::path& path, const std::string& extension);
using Write = void(const std::filesystem::path& path, const WrittenVolume& volume);

/// What a program does; null: another one does it.
struct Formats {
    Read* read = nullptr;
    Locate* locate = nullptr;
    Explore* explore = nullptr;
    ReadMesh* read_mesh = nullptr;
    Write* write = nullptr;
};

/// The first word of the command line (protocol.hpp).
enum class Job { none, read, locate, explore, read_mesh, write };
Job job_of(int argc, char** argv);

/// What a person is told of an exception.
std::string words_of(const std::exception& e, Job job);

/// Does the job of the command line, reports and ends the process, without destructors: some of the
/// libraries' crash on what a damaged file left behind.
[[noreturn]] void serve(const char* program, const Formats& formats, int argc, char** argv);

}  // namespace palpate::io
