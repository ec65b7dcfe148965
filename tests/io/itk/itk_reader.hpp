// The result of ITK for a volume file, as plain numbers. No ITK type is visible here.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate::io::test {

struct ItkVolume {
    std::string error;  ///< why ITK refused the file; then the rest is empty
    int components = 1;
    std::vector<std::int64_t> sizes;
    std::vector<double> spacing, origin;
    std::vector<std::vector<double>> axes;  ///< direction cosines of each axis
    std::vector<double> samples;            ///< of all time steps, as ITK orders them
};

ItkVolume read_with_itk(const std::filesystem::path& path);

}  // namespace palpate::io::test
