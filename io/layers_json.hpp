// Layers as JSON, for layer files, recordings and session files.
#pragma once

#include "io/recording/settings_json.hpp"

namespace palpate::io {

Json to_json(const Layers& layers);
/// Throws std::invalid_argument, naming the member, for one that is missing, of the wrong kind, or
/// that there is not.
Layers layers_from_json(const Json& json);

}  // namespace palpate::io
