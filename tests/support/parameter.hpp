// Tests with an interpolation as their parameter are listed with its name, not with its bytes.
// Structs that are parameters have an operator<<, which GoogleTest uses in the same way.
#pragma once

#include <gtest/gtest.h>

#include <ostream>

#include "palpate/field.hpp"

namespace palpate {

inline void PrintTo(Interpolation interpolation, std::ostream* out) {
    *out << name_of(interpolation);
}

}  // namespace palpate
