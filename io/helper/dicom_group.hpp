// The elements of a DICOM data set or of an item of a sequence, read leniently: missing
// ones are empty.
#pragma once

#include <gdcmDataSet.h>
#include <gdcmSequenceOfItems.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace palpate::io {

struct DicomTag {
    std::uint16_t group = 0, element = 0;
    bool operator==(const DicomTag&) const = default;
};

class DicomGroup {
  public:
    using Sequence = gdcm::SmartPointer<gdcm::SequenceOfItems>;
    /// The data set must live as long; `of` is the sequence that holds it.
    explicit DicomGroup(const gdcm::DataSet& data, Sequence of = nullptr)
        : data_(&data), of_(std::move(of)) {}

    /// Each of its values without padding.
    std::string text(DicomTag tag) const;
    /// Words of a person in UTF-8, by the SpecificCharacterSet of the file.
    std::string words(DicomTag tag, const std::string& set) const;
    /// Numbers as text (DS, IS). Throws Failure where they make no sense.
    std::vector<double> numbers(DicomTag tag) const;
    /// The first of them, if it is within +-1e9.
    double number(DicomTag tag, double otherwise) const;
    /// The first of them; NaN if there is none, or if it makes no sense.
    double optional_number(DicomTag tag) const;
    /// Binary ones of the type that the standard gives the tag (US, UL, FD).
    template <class T>
    std::vector<T> binary(DicomTag tag) const {
        const std::string raw = bytes(tag);
        std::vector<T> values(raw.size() / sizeof(T));
        if (!values.empty()) std::memcpy(values.data(), raw.data(), values.size() * sizeof(T));
        return values;
    }
    /// The first of them (FD), or NaN.
    double real(DicomTag tag) const;
    /// Unsigned binary ones (US, UL).
    std::vector<std::uint32_t> counts(DicomTag tag) const;
    /// Tags (AT).
    std::vector<DicomTag> tags(DicomTag tag) const;
    bool has(DicomTag tag) const;
    /// The items of a sequence.
    std::vector<DicomGroup> items(DicomTag tag) const;

  private:
    /// As GDCM holds them: numbers in this machine's order.
    std::string bytes(DicomTag tag) const;
    /// The type that the file gives, or else that of GDCM's dictionary.
    std::string representation(DicomTag tag) const;
    const gdcm::DataSet* data_;
    Sequence of_;
};

}  // namespace palpate::io
