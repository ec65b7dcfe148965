// Traces as tables of arrays, one array a column.
#pragma once

#include <span>
#include <vector>

#include "bindings/python/casters.hpp"
#include "palpate/io/trace.hpp"

namespace palpate::python {

/// The columns of palpate.Trace by name.
py::dict columns_of(const std::vector<io::TraceRow>& rows);

}  // namespace palpate::python
