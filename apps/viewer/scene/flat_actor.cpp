// Makes the actors of marks.
#include "apps/viewer/scene/flat_actor.hpp"

#include <vtkNew.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>

namespace palpate::viewer {

vtkSmartPointer<vtkActor> flat_actor(vtkPolyData* data, const pictures::Colour& colour) {
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(data);
    auto actor = vtkSmartPointer<vtkActor>::New();
    actor->SetMapper(mapper);
    actor->GetProperty()->LightingOff();
    actor->GetProperty()->SetColor(colour.red, colour.green, colour.blue);
    return actor;
}

}  // namespace palpate::viewer
