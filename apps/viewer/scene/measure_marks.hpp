// Draws measurements over the scene: points, lines between them, and what they measure.
#pragma once

#include <vtkActor.h>
#include <vtkPolyData.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkTextActor.h>

#include <vector>

#include "apps/viewer/model/measurement.hpp"
#include "apps/viewer/scene/navigation.hpp"

namespace palpate::viewer {

class MeasureMarks {
  public:
    /// Points and lines go into `overlay`, where nothing hides them; words into `writing`, whose
    /// units are pixels.
    MeasureMarks(vtkRenderer& overlay, vtkRenderer& writing);

    struct View {
        Vec3 origin = Vec3::Zero();  ///< [mm, physical] of what is drawn
        Camera camera;
        ViewSize size;           ///< [logical pixels]
        double pixel_ratio = 1;  ///< device pixels a logical pixel
        double em = 12;          ///< [device pixels] height of the words
        LengthUnit unit = LengthUnit::automatic;
    };
    void show(const std::vector<Measurement>& all, const View& view);

  private:
    void put_points(const std::vector<Measurement>& all, const View& view);
    void put_words(const std::vector<Measurement>& all, const View& view);

    vtkRenderer &overlay_, &writing_;
    vtkSmartPointer<vtkActor> lines_, dots_;
    vtkSmartPointer<vtkPolyData> line_data_, dot_data_;
    std::vector<vtkSmartPointer<vtkTextActor>> words_;
};

}  // namespace palpate::viewer
