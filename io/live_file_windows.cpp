// The memory-mapped file through which another process pushes frames is not used on Windows yet.
#include "palpate/io/live_file.hpp"

namespace palpate::io {

LiveWriter::LiveWriter(const std::filesystem::path& path, const Geometry&, SampleType, double,
                       int) {
    throw OutputError(path.string() + ": live sources do not work on Windows yet; use Linux");
}

LiveWriter::~LiveWriter() = default;

void LiveWriter::push(std::span<const std::byte>, double) {}

void LiveWriter::push(const Volume&, double) {}

LiveReader::LiveReader(const std::filesystem::path& path, std::uint64_t) : name_(path.string()) {
    throw InputError(name_ + ": live sources do not work on Windows yet; use Linux");
}

LiveReader::~LiveReader() = default;

std::vector<Frame> LiveReader::poll(int) {
    return {};
}

bool LiveReader::replaced() const {
    return false;
}

}  // namespace palpate::io
