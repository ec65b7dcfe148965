// All proxy methods by the names that command line, tables and figures give them.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/proxy.hpp"

namespace palpate::baselines {

struct NamedMethod {
    const char* name;
    ProxyMethod method;
};

/// exact, paper, gradient, gradient-improved; the default first.
std::span<const NamedMethod> methods();
std::vector<std::string> method_names();

/// Throws std::invalid_argument, listing the names, for another.
ProxyMethod method_named(std::string_view name);

}  // namespace palpate::baselines
