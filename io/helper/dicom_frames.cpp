// Finds the places and moments of the frames of a DICOM file. See the header.
#include "io/helper/dicom_frames.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "io/helper/dicom_attributes.hpp"

namespace palpate::io {
namespace {

constexpr DicomTag frame_time{0x0018, 0x1063}, frame_times{0x0018, 0x1065};
constexpr DicomTag shared_groups{0x5200, 0x9229};
constexpr double default_step = 1;  // [mm] if nothing gives the distance between slices

/// The place of frames and the meaning of their values.
void take_groups(DicomSlice& s, const FunctionalGroups& groups) {
    groups.with({0x0028, 0x9110}, [&](const DicomGroup& g) { set_pixel(s, g); });
    groups.with({0x0020, 0x9113}, [&](const DicomGroup& g) { set_place(s, g); });
    groups.with({0x0020, 0x9116}, [&](const DicomGroup& g) { set_place(s, g); });
    groups.with({0x0028, 0x9145}, [&](const DicomGroup& g) { set_rescale(s, g); });
    groups.with({0x0028, 0x9132}, [&](const DicomGroup& g) { set_window(s, g); });
    groups.with(value_mapping, [&](const DicomGroup&) { note_value_mapping(s); });
    groups.with({0x0020, 0x930e}, [&](const DicomGroup& g) {
        set_place(s, g.binary<double>({0x0020, 0x9301}), {});
        s.in_patient = false;
    });
    groups.with({0x0020, 0x930f}, [&](const DicomGroup& g) {
        set_place(s, {}, g.binary<double>({0x0020, 0x9302}));
    });
}

DicomSlice enhanced_frame(const DicomSlice& file, int number, const FunctionalGroups& groups,
                          const Segments& segments) {
    DicomSlice s = file;
    s.frame = s.order = number;
    s.keys[frame_number] = number;
    take_groups(s, groups);
    set_kind(s, groups, segments);
    set_moment(s, groups);
    return s;
}

/// Classes whose frames are moments of one picture if they have no place: ultrasound and X-rays
/// from one side.
bool is_film(const DicomGroup& data) {
    const std::string kind = data.text({0x0008, 0x0016}), images = "1.2.840.10008.5.1.4.1.1.";
    return kind == images + "3" || kind == images + "3.1" || kind.starts_with(images + "12.");
}

void set_film(std::vector<DicomSlice>& slices, const DicomGroup& data) {
    const double rate = data.number({0x0018, 0x0040}, data.number({0x0008, 0x2144}, 0));
    for (DicomSlice& s : slices) {
        s.is_moment = true;
        s.seconds = data.number(frame_time, rate > 0 ? 1000 / rate : 0) / 1000;
        add_note(s.notes, "its " + std::to_string(s.frames) +
                              " frames are moments of one slice, not slices");
    }
}

/// Frames of one stack, by their places in a file.
using FramesOfStack = std::vector<std::size_t>;

/// Whether something tells frames at one place apart as moments do.
bool are_moments(const std::vector<DicomSlice>& slices, const FramesOfStack& stack) {
    const auto key_in = [&](std::size_t frame, std::size_t key) {
        const auto& keys = slices[frame].keys;
        return key < keys.size() ? keys[key] : std::nan("");
    };
    const auto values = [&](std::size_t key) {
        std::set<double> all;
        for (const std::size_t i : stack) {
            if (!std::isnan(key_in(i, key))) all.insert(key_in(i, key));
        }
        return all.size();
    };
    // Numbers in the stack tell places. Only a time of its own for every frame contradicts them.
    if (slices[stack[0]].is_numbered) return values(temporal_position) == stack.size();
    std::size_t keys = 0;
    for (const std::size_t i : stack) keys = std::max(keys, slices[i].keys.size());
    for (std::size_t key = temporal_position; key < keys; ++key) {
        const bool counts = key <= acquisition_time || key >= first_dimension;
        if (counts && values(key) > 1) return true;
    }
    return false;
}

/// Some writers give one position for a whole stack. Then the frames lie one behind the other in
/// the order of their numbers in the stack (PS3.3 C.7.6.16.2.2.4), or of the file, if it gives a
/// distance between them.
void spread_stack(std::vector<DicomSlice>& slices, const FramesOfStack& stack) {
    const DicomSlice first = slices[stack[0]];
    const auto is_here = [&](std::size_t i) {
        const DicomSlice& s = slices[i];
        return s.is_placed() && *s.position == *first.position &&
               s.is_numbered == first.is_numbered;
    };
    if (!first.position || stack.size() < 2 || !std::ranges::all_of(stack, is_here)) return;
    if (!(first.is_numbered || first.between != 0) || are_moments(slices, stack)) return;
    const auto number = [&](std::size_t i) { return slices[i].order; };
    const auto [least, most] = std::ranges::minmax(stack, {}, number);
    if (number(least) == number(most)) return;
    const double start = std::min(number(least), 1);  // a stack may begin in another file
    const double step = first.between != 0    ? first.between
                        : first.thickness > 0 ? first.thickness
                                              : default_step;
    for (std::size_t rank = 0; rank < stack.size(); ++rank) {
        DicomSlice& s = slices[stack[rank]];
        const double steps = s.is_numbered ? s.order - start : static_cast<double>(rank);
        s.position = *first.position + first.normal() * (step * steps);
        check_coordinate(step * steps, "DICOM tag InStackPositionNumber");
        s.is_sided = false;
        add_note(s.notes,
                 "its frames all have one position: they were placed one behind the "
                 "other, " +
                     text_of(std::abs(step)) + " mm apart");
    }
}

void spread_stacks(std::vector<DicomSlice>& slices) {
    std::map<std::tuple<std::string, std::string, std::string>, FramesOfStack> stacks;
    for (std::size_t i = 0; i < slices.size(); ++i) {
        const DicomSlice& s = slices[i];
        const std::string echo = std::isnan(s.echo) ? "" : text_of(s.echo);
        stacks[s.is_numbered ? std::tuple(s.stack, std::string(), std::string())
                             : std::tuple(s.stack, s.kind, echo)]
            .push_back(i);
    }
    for (const auto& [key, stack] : stacks) spread_stack(slices, stack);
}

std::vector<DicomSlice> enhanced_frames(const DicomSlice& file, const DicomGroup& data) {
    const auto frames = data.items(groups_of_frames);
    if (frames.size() != static_cast<std::size_t>(file.frames)) {
        throw Failure(quoted(file.file) + " has " + std::to_string(file.frames) +
                      " frames, and describes " + std::to_string(frames.size()) +
                      "; copy or export it again");
    }
    const auto shared = data.items(shared_groups);
    const Segments segments = segments_in(data);
    std::vector<DicomSlice> slices;
    std::set<std::pair<double, double>> directions;  // [degrees] of X-rays
    for (int i = 0; i < file.frames; ++i) {
        const FunctionalGroups groups(frames[static_cast<std::size_t>(i)],
                                      shared.empty() ? nullptr : &shared.front());
        slices.push_back(enhanced_frame(file, i, groups, segments));
        groups.with({0x0018, 0x9405}, [&](const DicomGroup& g) {
            directions.emplace(g.number({0x0018, 0x1510}, 0), g.number({0x0018, 0x1511}, 0));
        });
    }
    if (directions.size() > 1) {
        throw Failure(quoted(file.file) +
                      " has projections from several directions; export a reconstructed volume");
    }
    const auto has_place = [](const DicomSlice& s) { return s.position.has_value(); };
    if (!is_film(data)) {
        spread_stacks(slices);
    } else if (std::ranges::none_of(slices, has_place)) {
        set_film(slices, data);
    }
    return slices;
}

/// The quantity by which FrameIncrementPointer counts the frames.
enum class Counted { by_nothing, by_time, by_slice, by_offset, by_location, by_page, otherwise };

constexpr DicomTag grid_offsets{0x3004, 0x000c}, frame_locations{0x0018, 0x2005},
    pages{0x0018, 0x2001};

bool has_time(const DicomGroup& data) {
    return data.has(frame_time) || data.has(frame_times);
}

Counted counted(const DicomGroup& data, double between) {
    const auto pointers = data.tags({0x0028, 0x0009});
    if (pointers.empty()) {
        // A distance between frames says more than a time, which many writers leave there.
        const bool is_stack = !is_film(data) && between != 0;
        return has_time(data) && !is_stack ? Counted::by_time
               : data.has(grid_offsets)    ? Counted::by_offset
               : data.has(frame_locations) ? Counted::by_location
               : data.has(pages)           ? Counted::by_page
                                           : Counted::by_nothing;
    }
    if (pointers.size() > 1) return Counted::otherwise;
    if (pointers[0] == frame_time || pointers[0] == frame_times) return Counted::by_time;
    if (pointers[0] == DicomTag{0x0054, 0x0080}) return Counted::by_slice;
    if (pointers[0] == grid_offsets) return Counted::by_offset;
    if (pointers[0] == frame_locations) return Counted::by_location;
    if (pointers[0] == pages) return Counted::by_page;
    return Counted::otherwise;
}

/// The place of each frame among the slices, from 0, according to SliceVector.
std::vector<int> order_of(const DicomSlice& file, const DicomGroup& data) {
    const auto told = data.counts({0x0054, 0x0080});
    std::vector<int> order;
    for (int i = 0; i < file.frames; ++i) {
        const auto at = static_cast<std::size_t>(i);
        order.push_back(told.empty() ? i : at < told.size() ? static_cast<int>(told[at]) - 1 : -1);
    }
    std::vector<int> sorted = order;
    std::ranges::sort(sorted);
    for (int i = 0; i < file.frames; ++i) {
        if (sorted[static_cast<std::size_t>(i)] == i) continue;
        throw Failure(quoted(file.file) + " has a SliceVector that does not name each of its " +
                      std::to_string(file.frames) + " slices once; export it again");
    }
    return order;
}

/// One behind the other from the first one's position, by the distances given [mm].
void place_behind(std::vector<DicomSlice>& slices, const std::vector<double>& distances) {
    const DicomSlice first = slices.front();
    if (!first.is_placed()) return;
    for (std::size_t i = 0; i < slices.size(); ++i) {
        slices[i].position = *first.position + first.normal() * (distances[i] - distances[0]);
    }
}

/// Offsets of a dose grid count along the normal, or are z of the patient (PS3.3 C.8.8.3.2): then
/// the first one is that of the position.
std::vector<double> along_normal(std::vector<double> offsets, const DicomSlice& first) {
    constexpr double rounding = 0.01;  // [mm]
    if (!first.is_placed() || offsets[0] == 0) return offsets;
    const bool is_z = std::abs(offsets[0] - first.position->z()) <= rounding;
    if (is_z && first.normal().z() < -0.99) {
        for (double& offset : offsets) offset = -offset;
    }
    return offsets;
}

/// The numbers of a vector that counts the frames. One of another length tells nothing, which is
/// noted.
std::vector<double> vector_of(std::vector<DicomSlice>& slices, const DicomGroup& data, DicomTag tag,
                              const char* name) {
    std::vector<double> numbers = data.numbers(tag);
    for (const double number : numbers) check_coordinate(number, name);
    if (numbers.size() == slices.size()) return numbers;
    for (DicomSlice& s : slices) {
        if (!data.has(tag)) break;
        add_note(s.notes, "its " + std::string(name) + " has " + std::to_string(numbers.size()) +
                              " numbers for " + std::to_string(slices.size()) +
                              " frames: it was ignored");
    }
    return {};
}

/// By the vector that gives a place for each frame; false if there is none.
bool place_by_vector(std::vector<DicomSlice>& slices, const DicomGroup& data, Counted by) {
    if (by != Counted::by_offset && by != Counted::by_location) return false;
    const bool is_grid = by == Counted::by_offset;
    const char* const name = is_grid ? "GridFrameOffsetVector" : "SliceLocationVector";
    const auto offsets = vector_of(slices, data, is_grid ? grid_offsets : frame_locations, name);
    if (offsets.empty()) return false;
    place_behind(slices, is_grid ? along_normal(offsets, slices.front()) : offsets);
    for (std::size_t i = 0; i < slices.size(); ++i) {
        // PS3.3 leaves open in which direction SliceLocation counts.
        slices[i].is_sided = is_grid;
        if (slices[i].is_placed()) continue;
        slices[i].location = offsets[i];
        slices[i].location_source = name;
    }
    return true;
}

/// The place of each frame among the slices, from 0, by numbers of pages, which may have gaps;
/// that of the file if they name a page twice.
std::vector<int> order_of_pages(std::vector<DicomSlice>& slices, const DicomGroup& data,
                                std::vector<int> order) {
    constexpr const char* name = "PageNumberVector";
    const auto numbers = vector_of(slices, data, pages, name);
    std::vector<double> sorted = numbers;
    std::ranges::sort(sorted);
    if (std::ranges::adjacent_find(sorted) != sorted.end()) {
        for (DicomSlice& s : slices) {
            add_note(s.notes, std::string("its ") + name + " names a page twice: it was ignored");
        }
        return order;
    }
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        order[i] = static_cast<int>(std::ranges::lower_bound(sorted, numbers[i]) - sorted.begin());
    }
    return order;
}

std::vector<double> even_distances(const std::vector<int>& order, double step) {
    std::vector<double> distances;
    for (const int place : order) distances.push_back(place * step);
    return distances;
}

/// Frames without functional groups.
std::vector<DicomSlice> plain_frames(DicomSlice file, const DicomGroup& data) {
    // Nuclear medicine keeps the place of its slices with the detector.
    const auto detectors = data.items({0x0054, 0x0022});
    if (!detectors.empty() && !file.position) {
        set_place(file, detectors.front());
    }
    std::vector<DicomSlice> slices(static_cast<std::size_t>(file.frames), file);
    for (std::size_t i = 0; i < slices.size(); ++i) {
        slices[i].frame = slices[i].order = static_cast<int>(i);
        slices[i].keys[frame_number] = static_cast<double>(i);
    }
    const auto note = [&](const std::string& text) {
        for (DicomSlice& s : slices) s.notes.push_back(text);
    };
    const std::string all = "its " + std::to_string(file.frames) + " frames ";
    const Counted by = counted(data, file.between);
    if (by == Counted::otherwise) {
        throw Failure(quoted(file.file) +
                      " counts its frames by more than their place or time (projections, phases); "
                      "export a reconstructed volume");
    }
    const bool has_place = file.position || data.has(between_tag) || file.between != 0;
    const bool is_open = by == Counted::by_nothing || by == Counted::by_page;
    if (by == Counted::by_time || (is_open && !has_place && is_film(data))) {
        set_film(slices, data);
        return slices;
    }
    if (place_by_vector(slices, data, by)) return slices;
    std::vector<int> order = order_of(file, data);
    if (by == Counted::by_page) order = order_of_pages(slices, data, std::move(order));
    for (std::size_t i = 0; i < slices.size(); ++i) slices[i].order = order[i];
    check_coordinate(file.between, "DICOM tag SpacingBetweenSlices");
    if (file.between != 0) {
        if (by == Counted::by_nothing && has_time(data)) {
            note(all + "have a distance and a time between them: they were taken as slices");
        }
        place_behind(slices, even_distances(order, file.between));
        return slices;
    }
    const double step = file.thickness > 0 ? file.thickness : default_step;
    place_behind(slices, even_distances(order, step));
    for (DicomSlice& s : slices) s.is_sided = by == Counted::by_slice;
    note(all + "do not say where they lie: taken as slices " + text_of(step) + " mm apart");
    return slices;
}

}  // namespace

std::vector<DicomSlice> frames_in(const DicomSlice& file, const DicomGroup& data) {
    if (data.has(groups_of_frames)) return enhanced_frames(file, data);
    const auto shared = data.items(shared_groups);
    DicomSlice described = file;
    if (!shared.empty()) take_groups(described, FunctionalGroups(shared.front(), nullptr));
    if (file.frames == 1) return {described};
    std::vector<DicomSlice> slices = plain_frames(described, data);
    for (DicomSlice& s : slices) {
        if (shared.empty()) break;
        s.is_sided = false;
        add_note(s.notes,
                 "it describes its " + std::to_string(file.frames) +
                     " frames all together, and none alone: they were taken in their order");
    }
    return slices;
}

}  // namespace palpate::io
