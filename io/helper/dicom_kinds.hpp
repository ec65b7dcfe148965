// The kind of an image (echo, segment ...), by which series are told apart, and its moment, as
// headers give them.
#pragma once

#include <map>

#include "io/helper/dicom_group.hpp"
#include "io/helper/dicom_slice.hpp"

namespace palpate::io {

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

/// Of a frame, from its functional groups.
void set_kind(DicomSlice& slice, const FunctionalGroups& groups, const Segments& segments);
void set_moment(DicomSlice& slice, const FunctionalGroups& groups);

}  // namespace palpate::io
