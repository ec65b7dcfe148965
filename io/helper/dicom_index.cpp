// Compares a DICOMDIR with the files beside it. See the header.
#include "io/helper/dicom_index.hpp"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <set>
#include <utility>

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
        constexpr std::uint64_t preamble = 128;
        if (!bytes_.reaches(preamble + 4) || value(preamble, 4) != "DICM") fail("is no DICOM file");
        for (std::uint64_t at = preamble + 4; bytes_.reaches(at + 1);) {
            const DicomElement e = element(at, true);
            if (e.tag == 0x00041220) return images_from(at, e.length);
            at = end_of(at, e.length);
        }
        fail("has no list of files");
    }

  private:
    static constexpr std::uint32_t unknown = 0xffffffff;

    /// Where a value that begins at `at` ends.
    std::uint64_t end_of(std::uint64_t at, std::uint32_t length) {
        if (length == unknown) fail("has records of an unusual kind");
        if (!bytes_.reaches(at + length)) fail("is cut off");
        return at + length;
    }

    /// Of the items that begin at `at` and take `length` bytes or have a mark behind them. The
    /// items of a sequence in one of them, such as a small picture, are passed over.
    std::vector<std::string> images_from(std::uint64_t at, std::uint32_t length) {
        const bool has_mark = length == unknown;
        const std::uint64_t end = has_mark ? UINT64_MAX : end_of(at, length);
        std::vector<std::string> names;
        struct Record {
            std::string kind, name;
            bool is_in_use = true;
        } record;
        const auto end_record = [&] {
            const Record ended = std::exchange(record, {});
            if (ended.kind == "IMAGE" && ended.is_in_use && !ended.name.empty()) {
                names.push_back(ended.name);
            }
        };
        for (int depth = 0; at < end;) {
            const DicomElement e = element(at, true);
            if (e.tag == 0xfffee000 && depth == 0) end_record();  // its elements follow
            if (e.tag == 0xfffee0dd && --depth < 0) break;
            if (e.tag >> 16 == 0xfffe) continue;  // these have no value
            if (e.vr == "SQ" && e.length == unknown) {
                ++depth;
                continue;
            }
            const std::uint64_t next = end_of(at, e.length);
            if (depth == 0) {
                if (e.tag == 0x00041410 && e.length == 2) {
                    record.is_in_use = number<std::uint16_t>(at) != 0;
                }
                if (e.tag == 0x00041430) record.kind = value(at, e.length);
                if (e.tag == 0x00041500) record.name = value(at, e.length);
            }
            at = next;
        }
        if (!has_mark && at != end) fail("is damaged (a record is longer than the list)");
        end_record();
        return names;
    }

    std::string value(std::uint64_t at, std::uint32_t length) {
        (void)end_of(at, length);
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
    const std::vector<std::string> images = IndexRecords(index).images();
    std::vector<std::string> missing;
    std::ranges::copy_if(images, std::back_inserter(missing), [&](const std::string& name) {
        return !there.contains(plain_name(name));
    });
    return missing.size() == images.size() ? std::vector<std::string>() : missing;
}

}  // namespace palpate::io
