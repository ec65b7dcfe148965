// A finer part of what is shown, where the whole is an overview of a store.
#pragma once

#include "palpate/field.hpp"

namespace palpate::viewer {

struct DetailField {
    Field field;              ///< on a grid of its own, all in memory
    SampleBox box;            ///< where that lies in the grid of `level`
    Index3 level_size;        ///< samples of the whole level
    int level = 0;            ///< of the store
    std::size_t missing = 0;  ///< pieces that have not come: coarser samples stand in for them
    SampleBox changed = {};   ///< of the field's grid, since the last version of this box

    /// True where the box ends with the data.
    bool at_begin(int axis) const { return box.low[axis] == 0; }
    bool at_end(int axis) const { return box.high[axis] == level_size[axis] - 1; }
};

}  // namespace palpate::viewer
