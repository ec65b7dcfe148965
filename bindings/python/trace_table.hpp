// Traces as tables of arrays, one array a column.
#pragma once

#include <span>
#include <vector>

#include "bindings/python/casters.hpp"
#include "palpate/io/trace.hpp"

namespace palpate::python {

/// The columns of palpate.Trace by name.
py::dict columns_of(const std::vector<io::TraceRow>& rows);
/// What a trace of such a renderer has in addition.
io::TraceExtras extras_of(const RendererSettings& settings);
/// Puts them into the table: `layer_names`, `nested_layers`, `has_tool`.
void add_extras(py::dict& table, const io::TraceExtras& extras);

}  // namespace palpate::python
