// Places volumes beside others.
#include "palpate/run/beside.hpp"

#include <utility>
#include <variant>

namespace palpate::run {
namespace {

/// Of a store, the finest one.
const Geometry& whole_grid(const LoadedVolume& loaded) {
    return loaded.streamed ? loaded.streamed->store->info().levels[0].geometry
                           : loaded.volume.geometry();
}

bool is_same(const Geometry& a, const Geometry& b) {
    return a == b && a.oriented == b.oriented && a.measured == b.measured;
}

/// The same samples.
Volume on_grid(const Volume& volume, const Geometry& grid) {
    const auto whole = std::make_shared<const Volume>(volume);
    return {grid, volume.type(), std::shared_ptr<const void>(whole, whole->data()), volume.bytes()};
}

}  // namespace

io::GivenGrid given_grid(const Source& source) {
    if (const auto* store = std::get_if<StoreSource>(&source.from)) {
        return {store->options.spacing, store->options.orientation};
    }
    const auto* file = std::get_if<FileSource>(&source.from);
    return file ? io::GivenGrid{file->spacing, file->orientation} : io::GivenGrid{};
}

Geometry grid_beside(const Geometry& grid, const LoadedVolume& volume) {
    io::GivenGrid given = given_grid(volume.source);
    if (grid.oriented) given.orientation.clear();
    if (grid.measured || grid.size != whole_grid(volume).size) given.spacing.reset();
    Geometry placed = grid;
    io::put_in(given, placed);
    return placed;
}

LoadedVolume load_beside(const Source& source, const LoadedVolume& volume,
                         const io::Progress& progress) {
    LoadedVolume loaded = load(source, progress);
    const Geometry& own = loaded.volume.geometry();
    const Geometry placed = grid_beside(own, volume);
    if (!is_same(placed, own)) loaded.volume = on_grid(loaded.volume, placed);
    return loaded;
}

std::shared_ptr<const Field> labels_beside(const std::shared_ptr<const Field>& labels,
                                           const LoadedVolume& volume) {
    if (!labels) return labels;
    const Geometry placed = grid_beside(labels->geometry(), volume);
    if (is_same(placed, labels->geometry())) return labels;
    return std::make_shared<const Field>(on_grid(labels->volume(), placed), labels->solid(),
                                         labels->background());
}

std::string warning_beside(const std::string& name, const Geometry& grid,
                           const LoadedVolume& volume) {
    if (std::holds_alternative<SyntheticSource>(volume.source.from)) return {};
    const Geometry& its = whole_grid(volume);
    if (grid.oriented != its.oriented) {
        const std::string& without = grid.oriented ? volume.name : name;
        const std::string& with = grid.oriented ? name : volume.name;
        return without + " does not give its orientation, and " + with +
               " does: left and right of one of them may be mirrored (palpate convert " + without +
               " OUT --orientation RAS writes it with one)";
    }
    if (grid.measured == its.measured) return {};
    const std::string& without = grid.measured ? volume.name : name;
    return without + " does not give its spacing, and " + (grid.measured ? name : volume.name) +
           " does: they may differ in size (palpate convert " + without +
           " OUT --spacing X,Y,Z writes it with one)";
}

}  // namespace palpate::run
