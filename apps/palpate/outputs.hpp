// Where results go: checks that hold before any work is done.
#pragma once

#include <string>
#include <vector>

namespace palpate::app {

/// "-" or another name of the standard output.
bool is_standard_output(const std::string& name);

/// True for what is written directly, as it comes: standard output, a pipe, a device.
bool is_stream(const std::string& name);

/// Throws std::invalid_argument if an output is one of the inputs, which it would replace, or two
/// outputs are the same. Empty names are skipped; devices such as /dev/null may be shared.
void check_outputs(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs);

}  // namespace palpate::app
