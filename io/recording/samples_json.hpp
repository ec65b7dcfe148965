// How recordings store samples that a run continues with: as a recipe of how they were made, never
// the samples themselves. Private to io/.
#pragma once

#include "io/recording/settings_json.hpp"
#include "palpate/session.hpp"

namespace palpate::io {

/// "version", and "edit" with "of", or "frames" with "times" and "period"; without a recipe the
/// version alone. Samples that an application put in place are stored by their box only: they
/// cannot be made again.
Json to_json(const command::Samples& samples, Bodies& bodies);
/// The inverse; `samples` is null (app::RecordedSamples makes them). Throws std::invalid_argument.
command::Samples samples_command_from_json(const Json& json, Bodies& bodies);

}  // namespace palpate::io
