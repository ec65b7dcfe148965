// Sets up the volume mapper for graphics hardware or for the processor.
#include "apps/viewer/scene/volume_part.hpp"

#include <vtkAOSDataArrayTemplate.h>
#include <vtkColorTransferFunction.h>
#include <vtkFixedPointVolumeRayCastMapper.h>
#include <vtkGPUVolumeRayCastMapper.h>
#include <vtkImageData.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkPiecewiseFunction.h>
#include <vtkPointData.h>
#include <vtkVolumeProperty.h>

#include <cmath>

namespace palpate::viewer {
namespace {

vtkSmartPointer<vtkDataArray> samples_of(const Volume& volume) {
    return with_type(volume.type(), [&](auto zero) -> vtkSmartPointer<vtkDataArray> {
        using T = decltype(zero);
        auto array = vtkSmartPointer<vtkAOSDataArrayTemplate<T>>::New();
        const auto samples = volume.samples<T>();
        // VTK only reads them.
        array->SetArray(const_cast<T*>(samples.data()), static_cast<vtkIdType>(samples.size()), 1);
        return array;
    });
}

/// Spacing is the image's, direction (mirrored, too) and place are the prop's: mappers honour
/// those.
vtkSmartPointer<vtkMatrix4x4> placed(const Geometry& g, const Vec3& origin) {
    auto matrix = vtkSmartPointer<vtkMatrix4x4>::New();
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            matrix->SetElement(row, column, g.direction(row, column));
        }
        matrix->SetElement(row, 3, g.origin[row] - origin[row]);
    }
    return matrix;
}

/// From black at the first level to white at the last, opaque but for what is as good as empty.
std::vector<ControlPoint> projected(const std::vector<ControlPoint>& points) {
    constexpr double empty = 0.03;
    const double low = points.front().level, high = points.back().level;
    return {{low, {0, 0, 0}, 0},
            {std::lerp(low, high, empty), {empty, empty, empty}, 1},
            {high, {1, 1, 1}, 1}};
}

}  // namespace

VolumePart::VolumePart(const Volume& volume, const Vec3& origin, bool hardware)
    : volume_(volume), prop_(vtkSmartPointer<vtkVolume>::New()), hardware_(hardware) {
    const Geometry& g = volume.geometry();
    vtkNew<vtkImageData> image;
    image->SetDimensions(g.size[0], g.size[1], g.size[2]);
    image->SetSpacing(g.spacing[0], g.spacing[1], g.spacing[2]);
    image->GetPointData()->SetScalars(samples_of(volume_));
    if (hardware) {
        auto mapper = vtkSmartPointer<vtkGPUVolumeRayCastMapper>::New();
        mapper->AutoAdjustSampleDistancesOff();
        mapper->UseJitteringOn();
        mapper_ = mapper;
    } else {
        auto mapper = vtkSmartPointer<vtkFixedPointVolumeRayCastMapper>::New();
        mapper->AutoAdjustSampleDistancesOff();
        mapper->LockSampleDistanceToInputSpacingOff();
        mapper_ = mapper;
    }
    mapper_->SetInputData(image);
    mapper_->SetBlendModeToComposite();
    prop_->SetMapper(mapper_);
    prop_->SetUserMatrix(placed(g, origin));
    vtkVolumeProperty* const p = prop_->GetProperty();
    p->SetInterpolationTypeToLinear();
    p->SetAmbient(0.25);
    p->SetDiffuse(0.8);
    p->SetSpecular(0.12);
    p->SetSpecularPower(20);
}

void VolumePart::set_look(const Look& look, double layer) {
    vtkVolumeProperty* const p = prop_->GetProperty();
    const bool shading = look.shading && !look.maximum;
    if (p->GetShade() != int(shading)) p->SetShade(shading);
    if (look.transfer == transfer_ && look.maximum == maximum_ && layer == layer_) return;
    transfer_ = look.transfer;
    maximum_ = look.maximum;
    layer_ = layer;
    maximum_ ? mapper_->SetBlendModeToMaximumIntensity() : mapper_->SetBlendModeToComposite();
    vtkNew<vtkColorTransferFunction> colour;
    vtkNew<vtkPiecewiseFunction> opacity;
    const std::vector<ControlPoint> points =
        maximum_ ? projected(transfer_.points) : transfer_.points;
    for (const ControlPoint& point : points) {
        colour->AddRGBPoint(point.level, point.colour.red, point.colour.green, point.colour.blue);
        opacity->AddPoint(point.level, point.opacity);
    }
    p->SetColor(colour);
    p->SetScalarOpacity(opacity);
    p->SetScalarOpacityUnitDistance(layer);
}

void VolumePart::set_fineness(double pixels, double step) {
    const auto set = [&](auto* mapper) {
        mapper->SetImageSampleDistance(static_cast<float>(pixels));
        mapper->SetSampleDistance(static_cast<float>(step));
    };
    if (hardware_) {
        set(vtkGPUVolumeRayCastMapper::SafeDownCast(mapper_));
    } else {
        set(vtkFixedPointVolumeRayCastMapper::SafeDownCast(mapper_));
    }
}

}  // namespace palpate::viewer
