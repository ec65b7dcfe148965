// What a file's header says of its values.
#pragma once

#include <optional>
#include <string>

namespace palpate::io {

/// The values between which a picture goes from black to white [data units]; width > 0.
struct ValueWindow {
    double centre = 0, width = 1;
};

/// Empty where the header does not say.
struct ValueInfo {
    std::string modality;               ///< of DICOM: "CT", "MR", ...
    std::string units;                  ///< "HU", ...
    std::optional<ValueWindow> window;  ///< suggested by who made the file
    std::optional<double> padding;      ///< [data units] of samples that were not measured
};

}  // namespace palpate::io
