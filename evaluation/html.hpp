// Escapes text for HTML. Header only; the demo's report uses it, too.
#pragma once

#include <string>
#include <string_view>

namespace palpate::evaluation {

/// Nothing in it is markup any more.
inline std::string html_text(std::string_view text) {
    std::string html;
    for (const char c : text) {
        if (c == '&')
            html += "&amp;";
        else if (c == '<')
            html += "&lt;";
        else if (c == '>')
            html += "&gt;";
        else if (c == '"')
            html += "&quot;";
        else
            html += c;
    }
    return html;
}

}  // namespace palpate::evaluation
