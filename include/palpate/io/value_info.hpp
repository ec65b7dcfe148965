// The meaning of a file's values, as its header gives it.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace palpate::io {

/// The values between which a picture goes from black to white [data units]; width > 0.
struct ValueWindow {
    double centre = 0, width = 1;
};

/// The meaning of a sample's value in a label map, in which tissues and organs are numbered.
struct LabelName {
    int value = 0;
    std::string name;
    std::array<double, 3> colour{0.5, 0.5, 0.5};  ///< sRGB, 0 to 1
};

/// Members are empty if the header does not give them.
struct ValueInfo {
    std::string modality;               ///< of DICOM: "CT", "MR", ...
    std::string units;                  ///< "HU", ...
    std::optional<ValueWindow> window;  ///< suggested by the file
    std::optional<double> padding;      ///< [data units] of samples that were not measured
    std::vector<LabelName> labels;      ///< of 3D Slicer's segmentations (.seg.nrrd)
};

}  // namespace palpate::io
