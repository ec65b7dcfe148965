// Settings of the C interface by name, from the core's tables.
#pragma once

#include <string>
#include <vector>

#include "palpate-c/palpate.h"
#include "palpate/settings.hpp"

namespace palpate::c {

/// Every setting, as the header describes it. Their texts live as long as the library.
const std::vector<palpate_setting>& all_settings();
/// Throws std::invalid_argument, suggesting one, for a name that there is not.
double value_of(const RendererSettings& settings, const std::string& name);

}  // namespace palpate::c
