// Permissions as the kernel judges them: owner, group, others.
#include "doctor/access.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace palpate::doctor {

bool may_open(const Node& node, const Account& account) {
    if (node.opens || account.id == 0) return true;
    const auto grants = [&](unsigned shift) { return (node.mode >> shift & 6U) == 6U; };
    if (node.owner == account.id) return grants(6);
    return std::ranges::count(account.groups, node.group) > 0 ? grants(3) : grants(0);
}

std::string way_to_node(const Node& node, const Facts& facts) {
    const auto name = facts.machine.group_names.find(node.group);
    if (name == facts.machine.group_names.end() || node.group == 0 || (node.mode >> 3 & 6U) != 6U) {
        return {};
    }
    const auto members = facts.machine.members.find(name->second);
    if (members != facts.machine.members.end() &&
        std::ranges::count(members->second, facts.account.name) > 0) {
        return fmt::format("log out and in again: you are in group {}, but this login is older",
                           name->second);
    }
    return fmt::format("sudo adduser $USER {}; then log out and in again", name->second);
}

}  // namespace palpate::doctor
