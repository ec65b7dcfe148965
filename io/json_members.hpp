// JSON from lists of members: a struct has a table of settings (palpate/settings.hpp), or one
// function template members(visitor, value), which calls visitor("name", value.name) for each
// member, in the struct's namespace or in palpate::io.
// JsonWriter and JsonReader walk through it. A visitor.must(...) in it is a rule for the reader.
// Other types have to_value() and from_value(), found in the same places.
#pragma once

#include <algorithm>
#include <concepts>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/recording/settings_json.hpp"
#include "palpate/settings.hpp"

namespace palpate::io {

/// Throws std::invalid_argument: "'name' must be WANTED".
[[noreturn]] void wrong_member(const std::string& name, const std::string& wanted);
/// The same: "'name' is missing".
[[noreturn]] void missing_member(const std::string& name);

/// "above, below or beside"
std::string one_of(const std::vector<std::string>& names);

/// S is T, const or not: written from const values, read into others.
template <class S, class T>
concept Is = std::same_as<std::remove_const_t<S>, T>;

/// In members(v, s): visits these members of s, each under its own name.
#define PALPATE_MEMBERS(...) NLOHMANN_JSON_EXPAND(NLOHMANN_JSON_PASTE(PALPATE_MEMBER, __VA_ARGS__))
#define PALPATE_MEMBER(name) v(#name, s.name);
/// The list of members of a struct all of which have their own names.
#define PALPATE_JSON(Struct, ...)                      \
    static void members(auto& v, Is<Struct> auto& s) { \
        PALPATE_MEMBERS(__VA_ARGS__)                   \
    }

template <class T>
requires(std::same_as<T, bool> || std::same_as<T, int> || std::same_as<T, std::uint32_t> ||
         std::same_as<T, std::string>) Json to_value(const T& value) {
    return value;
}
/// By its name.
template <HasNames E>
Json to_value(E value) {
    return enum_name(value);
}
inline Json to_value(double value) {
    return number_to_json(value);
}
Json to_value(const Vec3& value);
Json to_value(const Index3& value);
Json to_value(const Mat3& value);        ///< rows
Json to_value(const Quaternion& value);  ///< w, x, y, z
Json to_value(const Layers& layers);
Json to_value(const Tool& tool);

/// `name` is for errors: std::invalid_argument.
void from_value(const Json& json, const std::string& name, bool& value);
void from_value(const Json& json, const std::string& name, double& value);
void from_value(const Json& json, const std::string& name, std::string& value);
void from_value(const Json& json, const std::string& name, int& value);
void from_value(const Json& json, const std::string& name, std::uint32_t& value);
void from_value(const Json& json, const std::string& name, Vec3& value);
/// At most 2^20 from 0 along each axis.
void from_value(const Json& json, const std::string& name, Index3& value);
void from_value(const Json& json, const std::string& name, Mat3& value);
void from_value(const Json& json, const std::string& name, Quaternion& value);
void from_value(const Json& json, const std::string& name, Layers& layers);
void from_value(const Json& json, const std::string& name, Tool& tool);

template <HasNames E>
void from_value(const Json& json, const std::string& name, E& value) {
    std::string text;
    from_value(json, name, text);
    const auto& names = names_of<E>.names;
    const auto at = std::find(names.begin(), names.end(), text);
    if (at == names.end()) wrong_member(name, one_of(all_names<E>()));
    value = static_cast<E>(at - names.begin());
}

/// The list of members of a struct that has a table of its settings.
template <class S>
requires Described<std::remove_const_t<S>>
void members(auto& v, S& s) {
    for_each_setting<std::remove_const_t<S>>([&](const auto& one) { v(one.key, s.*one.member); });
}

struct JsonWriter {
    Json json = Json::object();

    template <class T>
    static Json of(const T& value) {
        if constexpr (requires(JsonWriter & part) { members(part, value); }) {
            JsonWriter part;
            members(part, value);
            return std::move(part.json);
        } else {
            return to_value(value);
        }
    }
    template <class T>
    void operator()(const std::string& name, const T& value) {
        json[name] = of(value);
    }
    /// Nothing is left out.
    template <class T>
    void operator()(const std::string& name, const std::optional<T>& value) {
        if (value) json[name] = of(*value);
    }
    template <class T>
    void operator()(const std::string& name, const std::shared_ptr<const T>& value) {
        if (value) json[name] = of(*value);
    }
    template <class T>
    void operator()(const std::string& name, const std::vector<T>& values) {
        Json& list = json[name] = Json::array();
        for (const T& value : values) list.push_back(of(value));
    }
    void needed(const std::string& name, const auto& value) { (*this)(name, value); }
    void must(bool, const std::string&, const std::string&) const {}
};

/// Members that are missing leave their value as it is.
struct JsonReader {
    const Json& json;
    std::string where = {};  ///< for errors: "" or "look."

    const Json* find(const std::string& name) const {
        if (!json.is_object()) wrong_member(where + name, "a member of an object");
        const auto found = json.find(name);
        return found == json.end() ? nullptr : &*found;
    }
    template <class T>
    static void get(const Json& json, const std::string& name, T& value) {
        JsonReader part{json, name + "."};
        if constexpr (requires { members(part, value); }) {
            if (!json.is_object()) wrong_member(name, "an object");
            members(part, value);
        } else {
            from_value(json, name, value);
        }
    }
    template <class T>
    void operator()(const std::string& name, T& value) {
        if (const Json* const found = find(name)) get(*found, where + name, value);
    }
    template <class T>
    void operator()(const std::string& name, std::optional<T>& value) {
        if (const Json* const found = find(name)) get(*found, where + name, value.emplace());
    }
    template <class T>
    void operator()(const std::string& name, std::shared_ptr<const T>& value) {
        const Json* const found = find(name);
        if (!found) return;
        T read;
        get(*found, where + name, read);
        value = std::make_shared<const T>(std::move(read));
    }
    template <class T>
    void operator()(const std::string& name, std::vector<T>& values) {
        const Json* const found = find(name);
        if (!found) return;
        if (!found->is_array()) wrong_member(where + name, "a list");
        values.clear();
        for (const Json& value : *found) {
            const std::string item = where + name + "[" + std::to_string(values.size()) + "]";
            get(value, item, values.emplace_back());
        }
    }
    /// A member that has to be there.
    void needed(const std::string& name, auto& value) {
        if (!find(name)) missing_member(where + name);
        (*this)(name, value);
    }
    /// A rule for what was read of a member, or where `name` is empty of the whole. Throws
    /// std::invalid_argument: it "must be WANTED".
    void must(bool holds, const std::string& name, const std::string& wanted) const {
        if (!holds)
            wrong_member(name.empty() ? where.substr(0, where.size() - 1) : where + name, wanted);
    }
};

}  // namespace palpate::io
