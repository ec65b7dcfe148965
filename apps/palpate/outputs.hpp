// Outputs of commands: checks before any work is done, and JSON on standard output.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace palpate::app {

/// "-" or another name of the standard output.
bool is_standard_output(const std::string& name);

/// True for what is written directly, as it comes: standard output, a pipe, a device.
bool is_stream(const std::string& name);

/// Throws std::invalid_argument, which names all formats, if the extension is that of no format of
/// volumes that is written. An empty name is skipped.
void check_volume_name(const std::string& name);

/// Prints JSON, indented. What is not UTF-8, as the name of a file may be, is replaced.
void print_json(const nlohmann::ordered_json& json);

/// Throws std::invalid_argument if an output is an input or a file of one (stream::is_read_from).
/// Empty names are skipped.
void refuse_inputs(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs);

/// The same, and throws std::invalid_argument if two outputs are the same; io::OutputError if one
/// cannot be written (a folder *.zarr is not looked at here). Devices such as /dev/null may be
/// shared.
void check_outputs(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs);

}  // namespace palpate::app
