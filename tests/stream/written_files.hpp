// Files of chunks as other programs write them.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "support/scratch_folder.hpp"

namespace palpate::stream::test {

inline std::string h5py(const std::string& arguments) {
    return std::string(PALPATE_ZARR_PYTHON) + " -B " + PALPATE_STREAM_TESTS +
           "/hdf5_reference.py " + arguments;
}

inline const std::filesystem::path& hdf5_written() {
    static const support::ScratchFolder folder;
    static const bool done = std::system(h5py("write " + folder.path().string()).c_str()) == 0;
    if (!done) throw std::runtime_error("python3-h5py does not work");
    return folder.path();
}

inline const std::filesystem::path& tiff_written() {
    static const support::ScratchFolder folder;
    static const bool done =
        std::system((std::string(PALPATE_ZARR_PYTHON) + " -B " + PALPATE_STREAM_TESTS +
                     "/tiff_reference.py " + folder.path().string())
                        .c_str()) == 0;
    if (!done) throw std::runtime_error("python3-tifffile does not work");
    return folder.path();
}

}  // namespace palpate::stream::test
