// Small XML documents. See the header.
#include "io/helper/xml.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string_view>

#include "io/helper/decode.hpp"

namespace palpate::io {
namespace {

constexpr std::size_t most_bytes = 64 << 20;

/// XML does not allow an attribute twice, and pugixml takes the first. Looks at the 32 before each,
/// which takes no memory: no element that counts has more.
class OnceEach : public pugi::xml_tree_walker {
  public:
    explicit OnceEach(const std::string& where) : where_(where) {}
    bool for_each(XmlElement& element) override {
        constexpr int reach = 32;
        for (const pugi::xml_attribute& one : element.attributes()) {
            const std::string_view name = one.name();
            pugi::xml_attribute before = one.previous_attribute();
            for (int n = 0; n < reach && before; ++n, before = before.previous_attribute()) {
                if (before.name() != name) continue;
                throw Failure(where_ + " has the attribute '" + std::string(name.substr(0, 40)) +
                              "' twice in one element; remove the wrong one");
            }
        }
        return true;
    }

  private:
    const std::string& where_;
};

}  // namespace

std::vector<XmlElement> elements_at(const XmlElement& from, const std::string& path) {
    const std::size_t slash = std::min(path.find('/'), path.size());
    const std::string name = path.substr(0, slash);
    std::vector<XmlElement> found;
    for (const XmlElement& one : from.children()) {
        const std::string_view whole = one.name();
        if (whole.substr(whole.find(':') + 1) != name) continue;  // npos + 1 is 0
        if (slash == path.size()) {
            found.push_back(one);
        } else {
            const auto deeper = elements_at(one, path.substr(slash + 1));
            found.insert(found.end(), deeper.begin(), deeper.end());
        }
    }
    return found;
}

std::string text_at(const XmlElement& from, const std::string& path) {
    const auto found = elements_at(from, path);
    return found.empty() ? "" : found[0].text().get();
}

pugi::xml_document parse_xml(const std::string& text, const std::string& where) {
    constexpr unsigned flags = pugi::parse_default | pugi::parse_fragment;  // to see all at the top
    pugi::xml_document document;
    const bool is_long = text.size() > most_bytes;
    const auto status = is_long ? pugi::status_out_of_memory
                                : document.load_buffer(text.data(), text.size(), flags).status;
    if (status == pugi::status_out_of_memory) {
        throw Failure(where + " is too large for the memory that may be used; save it with " +
                      "less metadata, or allow more memory");
    }
    const XmlElement root = document.first_child();
    if (status != pugi::status_ok || root.type() != pugi::node_element || root.next_sibling()) {
        throw Failure(where + " is no XML; write it again");
    }
    OnceEach check(where);
    document.traverse(check);
    return document;
}

pugi::xml_document read_xml(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::error_code error;
    if (!in || std::filesystem::file_size(file, error) > most_bytes || error) {
        throw Failure(quoted(file) + " beside it cannot be read or is too long");
    }
    return parse_xml({std::istreambuf_iterator<char>(in), {}}, quoted(file) + " beside it");
}

}  // namespace palpate::io
