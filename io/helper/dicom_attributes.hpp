// Reads the properties of a DICOM slice from its elements or from a functional group: place, size
// of pixels, slope and intercept, and the moment. Its kind (echo, segment ...) is read, too,
// because series are told apart by it.
#pragma once

#include <map>

#include "io/helper/dicom_group.hpp"
#include "io/helper/dicom_slice.hpp"

namespace palpate::io {

/// The functional groups of each frame, and SpacingBetweenSlices.
inline constexpr DicomTag groups_of_frames{0x5200, 0x9230}, between_tag{0x0018, 0x0088};
/// RealWorldValueMappingSequence, which is not applied.
inline constexpr DicomTag value_mapping{0x0040, 0x9096};

/// Elements that are not there change nothing. All of these throw Failure.
void set_place(DicomSlice& slice, const std::vector<double>& position,
               const std::vector<double>& axes);
void set_place(DicomSlice& slice, const DicomGroup& group);
void set_pixel(DicomSlice& slice, const DicomGroup& measures);

/// The meaning of the numbers of a file. Throws Failure.
void set_values(DicomSlice& slice, const DicomGroup& data);
/// What depends on the slope and the units of the frame: padding, and whether a CT is in HU. Once
/// these are known.
void finish_values(DicomSlice& slice, const DicomGroup& data);
/// Of a frame, from its functional groups. Elements that are not there change nothing.
void set_rescale(DicomSlice& slice, const DicomGroup& transformation);
void set_window(DicomSlice& slice, const DicomGroup& group);
void note_value_mapping(DicomSlice& slice);

/// The groups of attributes that a frame has of its own or shares with all.
class FunctionalGroups {
  public:
    FunctionalGroups(const DicomGroup& frame, const DicomGroup* shared)
        : frame_(frame), shared_(shared) {}

    /// What `use` makes of the first item of the group, if there is one.
    template <class F>
    void with(DicomTag group, F&& use) const {
        auto items = frame_.items(group);
        if (items.empty() && shared_ != nullptr) items = shared_->items(group);
        if (!items.empty()) use(items.front());
    }

  private:
    const DicomGroup& frame_;
    const DicomGroup* shared_;
};

/// Names of segments, by their numbers.
using Segments = std::map<std::uint32_t, std::string>;
Segments segments_in(const DicomGroup& data);

/// Of a file, from its data set.
void set_kind(DicomSlice& slice, const DicomGroup& data);
void set_moment(DicomSlice& slice, const DicomGroup& data);

/// Properties by which images of one place may differ, of a file and of a frame.
void set_traits(DicomSlice& slice, const DicomGroup& data);
void set_traits(DicomSlice& slice, const FunctionalGroups& groups);

/// Of a frame, from its functional groups.
void set_kind(DicomSlice& slice, const FunctionalGroups& groups, const Segments& segments);
void set_moment(DicomSlice& slice, const FunctionalGroups& groups);

}  // namespace palpate::io
