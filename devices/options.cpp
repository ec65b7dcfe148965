// Parses the options of a device: KEY=VALUE,KEY=VALUE.
#include "palpate/devices/options.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "io/system/number.hpp"
#include "palpate/names.hpp"

namespace palpate::devices {

DeviceChoice parse_device(std::string_view text) {
    DeviceChoice choice;
    const auto colon = text.find(':');
    choice.name = text.substr(0, colon);
    if (choice.name.empty()) throw std::invalid_argument("a device needs a name");
    std::string_view rest = colon == std::string_view::npos ? "" : text.substr(colon + 1);
    while (!rest.empty()) {
        const auto comma = rest.find(',');
        const std::string_view pair = rest.substr(0, comma);
        rest = comma == std::string_view::npos ? "" : rest.substr(comma + 1);
        const auto equals = pair.find('=');
        const std::string key(equals == std::string_view::npos ? "" : pair.substr(0, equals));
        const std::string value(equals == std::string_view::npos ? pair : pair.substr(equals + 1));
        if (equals == 0 || pair.empty()) {
            throw std::invalid_argument("device " + choice.name + ": options are KEY=VALUE,...");
        }
        if (!choice.options.emplace(key, value).second) {
            throw std::invalid_argument("device " + choice.name + ": option '" + key +
                                        "' is there twice");
        }
    }
    return choice;
}

DeviceOptions::DeviceOptions(const DeviceChoice& choice, const std::string& main)
    : device_(choice.name), rest_(choice.options) {
    const auto plain = rest_.find("");
    if (plain == rest_.end() || main.empty()) return;
    if (rest_.contains(main)) {
        throw std::invalid_argument("device " + device_ + ": option '" + main + "' is there twice");
    }
    rest_[main] = plain->second;
    rest_.erase("");
}

std::string DeviceOptions::text(const std::string& key, const std::string& otherwise) {
    known_.push_back(key);
    const auto found = rest_.find(key);
    if (found == rest_.end()) return otherwise;
    std::string value = found->second;
    rest_.erase(found);
    return value;
}

double DeviceOptions::number(const std::string& key, double otherwise, double low, double high) {
    const bool is_given = rest_.contains(key);
    const std::string given = text(key, "");
    if (!is_given) return otherwise;
    const auto value = io::number_from<double>(given);
    if (value && *value >= low && *value <= high) return *value;
    std::string message = "device " + device_ + ": " + key + "=" + given + ": a number from ";
    io::append_number(message, low);
    message += " to ";
    io::append_number(message, high);
    throw std::invalid_argument(message + " is needed");
}

int DeviceOptions::whole_number(const std::string& key, int otherwise, int low, int high) {
    const double value = number(key, otherwise, low, high);
    if (value == std::floor(value)) return static_cast<int>(value);
    std::string message = "device " + device_ + ": " + key + "=";
    io::append_number(message, value);
    throw std::invalid_argument(message + ": a whole number is needed");
}

bool DeviceOptions::flag(const std::string& key, bool otherwise) {
    return one_of(key, otherwise ? "yes" : "no", {"yes", "no"}) == "yes";
}

std::string DeviceOptions::one_of(const std::string& key, const std::string& otherwise,
                                  const std::vector<std::string>& accepted) {
    const std::string value = text(key, otherwise);
    if (std::ranges::find(accepted, value) != accepted.end()) return value;
    throw std::invalid_argument("device " + device_ + ": " + key + "=" + value + ": " +
                                use_one_of(accepted, value));
}

void DeviceOptions::finish() const {
    if (rest_.empty()) return;
    const std::string& key = rest_.begin()->first;
    const std::string what =
        key.empty() ? "'" + rest_.begin()->second + "' is no KEY=VALUE" : "no option '" + key + "'";
    throw std::invalid_argument("device " + device_ + ": " + what + ": " +
                                (known_.empty() ? "it has none" : use_one_of(known_, key)));
}

}  // namespace palpate::devices
