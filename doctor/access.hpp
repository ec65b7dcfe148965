// Whether a person may open a file below /dev, and how to be allowed to.
#pragma once

#include <string>

#include "doctor/facts.hpp"

namespace palpate::doctor {

/// To read and to write.
bool may_open(const Node& node, const Account& account);

/// By the group that may, if there is one; else empty.
std::string way_to_node(const Node& node, const Facts& facts);

}  // namespace palpate::doctor
