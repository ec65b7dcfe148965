// Text of DICOM in UTF-8, whatever its character set (PS3.3 C.12.1.1.2, PS3.5 6.1).
#pragma once

#include <string>

namespace palpate::io {

/// `set` is SpecificCharacterSet, as it is written. Bytes that it does not explain become "\xNN",
/// never other letters.
std::string utf8_of(const std::string& bytes, const std::string& set);

}  // namespace palpate::io
