// VTK's number for a sample type. For helper programs that link VTK.
#pragma once

#include <vtkTypeTraits.h>

#include "palpate/volume.hpp"

namespace palpate::io {

inline int vtk_type(SampleType type) {
    return with_type(type,
                     [](auto zero) -> int { return vtkTypeTraits<decltype(zero)>::VTK_TYPE_ID; });
}

}  // namespace palpate::io
