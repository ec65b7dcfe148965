// The OPTIONS of `--device NAME:OPTIONS`: KEY=VALUE pairs divided by commas.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::devices {

/// Which device, and how. `NAME`, `NAME:KEY=VALUE,KEY=VALUE`, or `NAME:VALUE` for the option that a
/// device expects first (key "").
struct DeviceChoice {
    std::string name;
    std::map<std::string, std::string> options;

    bool operator==(const DeviceChoice&) const = default;
};
/// Throws std::invalid_argument for an empty name, an empty key, or a key that is there twice.
DeviceChoice parse_device(std::string_view text);

/// Takes options out one by one. finish() refuses those that were not taken. All errors are
/// std::invalid_argument and name the device, the option and the accepted values.
class DeviceOptions {
  public:
    /// `main` is the key that a value without a key stands for ("" where there is none).
    DeviceOptions(const DeviceChoice& choice, const std::string& main);

    std::string text(const std::string& key, const std::string& otherwise);
    double number(const std::string& key, double otherwise, double low, double high);
    int whole_number(const std::string& key, int otherwise, int low, int high);
    bool flag(const std::string& key, bool otherwise);
    /// One of `accepted`.
    std::string one_of(const std::string& key, const std::string& otherwise,
                       const std::vector<std::string>& accepted);
    void finish() const;

  private:
    std::string device_;
    std::map<std::string, std::string> rest_;
    std::vector<std::string> known_;
};

}  // namespace palpate::devices
