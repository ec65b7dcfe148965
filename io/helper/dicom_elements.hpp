// Reads the elements of a DICOM file one after the other: tag, type and length, also where a writer
// has left types out (PS3.5 chapter 7).
#pragma once

#include <map>

#include "io/helper/dicom_bytes.hpp"

namespace palpate::io {

struct DicomElement {
    std::uint32_t tag = 0;
    std::uint32_t length = 0;
    std::string vr;
};

/// For a walk through the file, which derives from this.
class DicomElements {
  protected:
    explicit DicomElements(const std::filesystem::path& file) : file_(file), bytes_(file) {}

    /// Throws Failure, which names the file.
    [[noreturn]] void fail(const std::string& what) const;

    /// Throws Failure beyond the end of the file.
    template <class T>
    T number(std::uint64_t at) {
        if (!bytes_.reaches(at + sizeof(T))) fail("is cut off");
        return bytes_.number<T>(at);
    }

    /// Reads tag, type and length; moves `at` to the value.
    DicomElement element(std::uint64_t& at, bool is_explicit);
    /// Whether two letters stand for a type.
    static bool is_type(const std::string& letters);

    const std::filesystem::path& file_;
    DicomBytes bytes_;
    bool lacks_types_ = false;                          ///< some elements were read without a type
    std::map<std::uint64_t, std::string> given_types_;  ///< to those without one, by their places

  private:
    std::uint32_t tag_at(std::uint64_t at);
    /// Moves `at` from the type to the value.
    void take_length(std::uint64_t& at, DicomElement& e, bool is_long);
    bool takes_empty_type(std::uint64_t& at, DicomElement& e);
    bool goes_on(std::uint64_t at, DicomElement e, bool is_long);
};

}  // namespace palpate::io
