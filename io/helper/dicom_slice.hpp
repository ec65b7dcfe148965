// The contents of the header of a DICOM slice, and slices that belong together.
#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <memory>

#include "io/helper/decode.hpp"

namespace palpate::io {

/// What stored numbers mean, from `first` on; those below and above are as the first and last one.
struct ValueTable {
    std::int32_t first = 0;
    std::vector<std::uint16_t> values;
};

/// What tells moments of one place apart, the most telling first; DimensionIndexValues follow.
enum DicomKey : std::size_t {
    file_number,  ///< of files with several frames, InstanceNumber
    temporal_position,
    trigger_time,
    cardiac_phase,
    reference_time,
    acquisition_time,
    content_time,
    acquisition_number,
    frame_number,  ///< or InstanceNumber of a file with one
    first_dimension
};

/// A property other than its moment, by which the images of one place may differ: the inversion
/// time, the kernel ...
struct DicomTrait {
    const char* name = "";
    const char* unit = "";
    double number = std::numeric_limits<double>::quiet_NaN();  ///< or else it is a word
    std::string word;
    bool is_series = true;  ///< slices that differ by it are series, or moments of one
};

/// What the header of one slice says.
struct DicomSlice {
    std::filesystem::path file;
    std::string series_uid, instance_uid, description;
    std::string patient, study;
    std::string clock_offset;  ///< of its clock against Coordinated Universal Time
    std::string patient_id, study_uid, frame_of_reference;
    std::string stack, kind;  ///< stacks of one file; magnitude, phase, echoes, segments ...
    std::string contrast;     ///< what else may tell images of one place apart: water, fat ...
    std::vector<DicomTrait> traits;                          ///< the same; one of a name
    double echo = std::numeric_limits<double>::quiet_NaN();  ///< [ms] EchoTime; NaN: not given
    ValueInfo values;
    int rows = 0, columns = 0;
    int frames = 1, frame = 0;       ///< how many its file has, and which of them it is
    int instance = 0;                ///< InstanceNumber of its file
    int order = 0;                   ///< of the places of the frames of a file
    bool is_numbered = false;        ///< `order` is its number in its stack
    std::vector<double> keys;        ///< by DicomKey; NaN or missing where the header does not say
    std::optional<Vec3> position;    ///< [mm, LPS] centre of the first pixel
    bool in_patient = true;          ///< or in the space of a transducer
    bool is_sided = true;            ///< it is known on which side of the others it lies
    std::optional<double> location;  ///< [mm] of a slice that may have no position
    const char* location_source = "SliceLocation";
    std::optional<Vec3> row, column;  ///< unit vectors along a row and along a column
    std::optional<Vec3> pixel;        ///< [mm] between columns, between rows, 0
    double aspect = 1;                ///< of a pixel, height : width, if its size is not given
    double between = 0;    ///< [mm] SpacingBetweenSlices, negative against the normal; 0: not given
    double thickness = 0;  ///< [mm] between slices or of one; 0 if not given
    double slope = 1, intercept = 0;  ///< of the values [units]
    int bits = 16;                    ///< allocated for a stored number
    double least = 0, most = 65535;   ///< of these numbers
    bool is_real = false;             ///< or floating-point ones
    bool has_rescale = false;         ///< it gives both of these, or a table
    bool has_colours = false;
    bool is_moment = false;  ///< the frames of its file are one place at several times
    double seconds = 0;      ///< from one of them to the next; 0 if not given
    std::shared_ptr<const ValueTable> table = {};  ///< of the values; null: slope and intercept
    std::string compression;         ///< "JPEG 2000", "deflate", ...; empty if there is none
    std::vector<std::string> notes;  ///< on the file

    /// Whether it has a position and an orientation.
    bool is_placed() const { return position && row && column; }
    /// Of a slice with an orientation.
    Vec3 normal() const { return row->cross(*column).normalized(); }
};

/// Slices that belong together: one series UID, one stack, one size, one orientation.
struct DicomSeries {
    std::string uid;
    std::vector<DicomSlice> slices;
};

}  // namespace palpate::io
