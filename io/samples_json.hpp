// Samples that a session goes on with, as recordings keep them: by how they came about, never the
// samples themselves. Private to io/.
#pragma once

#include "io/settings_json.hpp"
#include "palpate/session.hpp"

namespace palpate::io {

/// "version", and "edit" with "of", or "frames" with "times" and "period"; without a recipe the
/// version alone. What was put in place by an application is told by its box only: it cannot be
/// made again.
Json to_json(const command::Samples& samples);
/// The inverse; `samples` is null (app::RecordedSamples makes them). Throws std::invalid_argument.
command::Samples samples_command_from_json(const Json& json);

}  // namespace palpate::io
