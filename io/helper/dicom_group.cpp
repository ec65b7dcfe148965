// Reads elements of a DICOM data set. See the header.
#include "io/helper/dicom_group.hpp"

#include <gdcmDicts.h>
#include <gdcmGlobal.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <sstream>

#include "io/helper/dicom_text.hpp"
#include "io/helper/headers.hpp"

namespace palpate::io {
namespace {

gdcm::Tag tag_of(DicomTag tag) {
    return {tag.group, tag.element};
}

}  // namespace

bool DicomGroup::has(DicomTag tag) const {
    return data_->FindDataElement(tag_of(tag));
}

std::string DicomGroup::bytes(DicomTag tag) const {
    if (!has(tag)) return {};
    const gdcm::ByteValue* value = data_->GetDataElement(tag_of(tag)).GetByteValue();
    return value == nullptr ? std::string()
                            : std::string(value->GetPointer(), std::size_t(value->GetLength()));
}

std::string DicomGroup::representation(DicomTag tag) const {
    if (!has(tag)) return {};
    gdcm::VR vr = data_->GetDataElement(tag_of(tag)).GetVR();
    if (vr == gdcm::VR::INVALID || vr == gdcm::VR::UN) {
        vr = gdcm::Global::GetInstance().GetDicts().GetDictEntry(tag_of(tag)).GetVR();
    }
    return vr == gdcm::VR::INVALID ? std::string() : gdcm::VR::GetVRString(vr);
}

std::string DicomGroup::text(DicomTag tag) const {
    std::istringstream values(bytes(tag));
    std::string all;
    for (std::string value; std::getline(values, value, '\\');) {
        value.resize(strnlen(value.c_str(), value.size()));
        all += trimmed(value) + '\\';
    }
    if (!all.empty()) all.pop_back();
    return all;
}

std::string DicomGroup::words(DicomTag tag, const std::string& set) const {
    const std::string raw = bytes(tag);
    return trimmed(utf8_of(raw.substr(0, raw.find('\0')), set));
}

std::vector<double> DicomGroup::numbers(DicomTag tag) const {
    const auto reals = [&](auto zero) {
        const auto values = binary<decltype(zero)>(tag);
        return std::vector<double>(values.begin(), values.end());
    };
    const std::string vr = representation(tag);
    if (vr == "FD") return reals(double{});
    if (vr == "FL") return reals(float{});
    if (vr == "SS") return reals(std::int16_t{});
    if (vr == "US") return reals(std::uint16_t{});
    if (vr == "SL") return reals(std::int32_t{});
    if (vr == "UL") return reals(std::uint32_t{});
    std::string value = text(tag);
    std::replace(value.begin(), value.end(), '\\', ' ');
    char name[40];
    std::snprintf(name, sizeof name, "DICOM tag (%04x,%04x)", tag.group, tag.element);
    return numbers_in(value, name);
}

double DicomGroup::number(DicomTag tag, double otherwise) const {
    const auto all = numbers(tag);
    return all.empty() || !(std::abs(all[0]) < 1e9) ? otherwise : all[0];
}

double DicomGroup::optional_number(DicomTag tag) const {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    try {
        return number(tag, none);
    } catch (const Failure&) {
        return none;
    }
}

double DicomGroup::real(DicomTag tag) const {
    const auto all = binary<double>(tag);
    return all.empty() ? std::numeric_limits<double>::quiet_NaN() : all[0];
}

std::vector<std::uint32_t> DicomGroup::counts(DicomTag tag) const {
    if (representation(tag) == "UL") return binary<std::uint32_t>(tag);
    const auto narrow = binary<std::uint16_t>(tag);
    return {narrow.begin(), narrow.end()};
}

std::vector<DicomTag> DicomGroup::tags(DicomTag tag) const {
    const auto parts = binary<std::uint16_t>(tag);
    std::vector<DicomTag> all;
    for (std::size_t i = 0; i + 1 < parts.size(); i += 2) all.push_back({parts[i], parts[i + 1]});
    return all;
}

std::vector<DicomGroup> DicomGroup::items(DicomTag tag) const {
    std::vector<DicomGroup> all;
    if (!has(tag)) return all;
    const auto sequence = data_->GetDataElement(tag_of(tag)).GetValueAsSQ();
    if (sequence == nullptr) return all;
    for (gdcm::SequenceOfItems::SizeType i = 1; i <= sequence->GetNumberOfItems(); ++i) {
        all.emplace_back(sequence->GetItem(i).GetNestedDataSet(), sequence);
    }
    return all;
}

}  // namespace palpate::io
