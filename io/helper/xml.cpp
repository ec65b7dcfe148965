// Small XML documents, by expat. See the header.
#include "io/helper/xml.hpp"

#include <expat.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <new>
#include <utility>

#include "io/helper/decode.hpp"

namespace palpate::io {
namespace {

constexpr std::size_t most_bytes = 64 << 20;
constexpr std::size_t deepest = 64;

std::string without_prefix(const std::string& name) {
    return name.substr(name.find(':') == std::string::npos ? 0 : name.find(':') + 1);
}

/// What a document's text becomes. No exception may pass through the parser.
struct Growing {
    XML_Parser parser = nullptr;
    XmlElement top;  ///< its only element is the root
    std::vector<XmlElement*> open{&top};
    bool is_too_deep = false, is_too_large = false;

    template <class Work>
    static void add(void* to, Work&& work) {
        Growing& self = *static_cast<Growing*>(to);
        try {
            work(self);
        } catch (const std::bad_alloc&) {
            self.is_too_large = true;
        }
        if (self.is_too_large || self.is_too_deep) XML_StopParser(self.parser, XML_FALSE);
    }
};

void begin_element(void* to, const char* name, const char** attributes) {
    Growing::add(to, [&](Growing& growing) {
        growing.is_too_deep = growing.open.size() > deepest;
        XmlElement& element = growing.open.back()->inner.emplace_back();
        growing.open.push_back(&element);
        element.name = without_prefix(name);
        for (; *attributes; ++attributes) (element.attributes += *attributes) += '\0';
    });
}
void end_element(void* to, const char*) {
    static_cast<Growing*>(to)->open.pop_back();
}
void add_text(void* to, const char* text, int length) {
    Growing::add(to, [&](Growing& growing) {
        growing.open.back()->text.append(text, static_cast<std::size_t>(length));
    });
}

}  // namespace

std::string XmlElement::attribute(const std::string& wanted) const {
    for (const char* name_of = attributes.c_str(); *name_of != '\0';) {
        const char* const value = name_of + std::strlen(name_of) + 1;
        if (wanted == name_of) return value;
        name_of = value + std::strlen(value) + 1;
    }
    return "";
}

std::vector<const XmlElement*> XmlElement::all(const std::string& path) const {
    const std::size_t slash = std::min(path.find('/'), path.size());
    std::vector<const XmlElement*> found;
    for (const XmlElement& one : inner) {
        if (one.name != path.substr(0, slash)) continue;
        if (slash == path.size()) {
            found.push_back(&one);
        } else {
            const auto deeper = one.all(path.substr(slash + 1));
            found.insert(found.end(), deeper.begin(), deeper.end());
        }
    }
    return found;
}

std::string XmlElement::text_of(const std::string& path) const {
    const auto found = all(path);
    return found.empty() ? "" : found[0]->text;
}

XmlElement parse_xml(const std::string& text, const std::string& where) {
    const std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser(
        XML_ParserCreate(nullptr), &XML_ParserFree);
    if (!parser) throw std::bad_alloc();
    Growing growing;
    growing.parser = parser.get();
    XML_SetUserData(parser.get(), &growing);
    XML_SetElementHandler(parser.get(), begin_element, end_element);
    XML_SetCharacterDataHandler(parser.get(), add_text);
    const bool is_long = text.size() > most_bytes;
    const bool is_whole = !is_long && XML_Parse(parser.get(), text.data(),
                                                static_cast<int>(text.size()), 1) == XML_STATUS_OK;
    if (growing.is_too_deep) throw Failure(where + " has elements within elements without an end");
    if (is_long || growing.is_too_large || XML_GetErrorCode(parser.get()) == XML_ERROR_NO_MEMORY) {
        throw Failure(where + " is too large for the memory that may be used; save it without " +
                      "what is not needed, or allow more memory");
    }
    if (!is_whole) throw Failure(where + " is no XML; write it again");
    return std::move(growing.top.inner.front());
}

XmlElement read_xml(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::error_code error;
    if (!in || std::filesystem::file_size(file, error) > most_bytes || error) {
        throw Failure(quoted(file) + " beside it cannot be read or is too long");
    }
    return parse_xml({std::istreambuf_iterator<char>(in), {}}, quoted(file) + " beside it");
}

}  // namespace palpate::io
