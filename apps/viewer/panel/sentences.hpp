// Sentences of the libraries in the person's language.
#pragma once

#include <QString>

#include <string>

namespace palpate::viewer {

/// What a person hears when a setting, a level, layers or a tool is refused, or when there is a
/// reason to warn of it. Others, such as those of readers and devices, stay as they are.
QString in_words(const std::string& sentence);

}  // namespace palpate::viewer
