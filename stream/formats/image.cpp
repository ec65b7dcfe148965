// The volume of a store that an image's metadata describe. See the header.
#include "stream/formats/image.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <sstream>
#include <utility>

#include "io/chunked_image.hpp"
#include "io/file_grid.hpp"
#include "io/units.hpp"
#include "io/words.hpp"
#include "palpate/io/error.hpp"
#include "palpate/io/orientation.hpp"
#include "stream/formats/stores.hpp"

namespace palpate::stream {
namespace {

constexpr double longest_grid = 1 << 30;  // [samples] along an axis

/// Which axis is which.
struct Roles {
    std::array<int, 3> space = {-1, -1, -1};
    int time = -1, channel = -1;
};

/// Axes of other names are the axes of space that are left, the last one x. Throws BadMetadata if
/// there are too many.
Roles roles_of(const std::vector<ImageAxis>& axes, std::vector<std::string>& notes) {
    Roles roles;
    std::vector<std::size_t> others;
    const auto fail = [](const std::string& name) {
        throw BadMetadata("its axis '" + name + "' is not one of t, c, z, y, x, once each");
    };
    for (std::size_t a = 0; a < axes.size(); ++a) {
        const std::string& name = axes[a].name;
        int* const role = name == "x"   ? &roles.space[0]
                          : name == "y" ? &roles.space[1]
                          : name == "z" ? &roles.space[2]
                          : name == "t" ? &roles.time
                          : name == "c" ? &roles.channel
                                        : nullptr;
        if (!role) {
            others.insert(others.begin(), a);
            continue;
        }
        if (*role >= 0) fail(name);
        *role = static_cast<int>(a);
    }
    std::string taken;
    for (const std::size_t a : others) {
        const auto free = std::ranges::find(roles.space, -1);
        if (free == roles.space.end()) fail(axes[a].name);
        *free = static_cast<int>(a);
        const std::string one = axes[a].name + " as " + "xyz"[free - roles.space.begin()];
        taken = one + (taken.empty() ? "" : ", ") + taken;
    }
    if (!taken.empty()) {
        notes.push_back("its axes with other names were taken by their order: " + taken);
    }
    if (roles.space[0] < 0 || roles.space[1] < 0) throw BadMetadata("it has no axes x and y");
    return roles;
}

/// Of the unit of an axis. `others`: the unit of the other axes, or empty.
double millimetres_of(const ImageAxis& axis, const std::string& others,
                      std::vector<std::string>& notes) {
    if (const auto millimetres = io::millimetres_in(axis.unit)) return *millimetres;
    if (const auto millimetres = io::millimetres_in(others)) {
        io::add_note(notes, "its axis " + axis.name + " has no unit of length, and others have '" +
                                io::one_line(others.substr(0, 40)) + "': that was taken");
        return *millimetres;
    }
    const std::string note = axis.unit.empty()
                                 ? "its metadata give no unit of length: mm were taken"
                                 : "its unit of length '" + io::one_line(axis.unit.substr(0, 40)) +
                                       "' is not known: mm were taken";
    io::add_note(notes, note);
    return 1;
}

/// False for "pixel" and the like. Without a unit, the metadata may still mean lengths.
bool is_length(const std::string& unit) {
    return unit.empty() || io::millimetres_in(unit);
}

Vec3 extent_of(const Geometry& grid) {
    return grid.spacing.cwiseProduct(grid.size.cast<double>());
}

bool within(const Vec3& apart, const Vec3& most) {
    return (apart.cwiseAbs().array() <= most.array()).all();
}

/// "20 x 10 x 5 mm"
std::string lengths(const Vec3& v) {
    std::ostringstream text;
    text << v[0] << " x " << v[1] << " x " << v[2] << " mm";
    return text.str();
}

class Taking {
  public:
    Taking(const Image& image, ChunkedVolume begun, const StoreOptions& options)
        : image_(image), options_(options), volume_(std::move(begun)) {}

    ChunkedVolume volume() {
        const Image& image = image_;
        StoreInfo& info = volume_.info;
        const Roles roles = roles_of(image.axes, info.notes);
        take_sides(roles);
        const ChunkedArray& finest = volume_.arrays[0];
        for (const ChunkedArray& array : volume_.arrays) {
            if (array.axes() != image.axes.size() || array.bytes.stored != finest.bytes.stored) {
                throw BadMetadata(
                    "its levels have different types, or other axes than its metadata say");
            }
        }
        info.type = finest.bytes.type();
        info.fill = std::isfinite(finest.bytes.fill) ? finest.bytes.fill : 0;
        info.range = image.range;
        if (!image.range) note_finite(finest.bytes, info.notes);
        io::note_conversion(finest.bytes.stored, finest.bytes.values, info.notes);
        take_choice(image, roles);
        volume_.space = roles.space;
        for (std::size_t i = 0; i < volume_.arrays.size(); ++i) {
            info.levels.push_back(level_of(volume_.arrays[i], image, image.levels[i], roles));
        }
        info.notes.insert(info.notes.end(), image.notes.begin(), image.notes.end());
        leave_out_contradictions();
        use_given();
        for (const Level& level : info.levels) fail_for(io::why_no_file_grid(level.geometry));
        return std::move(volume_);
    }

