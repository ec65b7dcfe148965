// The DICOM series in a file or folder, from which one has to be chosen.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "palpate/io/error.hpp"
#include "palpate/volume.hpp"

namespace palpate::io {

/// A grey picture, rows from the top.
struct Thumbnail {
    int width = 0, height = 0;  ///< 0: there is none
    std::vector<std::uint8_t> grey;
};

/// A series, or one stack of a series. Texts are empty if the header does not give them.
struct SeriesInfo {
    std::string uid;
    std::string patient, study, description, modality;
    std::string stack;            ///< of a file with several frames
    int slices = 0;               ///< or frames
    std::array<int, 2> size{};    ///< columns and rows
    Vec3 spacing = Vec3::Zero();  ///< [mm] between columns, rows and slices; 0: not known
    Thumbnail picture;            ///< of the middle slice, if requested
};
/// "3 slices of 512x512, CT 'HEAD', 0.5 x 0.5 x 5 mm, patient 'A', study 'B', UID"
std::string text_of(const SeriesInfo& series);

/// Thrown if a file or folder has several series, and the caller named none or an unknown one. They
/// are counted from 1.
class SeriesChoice : public InputError {
  public:
    SeriesChoice(const std::string& message, std::vector<SeriesInfo> series)
        : InputError(message), series_(std::move(series)) {}
    const std::vector<SeriesInfo>& series() const { return series_; }

  private:
    std::vector<SeriesInfo> series_;
};

}  // namespace palpate::io
