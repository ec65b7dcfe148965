// Small XML files, as image formats have them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::io {

struct XmlElement {
    std::string name;  ///< without a prefix for its namespace
    std::string text;
    std::string attributes;  ///< names and values in turn, a zero after each
    std::vector<XmlElement> inner;

    /// Empty if there is none.
    std::string attribute(const std::string& wanted) const;
    /// All at the end of a path below this element: "ViewSetups/ViewSetup".
    std::vector<const XmlElement*> all(const std::string& path) const;
    /// The text of the first of them; empty if there is none.
    std::string text_of(const std::string& path) const;
};

/// At most 64 MiB, and no more than fits into this process's memory. Throws Failure, which names
/// the file or `where`.
XmlElement read_xml(const std::filesystem::path& file);
XmlElement parse_xml(const std::string& text, const std::string& where);

}  // namespace palpate::io
