// Volume rendering of a field, by graphics hardware or by the processor.
#pragma once

#include <vtkSmartPointer.h>
#include <vtkVolume.h>
#include <vtkVolumeMapper.h>

#include "apps/viewer/model/look.hpp"
#include "palpate/volume.hpp"

namespace palpate::viewer {

/// One volume in VTK's terms. The samples are not copied; the volume is held as long.
class VolumePart {
  public:
    /// `origin` [mm, physical] becomes the origin of what is drawn.
    VolumePart(const Volume& volume, const Vec3& origin, bool hardware);

    vtkVolume* prop() const { return prop_; }
    /// True if this is the part for these samples.
    bool shows(const Volume& volume) const { return volume.data() == volume_.data(); }
    /// Opacities are for a layer as thick as `layer` [mm]. A maximum intensity projection goes from
    /// black at the transfer function's first level to white at its last.
    void set_look(const Look& look, double layer);
    /// The distance of the pixels that are cast (1: all), and how far apart the samples along
    /// a ray are [mm].
    void set_fineness(double pixels, double step);

  private:
    Volume volume_;
    vtkSmartPointer<vtkVolume> prop_;
    vtkSmartPointer<vtkVolumeMapper> mapper_;
    TransferFunction transfer_;
    bool maximum_ = false;
    double layer_ = 0;
    bool hardware_;
};

}  // namespace palpate::viewer
