// Scanned volumes for tests: one comes with the project; others are used where they are.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <ostream>
#include <string>

#include "palpate/field.hpp"
#include "palpate/io/sample_volume.hpp"

namespace palpate::io::test {

/// "head" is the volume that comes with the project. Others lie in the folder $PALPATE_DATA, or
/// else beside the repository, and may be missing.
inline std::filesystem::path real_volume(const std::string& name) {
    if (name == "head") return sample_volume_path();
    const char* const set = std::getenv("PALPATE_DATA");
    return std::filesystem::path(set != nullptr ? set : PALPATE_DATA_FOLDER) / name;
}

/// A surface in one of them, as a parameter of tests.
struct Scan {
    const char* file;
    double isovalue;
    Solid solid = Solid::above;
    friend std::ostream& operator<<(std::ostream& out, const Scan& scan) {
        return out << scan.file << " at " << scan.isovalue
                   << (scan.solid == Solid::below ? " below" : "");
    }
};

}  // namespace palpate::io::test
