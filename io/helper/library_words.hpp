// Messages of a library, made fit for a user: one short line without its source files and pointers.
// Header only, because the helper and its caller both pass on such words.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace palpate::io {

/// True for "/build/gdcm/Source/gdcmFoo.cxx:123:" and the like.
inline bool names_source(std::string_view word) {
    for (const std::string_view extension :
         {".c", ".cc", ".cpp", ".cxx", ".h", ".hh", ".hpp", ".hxx", ".tcc", ".txx", ".ipp"}) {
        for (auto at = word.find(extension); at != std::string_view::npos;
             at = word.find(extension, at + 1)) {
            const auto after = at + extension.size();
            if (after == word.size() ||
                std::string_view(":,;()'\"").find(word[after]) != std::string_view::npos) {
                return true;
            }
        }
    }
    return false;
}

/// Without "(0x55d0c8a2b010)", with or without brackets.
inline std::string without_pointers(std::string word) {
    for (std::size_t at; (at = word.find("0x")) != std::string::npos;) {
        const auto after =
            std::min(word.find_first_not_of("0123456789abcdefABCDEF", at + 2), word.size());
        const bool bracketed =
            at > 0 && word[at - 1] == '(' && after < word.size() && word[after] == ')';
        word.erase(at - bracketed, after - at + 2 * bracketed);
    }
    return word;
}

/// `text` in one line of at most `longest` bytes.
inline std::string library_words(const std::string& text, std::size_t longest) {
    std::string line;
    for (std::size_t at = 0; at < text.size();) {
        const auto end = std::min(text.find_first_of(" \t\r\n", at), text.size());
        const std::string word = text.substr(at, end - at);
        if (!names_source(word)) {
            const std::string kept = without_pointers(word);
            if (!kept.empty() && kept != ":") line += (line.empty() ? "" : " ") + kept;
        }
        at = end + 1;
    }
    if (line.size() > longest) line = line.substr(0, longest - 3) + "...";
    return line;
}

}  // namespace palpate::io
