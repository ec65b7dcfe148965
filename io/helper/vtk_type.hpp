// VTK's number for a sample type. For helper programs that link VTK.
#pragma once

#include <vtkType.h>

#include "palpate/volume.hpp"

namespace palpate::io {

inline int vtk_type(SampleType type) {
    switch (type) {
        case SampleType::uint8:
            return VTK_UNSIGNED_CHAR;
        case SampleType::int16:
            return VTK_SHORT;
        case SampleType::uint16:
            return VTK_UNSIGNED_SHORT;
        case SampleType::float32:
            break;
    }
    return VTK_FLOAT;
}

}  // namespace palpate::io
