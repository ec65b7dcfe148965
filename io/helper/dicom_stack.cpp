// Arranges DICOM slices in a regular grid. See the header and docs/io.md.
#include "io/helper/dicom_stack.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "io/helper/dicom_moments.hpp"
#include "io/helper/dicom_series.hpp"
#include "io/helper/dicom_stations.hpp"
#include "io/helper/numbered_names.hpp"

namespace palpate::io {
namespace {

constexpr double even_part = 0.02;    // of the spacing
constexpr double missing_part = 0.1;  // the same, of slices beside missing ones

SliceGroups groups_of(const DicomSeries& series, const Vec3& normal) {
    std::vector<PlacedSlice> placed;
    for (std::size_t i = 0; i < series.slices.size(); ++i) {
        placed.push_back({i, normal.dot(*series.slices[i].position), i});
    }
    std::stable_sort(placed.begin(), placed.end(),
                     [](const auto& a, const auto& b) { return a.along < b.along; });
    SliceGroups groups;
    for (const PlacedSlice& p : placed) {
        if (groups.empty() || p.along - groups.back().front().along > same_place_mm(series)) {
            groups.emplace_back();
        }
        groups.back().push_back(p);
    }
    return groups;
}

/// Slices at one place of a grid are moments only if they cover each other.
void check_covering(const DicomSeries& series, const SliceGroups& groups) {
    for (const auto& group : groups) {
        const DicomSlice& first = series.slices[group.front().slice];
        if (!first.is_placed()) return;
        for (const PlacedSlice& p : group) {
            const DicomSlice& other = series.slices[p.slice];
            if (place_in_plane(other, first).cwiseAbs().maxCoeff() <= same_place_pixels) continue;
            throw Failure("some of its slices lie side by side in one plane (" +
                          text_of((*other.position - *first.position).norm()) +
                          " mm apart): they are of several volumes; export each of these as a "
                          "series of its own");
        }
    }
}

void choose_time_step(const DicomSeries& series, SliceGroups groups, const Request& request,
                      Stack& stack) {
    check_covering(series, groups);
    const std::size_t steps = groups.front().size();
    for (const auto& group : groups) {
        if (group.size() == steps) continue;
        throw Failure("some of its slices lie at the same place (" + std::to_string(group.size()) +
                      " here, " + std::to_string(steps) +
                      " there): the series is incomplete or mixed; export it again");
    }
    sort_by_moment(series, groups, stack.notes);
    const int step = checked_time_step(request, static_cast<std::int64_t>(steps));
    stack.time_steps = static_cast<int>(steps);
    // Positions of the same place may differ by rounding from time to time: the first ones count.
    for (const auto& group : groups) {
        stack.slices.push_back(group[static_cast<std::size_t>(step)]);
        stack.slices.back().along = group.front().along;
        stack.slices.back().at = group.front().slice;
    }
    stack.seconds = series.slices[stack.slices.front().slice].seconds;
}

/// The distance between the grid's slices, and whether every slice lies on one of them.
struct Steps {
    double spacing = 1;
    std::size_t count = 1;
    double tolerance = 0;    ///< [mm] a slice this near to a grid slice is taken as it is
    bool are_empty = false;  ///< the slices that are missing
};

/// [mm] The greatest distance of a slice from its place in a grid of `steps` from the first to the
/// last one. `places` says which step each slice is at.
double distance_from_grid(const Stack& stack, const std::vector<double>& places) {
    const double spacing = stack.slices.back().along / places.back();
    double greatest = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
        greatest = std::max(greatest, std::abs(stack.slices[i].along - places[i] * spacing));
    }
    return greatest;
}

/// `one`: of the slices.
Steps steps_of(Stack& stack, const DicomSlice& one) {
    std::vector<double> gaps;
    for (std::size_t i = 1; i < stack.slices.size(); ++i) {
        gaps.push_back(stack.slices[i].along - stack.slices[i - 1].along);
    }
    std::vector<double> sorted = gaps;
    std::sort(sorted.begin(), sorted.end());
    // Segmentations leave out the slices that have nothing of a segment.
    const bool are_empty = one.values.modality == "SEG";
    const double between = std::abs(one.between);
    const bool is_told = between > 0 && between < 1.1 * sorted.front();
    const double usual = !are_empty ? sorted[(sorted.size() - 1) / 2]  // fewer slices lost
                         : is_told  ? between
                                    : sorted.front();
    const double total = stack.slices.back().along;
    const double rounding = std::min(0.01, 0.1 * usual);  // [mm] in the files' decimals
    const double tolerance = std::max(rounding, even_part * usual);
    const double mean = total / static_cast<double>(gaps.size());
    // Gaps that differ by little may still add up: it is the places that have to be even.
    std::vector<double> even, places = {0};
    for (std::size_t i = 0; i < stack.slices.size(); ++i) even.push_back(static_cast<double>(i));
    if (distance_from_grid(stack, even) <= tolerance &&
        (!are_empty || std::abs(mean - usual) <= tolerance)) {
        return {mean, gaps.size() + 1, 0.5 * usual};
    }
    for (const double gap : gaps) {
        places.push_back(places.back() + std::max(1.0, std::round(gap / usual)));
    }
    const bool multiples =
        places != even && distance_from_grid(stack, places) <= missing_part * usual;
    const double steps = multiples ? places.back() : std::max(1.0, std::round(total / usual));
    const double most = multiples && are_empty ? 1 << 16 : 4.0 * std::ssize(stack.slices);
    if (steps > most) {
        throw Failure("its " + std::to_string(stack.slices.size()) + " slices are spread over " +
                      text_of(total) + " mm, in distances of " + text_of(sorted.front()) + " to " +
                      text_of(sorted.back()) +
                      " mm, which is no stack: most slices are missing, or several "
                      "acquisitions are mixed; give one complete series");
    }
    const auto count = static_cast<std::size_t>(steps) + 1;
    const double spacing = total / steps;
    if (multiples) {
        stack.notes.push_back(
            std::to_string(count - stack.slices.size()) + " of " + std::to_string(count) +
            (are_empty ? " slices are not in the segmentation: they are empty (0)"
                       : " slices are missing: filled by interpolation between their "
                         "neighbours, do not trust the surface there"));
        return {spacing, count, 0.2 * spacing, are_empty};
    }
    stack.notes.push_back("its slices are not evenly spaced (" + text_of(sorted.front()) + " to " +
                          text_of(sorted.back()) + " mm): interpolated every " + text_of(spacing) +
                          " mm");
    return {spacing, count, even_part * spacing};
}

void fill_grid(const Steps& steps, Stack& stack) {
    std::size_t below = 0;
    for (std::size_t k = 0; k < steps.count; ++k) {
        const double at = static_cast<double>(k) * steps.spacing;
        while (below + 1 < stack.slices.size() && stack.slices[below + 1].along <= at) ++below;
        const std::size_t above = std::min(below + 1, stack.slices.size() - 1);
        const double before = at - stack.slices[below].along;
        const double after = stack.slices[above].along - at;
        GridSlice slice{below, above};
        if (after < before && std::abs(after) <= steps.tolerance) {
            slice = {above, above};
        } else if (std::abs(before) > steps.tolerance && above != below) {
            slice.weight = before / (before + after);
            slice.is_empty = steps.are_empty;
        }
        stack.grid.push_back(slice);
    }
}

/// Whether the shift of the slices grows evenly along the normal, as that of a tilted gantry.
bool is_tilt(const std::vector<PlacedSlice>& slices) {
    constexpr double most = 0.25;  // [pixels]
    const PlacedSlice& last = slices.back();
    return std::ranges::all_of(slices, [&](const PlacedSlice& p) {
        const double part = last.along > 0 ? p.along / last.along : 0;
        return std::abs(p.u - part * last.u) <= most && std::abs(p.v - part * last.v) <= most;
    });
}

void note_shear(const Vec3& pixel, Stack& stack) {
    const auto shift = [&](const PlacedSlice& p) {
        return std::hypot(p.u * pixel[0], p.v * pixel[1]);
    };
    if (is_tilt(stack.slices)) {
        const double angle = std::atan2(shift(stack.slices.back()), stack.slices.back().along);
        stack.notes.push_back("its slices are shifted against each other (gantry tilt of " +
                              text_of(std::round(angle * 1800 / 3.14159265358979) / 10) +
                              " degrees): straightened by interpolation within the slices");
        return;
    }
    double most = 0;
    for (const PlacedSlice& p : stack.slices) most = std::max(most, shift(p));
    stack.notes.push_back("its slices are shifted against each other by up to " +
                          text_of(std::round(most * 1000) / 1000) +
                          " mm, which is no gantry tilt: put in their places by interpolation "
                          "within the slices; the series may be mixed of several");
}

void find_shear(const DicomSeries& series, const Vec3& row, const Vec3& column, Stack& stack) {
    const DicomSlice& first = series.slices[stack.slices.front().at];
    double last_u = 0, last_v = 0, worst = 0;
    for (PlacedSlice& p : stack.slices) {
        const Vec3 d = *series.slices[p.at].position - *first.position;
        p.u = row.dot(d) / (*first.pixel)[0];
        p.v = column.dot(d) / (*first.pixel)[1];
        stack.first_u = std::min(stack.first_u, p.u);
        stack.first_v = std::min(stack.first_v, p.v);
        last_u = std::max(last_u, p.u);
        last_v = std::max(last_v, p.v);
        worst = std::max({worst, std::abs(p.u), std::abs(p.v)});
    }
    if (worst <= same_place_pixels) {
        stack.first_u = stack.first_v = 0;
        return;
    }
    stack.sheared = true;
    note_shear(*first.pixel, stack);
    const auto more = [](double low, double high) {
        return static_cast<int>(std::ceil(high - low - 1e-6));
    };
    const int wide = more(stack.first_u, last_u), high = more(stack.first_v, last_v);
    if (wide > 2 * first.columns || high > 2 * first.rows) {
        throw Failure("its slices are shifted by more than their own size; give another series");
    }
    stack.geometry.size[0] += wide;
    stack.geometry.size[1] += high;
}

void set_single_spacing(const DicomSlice& slice, Stack& stack) {
    stack.geometry.spacing[2] = slice.thickness > 0 ? slice.thickness : 1;
    if (!(slice.thickness > 0)) {
        stack.notes.emplace_back("it gives no distance between slices: 1 mm was taken");
        stack.geometry.measured = false;
    }
}

/// Columns of the row, the column and the normal.
Mat3 plane_axes(const DicomSlice& one) {
    const Vec3 row = one.row->normalized();
    const Vec3 column = (*one.column - row * row.dot(*one.column)).normalized();
    if (!(std::abs(row.dot(one.column->normalized())) < 1e-3)) {
        throw Failure("its row and column directions are not at right angles; export it again");
    }
    Mat3 axes;
    axes << row, column, row.cross(column);
    return axes;
}

/// [mm] along the normal of slices whose place or orientation is missing.
struct Locations {
    const char* source = nullptr;
    std::vector<double> along;  ///< empty if there are none
    bool is_sided = true;
    bool may_repeat = false;  ///< slices at one place are moments
};

/// Their positions along the line on which these lie, or else their SliceLocation, whose sign the
/// standard leaves open.
Locations locations_of(const std::vector<DicomSlice>& slices) {
    Locations found;
    Vec3 line = Vec3::Zero();
    for (const DicomSlice& s : slices) {
        if (!s.position || !slices.front().position) continue;
        const Vec3 way = *s.position - *slices.front().position;
        if (way.norm() > line.norm()) line = way;
    }
    const auto has_position = [](const DicomSlice& s) { return s.position.has_value(); };
    if (std::ranges::all_of(slices, has_position) && line.norm() > 0) {
        int longest = 0;
        line.cwiseAbs().maxCoeff(&longest);
        if (line[longest] < 0) line = -line;
        found.source = "positions' distances";
        for (const DicomSlice& s : slices) {
            found.along.push_back(line.stableNormalized().dot(*s.position));
        }
    } else if (std::ranges::all_of(slices, [](const auto& s) { return s.location.has_value(); })) {
        found.source = slices.front().location_source;
        found.is_sided = false;
        found.may_repeat = slices.front().frames > 1;
        for (const DicomSlice& s : slices) found.along.push_back(*s.location);
    }
    return found;
}

/// Whether nothing but their numbers tells slices of one file each apart, so that they are a stack
/// whose positions are wrong, and no moments.
bool are_only_numbered(const DicomSeries& series) {
    const DicomSlice& first = series.slices.front();
    const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
    return std::ranges::all_of(series.slices, [&](const DicomSlice& s) {
        return s.frames == 1 &&
               std::equal(s.keys.begin(), s.keys.begin() + frame_number, first.keys.begin(), same);
    });
}

/// Places slices that lack a position or an orientation, or all have the same position, if each has
/// a place of its own.
void place_by_location(DicomSeries& series, std::vector<std::string>& notes) {
    const bool placed = std::ranges::all_of(series.slices, [&](const DicomSlice& s) {
        return s.is_placed() && series.slices.front().is_placed();
    });
    if (placed && std::ranges::any_of(series.slices, [&](const DicomSlice& s) {
            return *s.position != *series.slices.front().position;
        })) {
        return;
    }
    const Locations locations = locations_of(series.slices);
    std::vector<double> sorted = locations.along;
    std::ranges::sort(sorted);
    const double least = same_place_mm(series);
    const auto is_near = [&](double a, double b) { return b - a <= least; };
    const bool is_place = !sorted.empty() && !is_near(sorted.front(), sorted.back());
    const bool repeats = std::ranges::adjacent_find(sorted, is_near) != sorted.end();
    if (!is_place || (repeats && !locations.may_repeat)) {
        if (!placed || !are_only_numbered(series)) return;
        for (DicomSlice& s : series.slices) s.position.reset();
        return;
    }
    for (std::size_t i = 0; i < sorted.size(); ++i) {
        DicomSlice& s = series.slices[i];
        if (!s.row || !s.column) {
            s.row = Vec3::UnitX();
            s.column = Vec3::UnitY();
        }
        const Vec3 normal = s.row->cross(*s.column);
        const Vec3 in_plane =
            placed ? Vec3(*s.position - normal * normal.dot(*s.position)) : Vec3(0, 0, 0);
        s.position = in_plane + normal * locations.along[i];
        s.is_sided = locations.is_sided;
    }
    notes.emplace_back(std::string(placed ? "its slices all have one position"
                                          : "its slices lack a position or an orientation") +
                       ": they were placed by their " + locations.source + ", along their normal");
}

/// Slices without a place, among others that have different ones, cannot be put anywhere.
void check_all_placed(const DicomSeries& series) {
    const auto first = std::ranges::find_if_not(series.slices, &DicomSlice::is_placed);
    const auto placed = std::ranges::find_if(series.slices, &DicomSlice::is_placed);
    const auto is_elsewhere = [&](const DicomSlice& s) {
        return s.is_placed() && *s.position != *placed->position;
    };
    if (first == series.slices.end() || std::ranges::none_of(series.slices, is_elsewhere)) return;
    throw Failure("some of its slices have no place, the first in " + quoted(first->file) +
                  (first->frames > 1 ? " (frame " + std::to_string(first->frame + 1) + ")" : "") +
                  ", and others do; correct it, or take that slice away");
}

/// By the names of their files, if their own numbers do not count them. Throws Failure.
void number_by_names(DicomSeries& series, std::vector<std::string>& notes) {
    std::vector<std::filesystem::path> files;
    std::set<int> numbers;
    for (const DicomSlice& s : series.slices) {
        if (s.frames > 1 || s.is_moment) return;
        files.push_back(s.file);
        numbers.insert(s.instance);
    }
    if (numbers.size() == files.size()) return;
    const std::string what = "its slices say neither where they lie nor in which order ";
    std::vector<std::vector<std::filesystem::path>> times;
    try {
        times = numbered_slices(files).times;
    } catch (const Failure&) {
        times.clear();
    }
    const bool have_numbers = std::ranges::all_of(files, [](const auto& file) {
        return file.filename().string().find_first_of("0123456789") != std::string::npos;
    });
    if (!have_numbers) times.clear();
    if (times.size() != 1 || times[0].size() != files.size()) {
        throw Failure(what + "(" + std::to_string(numbers.size()) + " of " +
                      std::to_string(files.size()) +
                      " InstanceNumbers differ, and the names of the files do not count them); "
                      "correct it, or export it again");
    }
    for (DicomSlice& s : series.slices) {
        s.instance = static_cast<int>(std::ranges::find(times[0], s.file) - times[0].begin());
    }
    notes.push_back(what + "(InstanceNumber): the numbers in the names of their files were taken");
}

/// Slices without position or orientation, stacked in the order of their numbers, or moments of
/// one. Frames of one file with the same number are moments, too.
void pile_up(const DicomSeries& series, const Request& request, Stack& stack) {
    const bool is_moment = series.slices.front().is_moment;
    std::vector<PlacedSlice> slices;
    for (std::size_t i = 0; i < series.slices.size(); ++i) slices.push_back({i, 0, i});
    const auto number = [&](const PlacedSlice& p) {
        const DicomSlice& s = series.slices[p.slice];
        return std::tuple(s.instance, s.frames > 1 ? s.file : std::filesystem::path(), s.order);
    };
    std::ranges::stable_sort(slices, {}, number);
    SliceGroups groups;
    for (const PlacedSlice& p : slices) {
        const bool is_frame = series.slices[p.slice].frames > 1;
        const bool alike = !groups.empty() && is_frame && number(groups.back()[0]) == number(p);
        if (groups.empty() || !(is_moment || alike)) groups.emplace_back();
        groups.back().push_back(p);
    }
    choose_time_step(series, std::move(groups), request, stack);
    for (std::size_t i = 0; i < stack.slices.size(); ++i) stack.grid.push_back({i, i, 0});
    set_single_spacing(series.slices.front(), stack);
    if (is_moment) return;
    stack.notes.push_back("its slices do not say where they lie: piled up by their numbers, " +
                          text_of(stack.geometry.spacing[2]) + " mm apart");
}

}  // namespace

