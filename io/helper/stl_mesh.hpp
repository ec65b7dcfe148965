// Reads STL, text or binary, without a library.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace palpate::io {

/// The three corners of each triangle of a file. Throws Failure.
std::vector<std::array<double, 3>> stl_corners(const std::string& bytes);

}  // namespace palpate::io
