// Camera and lights for VTK.
#include "apps/viewer/scene/view_space.hpp"

#include <vtkLight.h>
#include <vtkNew.h>

#include <algorithm>

namespace palpate::viewer {

double reach_of(const Geometry& geometry) {
    const Vec3 extent = geometry.size.cast<double>().cwiseProduct(geometry.spacing);
    // Twice the grid's own: a probe beside it is seen, too.
    return std::max(1e-6, extent.norm());
}

void direct(vtkCamera& camera, const pictures::Camera& wanted, const Vec3& origin, double reach) {
    const Vec3 towards = wanted.towards_viewer.normalized();
    const Vec3 focus = wanted.focus - origin;
    // The clipping planes are the same for all that is seen along one direction, whatever the
    // focus: depths do not change when a camera is panned.
    const Vec3 foot = focus - towards.dot(focus) * towards;
    camera.ParallelProjectionOn();
    camera.SetFocalPoint(Vec3(foot).data());
    camera.SetPosition(Vec3(foot + 1.05 * reach * towards).data());
    camera.SetViewUp(Vec3(wanted.up).data());
    camera.SetParallelScale(wanted.half_height);
    camera.SetClippingRange(0.05 * reach, 2.05 * reach);
}

double height_of(double depth, double reach) {
    return (1 - 2 * depth) * reach;
}

void light(vtkRenderer& renderer) {
    struct Lamp {
        double x, y, z, intensity;
    };
    renderer.AutomaticLightCreationOff();
    for (const Lamp& lamp : {Lamp{-0.55, 0.75, 1, 0.78}, Lamp{0.9, -0.1, 0.6, 0.26},
                             Lamp{0, 0, 1, 0.2}, Lamp{0.2, -1, 0.2, 0.12}}) {
        vtkNew<vtkLight> l;
        l->SetLightTypeToCameraLight();
        l->SetPosition(lamp.x, lamp.y, lamp.z);
        l->SetFocalPoint(0, 0, 0);
        l->SetIntensity(lamp.intensity);
        renderer.AddLight(l);
    }
}

}  // namespace palpate::viewer
