// Stores as other programs write them, by the scripts *_reference.py, and comparisons with these.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>

#include "stream/store_support.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::stream::test {

inline std::string reference(const std::string& format, const std::string& arguments) {
    return std::string(PALPATE_ZARR_PYTHON) + " -B " + PALPATE_STREAM_TESTS + "/" + format +
           "_reference.py " + arguments;
}

/// The files that the script of a format writes, once for all tests.
inline const std::filesystem::path& written_by(const std::string& format) {
    static std::map<std::string, support::ScratchFolder> folders;
    const auto [at, is_new] = folders.try_emplace(format);
    const std::string folder = at->second.path();
    if (is_new && std::system(reference(format, "write " + folder).c_str()) != 0) {
        throw std::runtime_error("the Python module for " + format + " does not work");
    }
    return at->second.path();
}

/// By the end of a name: "...-i2.n5".
inline io::Stored stored_in(const std::string& name) {
    const std::string type = name.substr(name.rfind('-') + 1, 2);
    const std::string kind = type[0] == 'u' ? "uint" : type[0] == 'i' ? "int" : "float";
    return *io::stored_named(kind + std::to_string(8 * (type[1] - '0')));
}

/// Compares a level with the stored samples in NAME.raw.
inline void expect_level(const Store& store, int level, const std::filesystem::path& name,
                         io::Stored stored) {
    const Geometry& grid = store.info().levels.at(static_cast<std::size_t>(level)).geometry;
    const std::string raw = support::bytes_of(name.string() + ".raw");
    expect_same_boxes(store, expected_volume(grid, raw, stored), 3, level);
}

/// "NAME-1-2-3"
inline std::string numbered(std::string name, std::initializer_list<int> numbers) {
    for (const int number : numbers) name += "-" + std::to_string(number);
    return name;
}

inline StoreOptions choice_of(int channel, int time) {
    StoreOptions options;
    options.channel = channel;
    options.time = time;
    return options;
}

}  // namespace palpate::stream::test
