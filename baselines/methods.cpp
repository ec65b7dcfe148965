// The table of all proxy methods.
#include "palpate/baselines/methods.hpp"

#include <array>
#include <stdexcept>
#include <string>

#include "baselines/gradient.hpp"
#include "palpate/names.hpp"

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
    for (const NamedMethod& entry : methods()) {
        if (name == entry.name) return entry.method;
    }
    throw std::invalid_argument("there is no method '" + std::string(name) +
                                "': " + use_one_of(method_names(), name));
}

}  // namespace palpate::baselines
