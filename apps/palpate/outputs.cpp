// Compares files by identity, not by name; prints JSON.
#include "apps/palpate/outputs.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "palpate/io/output.hpp"
#include "palpate/io/written_formats.hpp"
#include "palpate/names.hpp"
#include "palpate/stream/read_files.hpp"

namespace palpate::app {
namespace {

namespace fs = std::filesystem;

/// As io::is_same_file(), also for the names of standard output.
bool same_file(const std::string& a, const std::string& b) {
    if (is_standard_output(a) || is_standard_output(b)) {
        return is_standard_output(a) && is_standard_output(b);
    }
    return io::is_same_file(a, b);
}

/// A folder, whose own check comes from what makes it.
bool is_zarr(const fs::path& name) {
    return io::without_slash(name).extension() == ".zarr";
}

}  // namespace

bool is_standard_output(const std::string& name) {
    return name == "-" || name == "/dev/stdout" || name == "/dev/fd/1";
}

bool is_stream(const std::string& name) {
    std::error_code error;
    return is_standard_output(name) ||
           (fs::exists(name, error) && !fs::is_regular_file(name, error));
}

void check_volume_name(const std::string& name) {
    if (name.empty() || is_zarr(name) || !io::written_extension_of(name).empty()) return;
    const auto written = io::written_extensions();
    std::vector<std::string> all(written.begin(), written.end());
    all.emplace_back(".zarr");
    throw std::invalid_argument(name + ": its extension names no format of volumes: " +
                                use_one_of(all, fs::path(name).extension().string()));
}

void print_json(const nlohmann::ordered_json& json) {
    fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
}

void refuse_inputs(const std::vector<std::string>& inputs,
                   const std::vector<std::string>& outputs) {
    for (const std::string& output : outputs) {
        for (const std::string& input : inputs) {
            if (output.empty() || input.empty() || is_standard_output(output)) continue;
            if (!same_file(output, input) && !stream::is_read_from(output, input)) continue;
            throw std::invalid_argument(
                output + " is an input and would be replaced: choose another output");
        }
    }
}

void check_outputs(const std::vector<std::string>& inputs,
                   const std::vector<std::string>& outputs) {
    for (const std::string& output : outputs) {
        if (!output.empty() && !is_zarr(output)) io::check_output(output);
    }
    refuse_inputs(inputs, outputs);
    for (std::size_t i = 0; i < outputs.size(); ++i) {
        if (outputs[i].empty()) continue;
        for (std::size_t j = 0; j < i; ++j) {
            if (outputs[j].empty() || !same_file(outputs[i], outputs[j])) continue;
            throw std::invalid_argument("two outputs go to " + outputs[i] + ": give each its own");
        }
    }
}

}  // namespace palpate::app
