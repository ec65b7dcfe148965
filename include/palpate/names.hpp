// For messages about unknown names: lists the known ones, and suggests the one that was probably
// meant.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace palpate {

/// The name that `word` probably stands for: the one that begins with it, or that differs from it
/// by the fewest missing, added, wrong or swapped letters (at most a third of them). Case does not
/// matter. Empty if no name is similar.
std::string nearest_name(std::string_view word, std::span<const std::string> names);

/// The end of a message about a `word` that is not one of the names: "use one of cubic, linear (did
/// you mean linear?)".
std::string use_one_of(std::span<const std::string> names, std::string_view word);

}  // namespace palpate
