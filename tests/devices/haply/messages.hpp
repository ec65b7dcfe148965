// Messages of the Inverse Service, for the tests.
#pragma once

#include <string>
#include <vector>

#include "io/system/number.hpp"
#include "palpate/volume.hpp"

namespace palpate::support {

inline std::string xyz(const Vec3& v) {
    std::string text = "{\"x\":";
    io::append_number(text, v[0]);
    text += ",\"y\":";
    io::append_number(text, v[1]);
    text += ",\"z\":";
    io::append_number(text, v[2]);
    return text + "}";
}

inline std::string status(bool calibrated = true, bool ready = true, bool started = true) {
    const auto word = [](bool is) { return std::string(is ? "true" : "false"); };
    return R"("status":{"calibrated":)" + word(calibrated) +
           R"(,"in_use":false,"power_supply":true,)" + R"("ready":)" + word(ready) +
           R"(,"started":)" + word(started) + "}";
}

/// An Inverse3 as in the first message. Position in m.
inline std::string whole_device(const std::string& id, const Vec3& position = Vec3(0, -0.12, 0.15),
                                const std::string& its_status = status()) {
    return R"({"device_id":")" + id + R"(","config":{"type":"inverse3","port":"/dev/ttyACM0",)" +
           R"("device_info":{"major_version":7,"minor_version":4,"id":")" + id +
           R"("},"basis":{"permutation":"XYZ"}},"state":{"cursor_position":)" + xyz(position) +
           R"(,"cursor_velocity":{"x":0,"y":0,"z":0},"control_mode":"idle"},)" + its_status + "}";
}

inline std::string snapshot(const std::vector<std::string>& devices) {
    std::string list;
    for (const std::string& device : devices) list += (list.empty() ? "" : ",") + device;
    return R"({"session_id":7,"inverse3":[)" + list + "]}";
}

/// A later message: position alone.
inline std::string moved(const std::string& id, const Vec3& position) {
    return R"({"inverse3":[{"device_id":")" + id + R"(","state":{"cursor_position":)" +
           xyz(position) + "}}]}";
}

/// `inside` are the members of the grip's entry.
inline std::string with_grip(std::string message, const std::string& inside,
                             const std::string& list = "wireless_verse_grip") {
    message.pop_back();
    return message + ",\"" + list + "\":[{" + inside + "}]}";
}

}  // namespace palpate::support
