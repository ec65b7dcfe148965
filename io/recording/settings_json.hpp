// Settings and commands as JSON, for recordings and session files. Numbers read back bit for bit;
// infinities are "inf" and "-inf", since JSON has no number for them.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "palpate/session.hpp"

namespace palpate::io {

using Json = nlohmann::ordered_json;

/// All but `method` and a penetrability function and its context.
Json to_json(const RendererSettings& settings);
Json to_json(const SessionSettings& settings);
/// The bodies of tools in the edits of one recording, in order of appearance: each is written once
/// and named by its number from then on.
using Bodies = std::vector<std::shared_ptr<const ToolBody>>;
/// One member, named after the command.
Json to_json(const Command& command, Bodies& bodies);

/// Members that are missing leave the default. Throw std::invalid_argument, naming the member, for
/// one of the wrong kind; and for a command that there is not.
void from_json(const Json& json, RendererSettings& settings);
void from_json(const Json& json, SessionSettings& settings);
Command command_from_json(const Json& json, Bodies& bodies);

/// json's member `name`. Throws std::invalid_argument if it is no object or has none.
const Json& member(const Json& json, const char* name);
double number_from_json(const Json& json, const std::string& name);
Json number_to_json(double value);

}  // namespace palpate::io