  private:
    void take_choice(const Image& image, const Roles& roles) {
        StoreInfo& info = volume_.info;
        const ChunkedArray& finest = volume_.arrays[0];
        volume_.fixed.assign(finest.axes(), 0);
        if (roles.time >= 0) {
            const auto t = static_cast<std::size_t>(roles.time);
            info.times = static_cast<int>(std::min<std::int64_t>(finest.shape[t], 1 << 30));
            const double unit = io::seconds_in(image.axes[t].unit).value_or(0);
            const double interval = unit * image.levels[0].scale[t];
            if (info.times > 1 && interval > 0) info.frame_interval = interval;
            volume_.fixed[t] = options_.time;
        }
        if (roles.channel >= 0) {
            const auto c = static_cast<std::size_t>(roles.channel);
            constexpr std::int64_t most = 1024;
            const auto count = static_cast<std::size_t>(std::min(finest.shape[c], most));
            for (std::size_t i = 0; count > 1 && i < count; ++i) {
                const bool named = i < image.channels.size() && !image.channels[i].empty();
                info.channels.push_back(named ? image.channels[i] : "channel " + std::to_string(i));
            }
            volume_.fixed[c] = options_.channel;
        }
        check_choice(info, options_);
        info.channel = options_.channel;
        info.time = options_.time;
        for (const ChunkedArray& array : volume_.arrays) {
            for (std::size_t a = 0; a < array.axes(); ++a) {
                if (volume_.fixed[a] >= array.shape[a]) {
                    throw BadMetadata("its levels have different numbers of channels or times");
                }
            }
        }
    }

    Level level_of(const ChunkedArray& array, const Image& image, const ImageLevel& place,
                   const Roles& roles) {
        Level level;
        bool measured = image.measured;
        level.chunk = Index3::Ones();
        level.geometry.size = Index3::Ones();
        if (image.direction) level.geometry.direction = *image.direction;
        if (sides_) level.geometry.direction = *sides_;
        for (Eigen::Index i = 0; i < 3; ++i) {
            if (roles.space[static_cast<std::size_t>(i)] < 0) continue;
            const auto a = static_cast<std::size_t>(roles.space[static_cast<std::size_t>(i)]);
            if (static_cast<double>(array.shape[a]) > longest_grid) {
                throw BadMetadata("it has more than 2^30 samples along an axis");
            }
            level.geometry.size[i] = static_cast<int>(array.shape[a]);
            level.chunk[i] = static_cast<int>(array.chunk[a]);
            const std::string others = unit_of_space(image, roles);
            const double unit = millimetres_of(image.axes[a], others, volume_.info.notes);
            measured = measured && (io::millimetres_in(image.axes[a].unit) ||
                                    (others.empty() && is_length(image.axes[a].unit)));
            level.geometry.spacing[i] = std::abs(place.scale[a]) * unit;
            level.geometry.origin[i] = place.translation[a] * unit;
            if (place.scale[a] < 0) level.geometry.direction.col(i) *= -1;
        }
        // RFC-4 gives translations along the same axes.
        if (sides_) level.geometry.origin = (*sides_ * level.geometry.origin).eval();
        level.geometry.oriented = image.oriented || sides_;
        level.geometry.measured = measured;
        try {  // its lengths may yet be given by the caller
            check(level.geometry);
        } catch (const std::invalid_argument& e) {
            fail_for(e.what());
        }
        level.geometry = orthonormal(level.geometry);
        return level;
    }

    /// Takes the directions of axes that say to which side of the body they run.
    void take_sides(const Roles& roles) {
        if (image_.direction) return;
        std::string sides;
        for (const int axis : roles.space) {
            if (axis >= 0) sides += image_.axes[static_cast<std::size_t>(axis)].side;
        }
        if (sides.empty()) return;
        try {
            sides_ = io::direction_from(sides);
        } catch (const std::invalid_argument&) {
            volume_.info.notes.emplace_back(
                "the orientation of its axes was not used: that of x, y and z is needed, one of "
                "left and right, one of anterior and posterior, one of inferior and superior");
        }
    }

