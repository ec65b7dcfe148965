// Small XML files, as image formats have them, by pugixml. Elements may have a prefix for their
// namespace, which does not count.
#pragma once

#include <filesystem>
#include <pugixml.hpp>
#include <string>
#include <vector>

namespace palpate::io {

using XmlElement = pugi::xml_node;

/// All at the end of a path below an element: "ViewSetups/ViewSetup".
std::vector<XmlElement> elements_at(const XmlElement& from, const std::string& path);
/// The text of the first of them; empty if there is none.
std::string text_at(const XmlElement& from, const std::string& path);

/// Documents of one root, at most 64 MiB, and no more than fits into this process's memory. Throws
/// Failure, which names the file or `where`.
pugi::xml_document read_xml(const std::filesystem::path& file);
pugi::xml_document parse_xml(const std::string& text, const std::string& where);

}  // namespace palpate::io
