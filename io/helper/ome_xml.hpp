// OME-XML in the description of a TIFF file: sizes, spacing, channels, times, and which page each
// plane is. https://docs.openmicroscopy.org/ome-model.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "palpate/volume.hpp"

namespace palpate::io {

struct OmeImage {
    std::string format;
    std::array<std::int64_t, 3> sizes = {1, 1, 1};  ///< of z, channels, times
    std::array<std::int64_t, 2> plane_size{};       ///< x, y; 0: it does not say
    std::string type;                               ///< of the samples; empty: it does not say
    std::array<double, 3> spacing = {1, 1, 1};      ///< z, y, x [mm]
    std::string spacing_note;                       ///< what was chosen; to be said if it is used
    std::string distance_note;                      ///< the same, if there are several slices
    std::vector<std::string> channels;              ///< names; empty: one
    double frame_interval = 0;                      ///< [s]; 0: it does not say
    std::vector<std::uint32_t> pages;               ///< of each plane

    /// What was chosen of the spacing of so many slices; empty: nothing.
    const std::string& note_on_spacing(std::int64_t slices) const {
        return spacing_note.empty() && slices > 1 ? distance_note : spacing_note;
    }
    /// Its place in `pages`: z fastest, then channels.
    std::size_t plane(std::int64_t z, std::int64_t channel, std::int64_t time) const {
        return static_cast<std::size_t>((time * sizes[1] + channel) * sizes[0] + z);
    }
};

/// Enters spacings along x, y and z, each in its unit; those that are not given are NaN. Where no
/// unit is a known length, their ratio is kept. `source` of them: "its OME-XML".
void set_spacing(OmeImage& image, const Vec3& spacings, const std::array<std::string, 3>& units,
                 const std::string& source);

/// How a program counts the pages of a file.
struct CountedPages {
    std::string format;
    std::string order = "XYCZT";                 ///< of the pages
    std::array<std::int64_t, 3> sizes{1, 1, 1};  ///< of z, channels, times
    Vec3 metres = Vec3::Zero();            ///< between samples along x, y, z; 0: it does not say
    double seconds = 0;                    ///< between times; 0: it does not say
    std::vector<std::size_t> planes = {};  ///< those that count, in order; empty: all
};

/// Gives its planes the pages that it has, as many as are counted.
void take_counts(OmeImage& image, const CountedPages& counted);

bool is_ome_xml(const std::string& description);

/// The first image in it; notes tell of others and of what is missing. Throws Failure, also for
/// planes in several files.
OmeImage ome_image(const std::string& xml, std::vector<std::string>& notes);

}  // namespace palpate::io
