// Dates and times of DICOM as text (PS3.5 6.2: DA, TM, DT).
#pragma once

#include <string>

namespace palpate::io {

/// [s] from any moment on, the same for all, in Coordinated Universal Time. NaN: not given.
/// `offset` (TimezoneOffsetFromUTC, "+0100") holds for dates and times that give none.
double moment_of(const std::string& date, const std::string& time, const std::string& offset);
/// Of a date with a time.
double moment_of(const std::string& both, const std::string& offset);

}  // namespace palpate::io
