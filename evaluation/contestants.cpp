// Lists the contestants.
#include "evaluation/contestants.hpp"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "palpate/baselines/methods.hpp"

namespace palpate::evaluation {

std::span<const Contestant> contestants() {
    static const std::vector<Contestant> all = [] {
        std::vector<Contestant> made;
        for (const auto& method : baselines::methods())
            made.push_back({method.name, method.method});
        made.push_back({"smooth", &update_exact, Interpolation::cubic});
        return made;
    }();
    return all;
}

const Contestant& contestant(std::string_view name) {
    const auto all = contestants();
    const auto found = std::ranges::find(all, name, &Contestant::name);
    if (found == all.end()) {
        throw std::invalid_argument("no contestant is named " + std::string(name));
    }
    return *found;
}

Subject as_felt_by(const Contestant& contestant, Subject subject) {
    subject.field.set_interpolation(contestant.interpolation);
    return subject;
}

}  // namespace palpate::evaluation
