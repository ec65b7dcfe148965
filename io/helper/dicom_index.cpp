// Compares a DICOMDIR with the files beside it. See the header.
#include "io/helper/dicom_index.hpp"

#include <gdcmReader.h>

#include <algorithm>
#include <set>

#include "io/helper/dicom_group.hpp"
#include "io/helper/headers.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;

/// A name as all systems agree on it: in small letters, without the ";1" of discs, and without an
/// extension, which programs that copy discs add.
std::string plain_name(std::string name) {
    std::ranges::replace(name, '\\', '/');
    name = lower(name.substr(0, name.find(';')));
    const std::size_t point = name.rfind('.');
    const bool is_extension = point != name.npos && name.find('/', point) == name.npos;
    return is_extension ? name.substr(0, point) : name;
}

}  // namespace

std::vector<std::string> images_missing(const fs::path& index, const std::vector<fs::path>& files) {
    gdcm::Reader reader;
    reader.SetFileName(index.string().c_str());
    if (!reader.Read()) return {};
    std::set<std::string> there;
    for (const fs::path& file : files) {
        there.insert(plain_name(file.lexically_relative(index.parent_path()).generic_string()));
    }
    std::vector<std::string> missing;
    std::size_t listed = 0;
    const DicomGroup data(reader.GetFile().GetDataSet());
    for (const DicomGroup& record : data.items({0x0004, 0x1220})) {
        const std::string name = record.text({0x0004, 0x1500});
        if (record.text({0x0004, 0x1430}) != "IMAGE" || name.empty()) continue;
        ++listed;
        if (!there.contains(plain_name(name))) missing.push_back(name);
    }
    return missing.size() == listed ? std::vector<std::string>() : missing;
}

}  // namespace palpate::io
