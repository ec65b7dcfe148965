// The character sets of DICOM texts (PS3.3 C.12.1.1.2). Uses iconv of the C library.
#pragma once

#include <string>

namespace palpate::io {

/// A text of the sets that SpecificCharacterSet names, in UTF-8. Bytes that are none of these
/// characters, or of sets that are not known, become \xNN.
std::string dicom_in_utf8(const std::string& text, const std::string& sets);

}  // namespace palpate::io
