// The options that say which volume, which side of it is solid and which level to feel; and loading
// it, from a file or synthetic.
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "palpate/field.hpp"
#include "palpate/io/live_frames.hpp"
#include "palpate/io/sequence.hpp"

namespace palpate::app {

struct VolumeOptions {
    std::string volume;
    std::string dims, type, spacing;  ///< for raw files
    std::uint64_t skip = 0;           ///< [bytes] header to skip in a raw file
    std::string series;               ///< DICOM series UID or number
    std::optional<int> time_step;     ///< of a sequence this frame alone
    double frame_interval = 0;        ///< [s] between frames; 0: what the file says
    int smooth = 0;                   ///< passes of the binomial kernel
    bool quiet = false;

    /// Declares VOLUME and its options on a command. An `optional` VOLUME has a default.
    void add_to(CLI::App& command, bool optional = false);
};

/// A volume and what is known of it.
struct LoadedVolume {
    Volume volume;
    std::string name;
    std::string format = {};
    std::vector<std::string> notes = {};
    std::optional<double> isovalue = {};  ///< a good one, of a synthetic volume
    io::Sequence sequence =
        {};  ///< `volume` is its first frame; none where `volume` is all there is
    std::shared_ptr<const io::LiveFrames> live =
        {};              ///< `volume` is what it began with; null: none
    int time_steps = 1;  ///< how many volumes there are, asked for or not
};

/// Reads or makes the volume. `progress` may throw to stop. Throws std::invalid_argument (wrong
/// use) and io::InputError.
LoadedVolume load(const VolumeOptions& options, const io::Progress& progress);

/// The names and values under which recordings and sessions keep a volume's options: "volume" is
/// its name, the rest are options without their dashes; those that were not given are left out.
std::map<std::string, std::string> to_names(const VolumeOptions& options);
/// The inverse; names it does not know are passed over, values that are none count as not given.
VolumeOptions options_from(const std::map<std::string, std::string>& names);

struct FieldOptions {
    std::string isovalue;
    std::string solid = "above";
    std::string background;

    void add_to(CLI::App& command);
    /// All but --isovalue, for a command that takes several.
    void add_side_to(CLI::App& command);
};

/// The field that the options ask for.
Field make_field(const LoadedVolume& loaded, const FieldOptions& options);
/// The isovalue asked for, else the synthetic volume's own; std::invalid_argument if there is none.
/// Prints a warning on standard error where there is nothing to feel.
double isovalue_of(const LoadedVolume& loaded, const Field& field, const FieldOptions& options);
/// The same, but for a file without --isovalue the first level that its histogram suggests.
double suggested_isovalue_of(const LoadedVolume& loaded, const Field& field, FieldOptions options);
/// Empty for a whole number from 0, else what is wrong: a check for CLI11, which takes -1 for
/// 2^64-1.
std::string flaw_in_count(const std::string& text);

}  // namespace palpate::app
