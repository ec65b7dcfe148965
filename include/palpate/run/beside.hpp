// Places an overlay or a label volume beside the volume that is touched, if its own file does not
// give its orientation or spacing.
#pragma once

#include <memory>
#include <string>

#include "palpate/field.hpp"
#include "palpate/io/orientation.hpp"
#include "palpate/run/source.hpp"

namespace palpate::run {

/// The orientation and spacing that were given for a file or store in place of its own.
io::GivenGrid given_grid(const Source& source);

/// The grid of an overlay or label volume beside `volume`. A grid without orientation gets the one
/// that was given for the volume. A grid without spacing gets the given one if it has the size of
/// the volume.
Geometry grid_beside(const Geometry& grid, const LoadedVolume& volume);

/// As load(), with the grid_beside() `volume`.
LoadedVolume load_beside(const Source& source, const LoadedVolume& volume,
                         const io::Progress& progress = {});
/// Labels of layers on their grid_beside() `volume`. If they have it already, this is the same
/// pointer. Null stays null.
std::shared_ptr<const Field> labels_beside(const std::shared_ptr<const Field>& labels,
                                           const LoadedVolume& volume);

/// A warning if only one of two files gives an orientation, or only one a spacing. Otherwise empty.
/// `name` and `grid` are those of the overlay or label volume.
std::string warning_beside(const std::string& name, const Geometry& grid,
                           const LoadedVolume& volume);

}  // namespace palpate::run
