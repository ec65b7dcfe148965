// Checks of the arrays in a VTI file. VTK's reader accepts many that contradict the header.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::io {

/// The numbers of an attribute of a tag without its brackets, as many as belong there; none if
/// there is no such attribute. Throws Failure.
std::vector<double> vti_numbers(const std::string& tag, const std::string& name, std::size_t count);

/// Checks numbers that are written as text, the lengths of binary arrays, and where raw ones end.
/// Throws Failure.
void check_vti_arrays(const std::filesystem::path& file);

}  // namespace palpate::io
