// Small XML files. See the header.
#include "io/helper/xml.hpp"

#include <vtkNew.h>
#include <vtkOutputWindow.h>
#include <vtkSmartPointer.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLUtilities.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "io/helper/decode.hpp"
#include "io/helper/vtk_errors.hpp"

namespace palpate::io {
namespace {

constexpr std::size_t most_bytes = 64 << 20;
constexpr int deepest = 64;

std::string without_prefix(const std::string& name) {
    return name.substr(name.find(':') == std::string::npos ? 0 : name.find(':') + 1);
}

XmlElement element_from(vtkXMLDataElement* from, const std::string& where, int depth) {
    if (depth > deepest) throw Failure(where + " has elements within elements without an end");
    XmlElement element;
    element.name = without_prefix(from->GetName() ? from->GetName() : "");
    element.text = from->GetCharacterData() ? from->GetCharacterData() : "";
    for (int i = 0; i < from->GetNumberOfAttributes(); ++i) {
        element.attributes.emplace_back(from->GetAttributeName(i), from->GetAttributeValue(i));
    }
    for (int i = 0; i < from->GetNumberOfNestedElements(); ++i) {
        element.inner.push_back(element_from(from->GetNestedElement(i), where, depth + 1));
    }
    return element;
}

}  // namespace

std::string XmlElement::attribute(const std::string& wanted) const {
    for (const auto& [name_of, value] : attributes) {
        if (name_of == wanted) return value;
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
    const vtkNew<ErrorKeeper> errors;
    vtkOutputWindow::SetInstance(errors);
    const auto root = vtkSmartPointer<vtkXMLDataElement>::Take(
        vtkXMLUtilities::ReadElementFromString(text.c_str()));
    vtkOutputWindow::SetInstance(nullptr);
    if (!root || !errors->first().empty()) throw Failure(where + " is no XML; write it again");
    return element_from(root, where, 0);
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
