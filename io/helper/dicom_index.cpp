// Compares a DICOMDIR with the files beside it. See the header.
#include "io/helper/dicom_index.hpp"

#include <algorithm>
#include <iterator>
#include <set>

#include "io/helper/dicom_elements.hpp"
#include "io/helper/headers.hpp"

namespace palpate::io {
namespace {

namespace fs = std::filesystem;

/// Walks through the records of an index. GDCM crashes on unusual ones.
class IndexRecords : private DicomElements {
  public:
    explicit IndexRecords(const fs::path& file) : DicomElements(file) {}

    /// The names of all images, as they are listed. Throws Failure.
    std::vector<std::string> images() {
        std::uint64_t at = 132;  // behind the preamble
        while (bytes_.reaches(at + 8)) {
            const DicomElement e = element(at, true);
            if (e.tag == 0x00041220) return images_from(at);
            if (e.length == unknown) break;
            at += e.length;
        }
        return {};
    }

  private:
    static constexpr std::uint32_t unknown = 0xffffffff;

    /// Of the items that begin at `at`. Marks of their ends have no value.
    std::vector<std::string> images_from(std::uint64_t at) {
        std::vector<std::string> names;
        std::string kind, name;
        const auto end_record = [&] {
            if (kind == "IMAGE" && !name.empty()) names.push_back(name);
            kind.clear();
            name.clear();
        };
        while (bytes_.reaches(at + 8)) {
            const DicomElement e = element(at, true);
            if (e.tag == 0xfffee000) end_record();  // its elements follow
            if (e.tag == 0xfffee0dd) break;
            if (e.tag >> 16 == 0xfffe) continue;
            if (e.length == unknown) fail("has records of an unusual kind");
            if (e.tag == 0x00041430) kind = value(at, e.length);
            if (e.tag == 0x00041500) name = value(at, e.length);
            at += e.length;
        }
        end_record();
        return names;
    }

    std::string value(std::uint64_t at, std::uint32_t length) {
        if (!bytes_.reaches(at + length)) fail("is cut off");
        const auto bytes = bytes_.view(at, length);
        const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        return trimmed(text.substr(0, text.find('\0')));
    }
};

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
    std::set<std::string> there;
    for (const fs::path& file : files) {
        there.insert(plain_name(file.lexically_relative(index.parent_path()).generic_string()));
    }
    std::vector<std::string> images;
    try {
        images = IndexRecords(index).images();
    } catch (const Failure&) {
        return {};
    }
    std::vector<std::string> missing;
    std::ranges::copy_if(images, std::back_inserter(missing), [&](const std::string& name) {
        return !there.contains(plain_name(name));
    });
    return missing.size() == images.size() ? std::vector<std::string>() : missing;
}

}  // namespace palpate::io
