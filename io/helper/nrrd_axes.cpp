// The axes of a NRRD header, and the place of its grid: sizes, kinds, spacings, centerings,
// units, the space. If the format leaves a choice, ITK's is taken (docs/io.md).
#include "io/helper/nrrd_axes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <sstream>

namespace palpate::io {
namespace {

constexpr std::size_t most_space_dimensions = 8;  // NRRD_SPACE_DIM_MAX of teem

/// A vector of a space: its part among places [mm], and what is beyond (time, in the header's
/// unit).
struct SpaceVector {
    Vec3 place = Vec3::Zero();
    std::vector<double> beyond;

    double length_beyond() const {
        return std::sqrt(std::inner_product(beyond.begin(), beyond.end(), beyond.begin(), 0.0));
    }
};

/// Fields that have one entry for each axis; an entry that is missing or left open is nothing.
struct Axis {
    std::int64_t size = 1;
    std::string kind = "???";
    std::optional<double> spacing, minimum, maximum;
    std::string center = "???";  ///< "node": minimum and maximum are samples, not ends of cells
    std::optional<SpaceVector> direction;
    std::string unit;

    double cells() const { return static_cast<double>(center == "node" ? size - 1 : size); }

    /// False for an axis of values (colours, vectors, lists), not of places or times.
    bool is_domain() const {
        return kind == "domain" || kind == "space" || kind == "time" || kind == "???" ||
               kind == "none";
    }
};

void check_count(std::size_t count, std::size_t axes, const std::string& field) {
    if (count == axes) return;
    throw Failure("its header field '" + field + "' has " + std::to_string(count) +
                  " entries for " + std::to_string(axes) + " axes; correct the header");
}

std::vector<std::string> words_of(const HeaderFields& fields, const std::string& field,
                                  std::size_t axes) {
    std::vector<std::string> words;
    std::istringstream text(lower(fields.value(field)));
    for (std::string word; text >> word;) {
        std::erase(word, '"');  // as units have them
        words.push_back(word);
    }
    if (fields.has(field)) check_count(words.size(), axes, field);
    words.resize(axes, "???");
    return words;
}

std::vector<std::optional<double>> numbers_of(const HeaderFields& fields, const std::string& field,
                                              std::size_t axes) {
    const auto numbers = numbers_in(fields.value(field), field);
    if (fields.has(field)) check_count(numbers.size(), axes, field);
    std::vector<std::optional<double>> found(axes);
    for (std::size_t a = 0; a < numbers.size(); ++a) {
        if (!std::isnan(numbers[a])) found[a] = numbers[a];
    }
    return found;
}

/// Units, each in "..." or, as some programs write them, without; none, or one for each axis.
std::vector<std::string> units_of(const HeaderFields& fields, const std::string& field,
                                  std::size_t axes) {
    const std::string text = fields.value(field);
    std::vector<std::string> units;
    if (text.find('"') == std::string::npos) {
        std::istringstream words(text);
        for (std::string word; words >> word;) units.push_back(word);
    }
    for (std::size_t at = 0; (at = text.find('"', at)) != std::string::npos;) {
        const auto close = text.find('"', at + 1);
        if (close == std::string::npos) break;
        units.push_back(trimmed(text.substr(at + 1, close - at - 1)));
        at = close + 1;
    }
    if (!text.empty()) check_count(units.size(), axes, field);
    std::replace(units.begin(), units.end(), std::string("???"), std::string());
    return units;
}

/// The space that directions and origin are given in.
struct Space {
    std::size_t dimension = 0;   ///< 0: the header gives none
    Vec3 to_lps = Vec3::Ones();  ///< factors to left, posterior, superior [mm]
    bool is_body = false;        ///< its axes are the patient's
    std::string time_unit = {};  ///< of the fourth dimension
};

/// Teem reads the names with hyphens, with blanks or with neither between their words.
std::string space_name(const HeaderFields& fields) {
    std::string name = lower(fields.value("space"));
    std::erase_if(name, [](char c) { return c == '-' || c == ' '; });
    return name;
}

Space named_space(const HeaderFields& fields) {
    static const std::map<std::string, Space> spaces = {
        {"rightanteriorsuperior", {3, {-1, -1, 1}, true}},
        {"ras", {3, {-1, -1, 1}, true}},
        {"leftanteriorsuperior", {3, {1, -1, 1}, true}},
        {"las", {3, {1, -1, 1}, true}},
        {"leftposteriorsuperior", {3, {1, 1, 1}, true}},
        {"lps", {3, {1, 1, 1}, true}},
        {"rightanteriorsuperiortime", {4, {-1, -1, 1}, true}},
        {"rast", {4, {-1, -1, 1}, true}},
        {"leftanteriorsuperiortime", {4, {1, -1, 1}, true}},
        {"last", {4, {1, -1, 1}, true}},
        {"leftposteriorsuperiortime", {4, {1, 1, 1}, true}},
        {"lpst", {4, {1, 1, 1}, true}},
        {"scannerxyz", {3, {1, 1, 1}}},
        {"scannerxyztime", {4, {1, 1, 1}}},
        {"3drighthanded", {3, {1, 1, 1}}},
        {"3dlefthanded", {3, {1, 1, 1}}},
        {"3drighthandedtime", {4, {1, 1, 1}}},
        {"3dlefthandedtime", {4, {1, 1, 1}}}};
    if (fields.has("space")) {
        const auto found = spaces.find(space_name(fields));
        if (found != spaces.end()) return found->second;
        throw Failure("its header field 'space' is '" + fields.value("space") +
                      "', which is not known; correct the header");
    }
    Space space;
    if (fields.has("space directions") && !fields.has("space dimension")) {
        throw Failure(
            "its header has space directions, but no space that they are in; add 'space: "
            "left-posterior-superior' if they are the patient's, or 'space dimension: 3'");
    }
    if (fields.has("space dimension")) {
        space.dimension = static_cast<std::size_t>(
            whole_number_in(fields.value("space dimension"), "space dimension", 1));
        if (space.dimension > most_space_dimensions) {
            throw Failure("its header field 'space dimension' is beyond 8; correct the header");
        }
    }
    return space;
}

/// The named space, in mm. Notes what it does not say of the patient, and units.
Space space_of(const HeaderFields& fields, std::vector<std::string>& notes) {
    Space space = named_space(fields);
    const std::string name = lower(fields.value("space"));
    // Right-handed axes say no more than that the sides are not known (Geometry::oriented).
    if (!name.empty() && !space.is_body && !space_name(fields).starts_with("3drighthanded")) {
        notes.push_back("its space is '" + name +
                        "', which is not the patient's: its axes were taken as those of LPS");
    }
    if (space.dimension == 0) {
        for (const std::string field : {"space units", "space origin"}) {
            if (fields.value(field).empty()) continue;
            notes.push_back("its header has a field '" + field + "' but no space: it was ignored");
        }
        return space;
    }
    const auto units = units_of(fields, "space units", space.dimension);
    for (std::size_t i = 0; i < std::min<std::size_t>(3, units.size()); ++i) {
        space.to_lps[static_cast<Eigen::Index>(i)] *= length_unit(units[i], notes);
    }
    if (units.size() > 3) space.time_unit = lower(units[3]);
    return space;
}

/// "(1,0,0)" at `at` and behind it: the numbers in the next brackets.
std::vector<double> next_vector(const std::string& text, std::size_t& at,
                                const std::string& field) {
    const auto close = text.find(')', at);
    if (text[at] != '(' || close == std::string::npos) {
        throw Failure("its header field '" + field + "' is damaged; correct the header");
    }
    std::string inside = text.substr(at + 1, close - at - 1);
    std::replace(inside.begin(), inside.end(), ',', ' ');
    at = close + 1;
    return numbers_in(inside, field);
}

SpaceVector vector_in(const std::vector<double>& numbers, const Space& space,
                      const std::string& field) {
    if (numbers.size() != space.dimension) {
        throw Failure("its header field '" + field +
                      "' and its space do not agree; correct the "
                      "header");
    }
    SpaceVector v;
    const std::size_t places = std::min<std::size_t>(3, numbers.size());
    for (std::size_t i = 0; i < places; ++i) v.place[static_cast<Eigen::Index>(i)] = numbers[i];
    v.place = v.place.cwiseProduct(space.to_lps);
    v.beyond.assign(numbers.begin() + static_cast<std::ptrdiff_t>(places), numbers.end());
    return v;
}

void read_directions(const HeaderFields& fields, const Space& space, std::vector<Axis>& axes) {
    const std::string field = "space directions", text = fields.value(field);
    std::size_t at = 0, count = 0;
    while ((at = text.find_first_not_of(" \t", at)) != std::string::npos) {
        Axis ignored;
        Axis& axis = count < axes.size() ? axes[count] : ignored;
        ++count;
        if (text.compare(at, 4, "none") == 0) {
            at += 4;
            continue;
        }
        const std::vector<double> numbers = next_vector(text, at, field);
        if (std::ranges::all_of(numbers, [](double n) { return std::isnan(n); })) continue;  // none
        axis.direction = vector_in(numbers, space, field);
        check_spacing(std::hypot(axis.direction->place.norm(), axis.direction->length_beyond()),
                      "header field '" + field + "'");
    }
    if (fields.has(field)) check_count(count, axes.size(), field);
}

std::vector<Axis> axes_of(const HeaderFields& fields, const std::vector<std::int64_t>& sizes,
                          const Space& space) {
    std::vector<Axis> axes(sizes.size());
    const auto kinds = words_of(fields, "kinds", sizes.size());
    const auto centers = words_of(fields, "centerings", sizes.size());
    const auto spacings = numbers_of(fields, "spacings", sizes.size());
    const auto minima = numbers_of(fields, "axis mins", sizes.size());
    const auto maxima = numbers_of(fields, "axis maxs", sizes.size());
    const auto units = units_of(fields, "units", sizes.size());
    for (std::size_t a = 0; a < axes.size(); ++a) {
        axes[a] = {sizes[a],  kinds[a],   spacings[a],  minima[a],
                   maxima[a], centers[a], std::nullopt, a < units.size() ? units[a] : ""};
    }
    read_directions(fields, space, axes);
    return axes;
}

/// Finds the axis that counts volumes, if there is one, and returns the axes of space.
std::vector<Axis> spatial_axes(const std::vector<Axis>& axes, VolumeHeader& header) {
    std::vector<Axis> spatial;
    std::int64_t before = 1;
    for (std::size_t a = 0; a < axes.size(); ++a) {
        const Axis& axis = axes[a];
        if (axis.is_domain()) {
            if (axis.kind == "time" && a + 1 != axes.size()) {
                throw Failure(
                    "its time axis is not the last one; put it last (unu permute) or mark it as a "
                    "list");
            }
            spatial.push_back(axis);
        } else if (axis.size > 1) {
            if (axis.kind != "list" || axes.size() < 4) {
                throw Failure("it has " + std::to_string(axis.size) +
                              " values a sample (colours or vectors); give a volume with one");
            }
            if (header.steps > 1) {
                throw Failure("it has two axes of lists; save one volume of it");
            }
            header.steps = axis.size;
            header.together = before;
            header.times = frame_times(axis.spacing.value_or(0), axis.minimum.value_or(0),
                                       lower(axis.unit), header.notes);
        }
        before *= axis.size;
    }
    return spatial;
}

/// How many axes lie in space: up to three, without a time axis behind them.
std::size_t places_among(const std::vector<Axis>& spatial) {
    const Axis& last = spatial.back();
    const bool is_time =
        last.kind == "time" && (!last.direction || last.direction->place.isZero(0));
    return std::min<std::size_t>(3, spatial.size() - (is_time && spatial.size() > 1 ? 1 : 0));
}

/// A space has at least as many dimensions as there are axes (a slice lies in space), or lacks
/// time.
void check_dimensions(const Space& space, const std::vector<Axis>& spatial) {
    if (spatial.empty()) throw Failure("it has no axis of space; give a volume");
    const std::size_t places = places_among(spatial);
    const bool timeless =
        space.dimension >= places && spatial.size() == places + 1 && !spatial.back().direction;
    if (space.dimension != 0 && space.dimension < spatial.size() && !timeless) {
        throw Failure("its header gives a space of " + std::to_string(space.dimension) +
                      " dimensions for " + std::to_string(spatial.size()) +
                      " axes; correct the header");
    }
    for (std::size_t a = 0; a < spatial.size(); ++a) {
        const auto& direction = spatial[a].direction;
        const bool is_place = a < places;
        if (!direction || (is_place ? direction->length_beyond() : direction->place.norm()) == 0) {
            continue;
        }
        throw Failure(
            "its header field 'space directions' leads an axis through places and times at once, "
            "or has a time before the last axis; save one volume of it");
    }
}

/// Axes beyond the third count volumes, and so does a time axis behind fewer ones.
void take_steps(const Space& space, const SpaceVector& origin, std::vector<Axis>& spatial,
                VolumeHeader& header) {
    const std::size_t places = places_among(spatial);
    if (spatial.size() == places) {
        if (header.steps == 1) header.together = static_cast<std::int64_t>(header.samples());
        return;
    }
    if (header.steps > 1) {
        throw Failure("it has more than 4 axes (" + text_of(header.sizes) +
                      "); save one volume of it");
    }
    for (std::size_t a = places; a < spatial.size(); ++a) header.steps *= spatial[a].size;
    header.together = static_cast<std::int64_t>(header.samples()) / header.steps;
    if (spatial.size() == places + 1) {
        const Axis& time = spatial[places];
        const bool in_space = time.direction && !origin.beyond.empty();
        header.times =
            frame_times(in_space ? time.direction->beyond[0] : time.spacing.value_or(0),
                        in_space ? origin.beyond[0] : time.minimum.value_or(0),
                        time.unit.empty() ? space.time_unit : lower(time.unit), header.notes);
    }
    spatial.resize(places);
}

/// Completes what spacing, minimum and maximum of an axis say of each other, in mm.
void complete(Axis& axis, std::vector<std::string>& notes) {
    if (!axis.spacing && !axis.minimum && !axis.maximum) return;
    const double unit = length_unit(axis.unit, notes);
    for (auto* length : {&axis.spacing, &axis.minimum, &axis.maximum}) {
        if (*length) **length *= unit;
    }
    const double cells = axis.cells();
    if (axis.minimum && axis.maximum && cells > 0) {
        const double between = (*axis.maximum - *axis.minimum) / cells;
        if (!axis.spacing) {
            check_spacing(between, "header fields 'axis mins' and 'axis maxs'");
            axis.spacing = between;
        } else if (!(std::abs(between - *axis.spacing) <= 0.01 * *axis.spacing)) {
            add_note(notes,
                     "its header's spacings do not fit its axis mins and maxs: the spacings "
                     "were taken");
        }
    }
    if (!axis.minimum && axis.maximum) {
        axis.minimum = *axis.maximum - cells * axis.spacing.value_or(1);
    }
    if (axis.minimum && axis.center != "node" && axis.center != "cell") {
        add_note(notes,
                 "its header does not say whether axis mins are places of samples "
                 "(centerings: node) or ends of cells: ends of cells were taken");
    }
}

/// The place of the first sample on an axis outside of any space.
double first_of(const Axis& axis) {
    if (!axis.minimum) return 0;
    return *axis.minimum + (axis.center == "node" ? 0 : axis.spacing.value_or(1) / 2);
}

/// Axes without a direction, in a space where others have one, are at right angles to those.
void complete_directions(const std::vector<Axis>& spatial, Mat3& direction) {
    std::vector<Eigen::Index> known, open;
    for (std::size_t a = 0; a < 3; ++a) {
        const bool told = a < spatial.size() && spatial[a].direction;
        (told ? known : open).push_back(static_cast<Eigen::Index>(a));
    }
    if (known.empty() || open.empty()) return;
    if (open.size() == 2) {
        direction.col(open[0]) = direction.col(known[0]).unitOrthogonal();
        known.push_back(open[0]);
        open.erase(open.begin());
    }
    // Right-handed: the axes follow each other in a circle.
    const Eigen::Index last = open[0];
    direction.col(last) =
        direction.col((last + 1) % 3).cross(direction.col((last + 2) % 3)).normalized();
}

/// Place of the first sample. 0 if the header does not give it.
SpaceVector origin_of(const HeaderFields& fields, const Space& space) {
    const std::string field = "space origin";
    SpaceVector none;
    none.beyond.resize(space.dimension > 3 ? space.dimension - 3 : 0, 0.0);
    if (space.dimension == 0 || !fields.has(field)) return none;
    std::size_t at = 0;
    return vector_in(next_vector(fields.value(field), at, field), space, field);
}

Geometry geometry_of(const Space& space, const SpaceVector& origin, std::vector<Axis>& spatial,
                     std::vector<std::string>& notes) {
    Geometry g;
    g.size = Index3::Ones();
    for (std::size_t a = 0; a < spatial.size(); ++a) {
        Axis& axis = spatial[a];
        const auto i = static_cast<Eigen::Index>(a);
        g.size[i] = static_cast<int>(axis.size);
        if (axis.spacing && space.dimension > 0) {
            throw Failure(axis.direction ? "its header gives both a spacing and a direction for an "
                                           "axis; correct the header"
                                         : "its header gives spacings in a space; write them as "
                                           "space directions, or leave the space out");
        }
        if (space.dimension == 0) {
            complete(axis, notes);
            if (axis.spacing) check_spacing(*axis.spacing, "header field 'spacings'");
            g.spacing[i] = axis.spacing.value_or(1);
            g.origin[i] = first_of(axis);
        } else if (!axis.unit.empty() && lower(axis.unit) != "mm") {
            add_note(notes, "its header has a space: the units of its axes were ignored");
        }
        if (axis.direction) {
            g.spacing[i] = axis.direction->place.norm();
            g.direction.col(i) = axis.direction->place / g.spacing[i];
        }
        if (!axis.spacing && !axis.direction) {
            add_note(notes, "its header gives no spacing: 1 mm was taken");
            g.measured = false;
        }
    }
    const bool directed = std::ranges::any_of(spatial, [](const Axis& a) { return !!a.direction; });
    g.oriented = space.is_body && directed;
    complete_directions(spatial, g.direction);
    if (std::isnan(origin.place[0])) {
        add_note(notes, "its header leaves the space origin open: 0 was taken");
    } else if (space.dimension > 0) {
        g.origin = origin.place;
    }
    return g;
}

}  // namespace

void take_axes(const HeaderFields& fields, VolumeHeader& header) {
    const Space space = space_of(fields, header.notes);
    std::vector<Axis> spatial = spatial_axes(axes_of(fields, header.sizes, space), header);
    check_dimensions(space, spatial);
    const SpaceVector origin = origin_of(fields, space);
    take_steps(space, origin, spatial, header);
    header.geometry = geometry_of(space, origin, spatial, header.notes);
}

}  // namespace palpate::io