    /// The first one that is known; empty if none is.
    static std::string unit_of_space(const Image& image, const Roles& roles) {
        for (const int axis : roles.space) {
            if (axis < 0) continue;
            const std::string& unit = image.axes[static_cast<std::size_t>(axis)].unit;
            if (io::millimetres_in(unit)) return unit;
        }
        return {};
    }

    /// Does nothing if there is no reason.
    static void fail_for(const std::string& why) {
        if (why.empty()) return;
        throw BadMetadata("its place in space is not possible (" + why +
                          "); correct its metadata, or give the spacing");
    }

    /// Sizes of coarser levels are rounded either way, and written scales to some digits.
    void leave_out_contradictions() {
        std::vector<Level>& levels = volume_.info.levels;
        const Geometry finest = levels[0].geometry;
        const Vec3 whole = extent_of(finest);
        for (std::size_t i = levels.size() - 1; i > 0; --i) {
            const Geometry& level = levels[i].geometry;
            const Vec3 extent = extent_of(level);
            const Vec3 corner = grid_axes_from_physical(finest, level.origin - finest.origin) -
                                (level.spacing - finest.spacing) / 2;
            const Vec3 most = 1.001 * level.spacing.cwiseMax(finest.spacing).cwiseMax(whole / 100);
            const bool is_as_large = within(extent - whole, most);
            if (is_as_large && within(corner, most)) continue;
            volume_.info.notes.push_back(
                "its level " + std::to_string(i) + " was left out: by its " +
                (is_as_large
                     ? "translation it lies elsewhere than the finest"
                     : "scale it is " + lengths(extent) + ", and the finest " + lengths(whole)));
            const auto at = static_cast<std::ptrdiff_t>(i);
            levels.erase(levels.begin() + at);
            volume_.arrays.erase(volume_.arrays.begin() + at);
        }
    }

    /// The spacing that the caller gives is that of the finest level.
    void use_given() {
        const Geometry finest = volume_.info.levels[0].geometry;
        Geometry given = finest;
        io::put_in({options_.spacing, options_.orientation}, given);
        if (!options_.spacing && options_.orientation.empty()) return;
        const Vec3 factor = given.spacing.cwiseQuotient(finest.spacing);
        for (Level& level : volume_.info.levels) {
            const Vec3 apart =
                grid_axes_from_physical(finest, level.geometry.origin - finest.origin);
            const Vec3 spacing = level.geometry.spacing.cwiseProduct(factor);
            const Index3 size = level.geometry.size;
            level.geometry = given;
            level.geometry.size = size;
            level.geometry.spacing = spacing;
            level.geometry.origin = given.origin + given.direction * apart.cwiseProduct(factor);
        }
    }

    const Image& image_;
    const StoreOptions& options_;
    ChunkedVolume volume_;
    std::optional<Mat3> sides_;  ///< directions of the axes, if they say their sides
};

}  // namespace

std::vector<ImageAxis> usual_axes(std::size_t count) {
    static constexpr std::array names = {"t", "c", "z", "y", "x"};
    if (count < 2 || count > names.size()) {
        throw BadMetadata("it has " + std::to_string(count) + " axes; 2 to 5 can be read");
    }
    std::vector<ImageAxis> axes;
    for (std::size_t a = 0; a < count; ++a) axes.push_back({names[names.size() - count + a], ""});
    return axes;
}

void check_axes(const std::vector<ImageAxis>& axes) {
    std::vector<std::string> unused;
    (void)roles_of(axes, unused);
}

ChunkedVolume volume_of(const Image& image, ChunkedVolume begun, const StoreOptions& options) {
    return Taking(image, std::move(begun), options).volume();
}

std::vector<double> factors_by_size(std::span<const ChunkedArray> arrays, std::size_t at) {
    std::vector<double> factors(arrays[0].axes(), 1);
    for (std::size_t i = 0; i < at; ++i) {
        for (std::size_t a = 0; a < factors.size(); ++a) {
            factors[a] *= io::factor_between(arrays[i].shape[a], arrays[i + 1].shape[a]);
        }
    }
    return factors;
}

std::vector<int> axes_in_order(const ChunkedArray& array) {
    std::vector<int> axes(array.axes());
    std::iota(axes.begin(), axes.end(), 0);
    return axes;
}

void check_array(const ChunkedArray& array) {
    try {
        check(array);
    } catch (const std::invalid_argument& e) {
        throw BadMetadata(e.what());
    }
}

}  // namespace palpate::stream
