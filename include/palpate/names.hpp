// Helps with names that are not known: lists those that are, and suggests the one that was probably
// meant. Used in messages only.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace palpate {

/// The name that `word` probably stands for: the one that begins with it, or that differs from it
/// by the fewest letters that are missing, added, wrong or swapped, at most a third of them.
/// Capital letters count as small ones. Empty if no name is near.
std::string nearest_name(std::string_view word, std::span<const std::string> names);

/// The end of a message about a `word` that is none of the names: "use one of cubic, linear (did
/// you mean linear?)".
std::string use_one_of(std::span<const std::string> names, std::string_view word);

}  // namespace palpate