Stack stack_slices(const DicomSeries& series, const Request& request) {
    Stack stack;
    const DicomSlice& any = series.slices.front();
    stack.geometry.size = {any.columns, any.rows, 1};
    DicomSeries scaled = series;  // with a pixel size in any case
    if (!any.pixel) {
        stack.notes.push_back(any.aspect == 1 ? "it gives no pixel spacing: 1 mm was taken"
                                              : "it gives only the shape of its pixels: they were "
                                                "taken as 1 mm wide and " +
                                                    text_of(any.aspect) + " mm high");
        stack.geometry.measured = false;
        for (auto& s : scaled.slices) s.pixel = Vec3(1, any.aspect, 0);
    }
    stack.geometry.spacing.head<2>() = scaled.slices.front().pixel->head<2>();
    if (scaled.slices.size() > 1) place_by_location(scaled, stack.notes);
    const bool directed = std::ranges::all_of(
        series.slices, [](const DicomSlice& s) { return s.row && s.column && s.in_patient; });
    const bool sided = std::ranges::all_of(scaled.slices, &DicomSlice::is_sided);
    stack.geometry.oriented = directed && sided;
    if (directed && !sided) {
        stack.notes.emplace_back(
            "it does not say on which side of each other its slices lie: the volume may be "
            "mirrored, and is not oriented");
    }
    if (!std::ranges::all_of(scaled.slices, &DicomSlice::is_placed)) {
        check_all_placed(scaled);
        number_by_names(scaled, stack.notes);
        pile_up(scaled, request, stack);
        stack.geometry.size[2] = static_cast<int>(stack.slices.size());
        if (directed) stack.geometry.direction = plane_axes(scaled.slices.front());
        stack.geometry.oriented = directed && stack.slices.size() == 1;  // numbers go either way
        return stack;
    }
    stack.geometry.direction = plane_axes(scaled.slices.front());
    const Vec3 row = stack.geometry.direction.col(0), column = stack.geometry.direction.col(1),
               normal = stack.geometry.direction.col(2);
    choose_time_step(scaled, groups_of(scaled, normal), request, stack);
    const double start = stack.slices.front().along;
    for (PlacedSlice& p : stack.slices) p.along -= start;
    find_shear(scaled, row, column, stack);
    if (stack.slices.size() > 1) {
        const Steps steps = steps_of(stack, any);
        fill_grid(steps, stack);
        stack.geometry.spacing[2] = steps.spacing;
    } else {
        stack.grid.push_back({0, 0, 0});
        set_single_spacing(any, stack);
    }
    stack.geometry.size[2] = static_cast<int>(stack.grid.size());
    const DicomSlice& first = scaled.slices[stack.slices.front().at];
    stack.geometry.origin = *first.position + row * (stack.first_u * stack.geometry.spacing[0]) +
                            column * (stack.first_v * stack.geometry.spacing[1]);
    return stack;
}

}  // namespace palpate::io
