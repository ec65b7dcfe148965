// The table of all proxy methods.
#include "palpate/baselines/methods.hpp"

#include <array>
#include <stdexcept>
#include <string>

#include "baselines/gradient.hpp"

namespace palpate::baselines {

std::span<const NamedMethod> methods() {
    static constexpr std::array<NamedMethod, 4> all{
        {{"exact", &update_exact},
         {"paper", &update_paper},
         {"gradient", &update_gradient},
         {"gradient-improved", &update_gradient_improved}}};
    return all;
}

std::vector<std::string> method_names() {
    std::vector<std::string> names;
    for (const NamedMethod& entry : methods()) names.emplace_back(entry.name);
    return names;
}

ProxyMethod method_named(std::string_view name) {
    std::string names;
    for (const NamedMethod& entry : methods()) {
        if (name == entry.name) return entry.method;
        names += names.empty() ? entry.name : std::string(", ") + entry.name;
    }
    throw std::invalid_argument("no method '" + std::string(name) + "': there are " + names);
}

}  // namespace palpate::baselines
