// The classes that palpate.js builds on, by embind. Errors become JavaScript's Error.
#include <emscripten/bind.h>
#include <emscripten/val.h>

#include <cstdlib>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "bindings/web/page_channel.hpp"
#include "bindings/web/reading.hpp"
#include "bindings/web/session.hpp"
#include "palpate/io/error.hpp"
#include "palpate/scenes/volumes.hpp"
#include "palpate/surface.hpp"

namespace palpate::web {
namespace {

using emscripten::typed_memory_view;
using emscripten::val;

/// Calls `work`; what it throws becomes an Error of the page.
template <class Work>
auto guarded(Work&& work) {
    try {
        return work();
    } catch (const std::exception& e) {
        val::global("Error").new_(std::string(e.what())).throw_();
        std::abort();  // not reached
    }
}

Vec3 vector_from(const val& list, int first = 0) {
    return {list[first].as<double>(), list[first + 1].as<double>(), list[first + 2].as<double>()};
}

/// Samples of the page, copied once.
class WebVolume {
  public:
    WebVolume(const val& samples, const std::string& type, const val& size, const val& spacing,
              const val& origin, const val& direction) {
        const auto bytes = samples["byteLength"].as<std::size_t>();
        const Vec3 counts = vector_from(size);
        // Before the conversion to integers, which is undefined for NaN and huge numbers.
        const double needed = counts.prod() * static_cast<double>(size_of(sample_type_from(type)));
        if (!(counts.array() >= 1).all() || needed != static_cast<double>(bytes)) {
            throw std::invalid_argument("size: the samples have " + std::to_string(bytes) +
                                        " bytes, which three counts of at least 1 must match");
        }
        Geometry geometry;
        geometry.size = counts.cast<int>();
        geometry.spacing = vector_from(spacing);
        geometry.origin = vector_from(origin);
        for (int row = 0; row < 3; ++row)
            geometry.direction.row(row) = vector_from(direction, 3 * row);
        const std::shared_ptr<std::byte[]> copy(new std::byte[bytes]);
        val(typed_memory_view(bytes, reinterpret_cast<unsigned char*>(copy.get())))
            .call<void>("set", samples);
        samples_ = std::make_shared<const Samples>(
            Volume(geometry, sample_type_from(type), std::shared_ptr<const void>(copy, copy.get()),
                   bytes));
    }
    explicit WebVolume(Volume volume)
        : samples_(std::make_shared<const Samples>(std::move(volume))) {}

    const Volume& volume() const { return samples_->volume(); }
    const std::shared_ptr<const Samples>& samples() const { return samples_; }

  private:
    std::shared_ptr<const Samples> samples_;
};

std::shared_ptr<WebVolume> new_volume(const val& samples, const std::string& type, const val& size,
                                      const val& spacing, const val& origin, const val& direction) {
    return guarded([&] {
        return std::make_shared<WebVolume>(samples, type, size, spacing, origin, direction);
    });
}

val scene(const std::string& spec) {
    return guarded([&] {
        scenes::Scene made = scenes::make_volume(spec);
        val result = val::object();
        result.set("isovalue", made.isovalue);
        result.set("description", made.description);
        result.set("volume", std::make_shared<WebVolume>(std::move(made.volume)));
        return result;
    });
}

val about_packed(const Packed& packed) {
    val part = val::object(), result = val::object();
    part.set("file", packed.file);
    part.set("offset", static_cast<double>(packed.offset));
    part.set("length", static_cast<double>(packed.length));
    part.set("unpacked", packed.unpacked);
    result.set("packed", part);
    return result;
}

val about_read(io::VolumeFile made) {
    val result = val::object(), notes = val::array();
    for (const std::string& note : made.notes) notes.call<void>("push", io::one_line(note));
    result.set("notes", notes);
    result.set("format", made.format);
    result.set("oriented", made.volume.geometry().oriented);
    result.set("volume", std::make_shared<WebVolume>(std::move(made.volume)));
    return result;
}

/// The volume of a file, or `packed`: a part that has to be unpacked before.
val read_file(const std::string& file) {
    return guarded([&] {
        try {
            return about_read(read(file));
        } catch (const Packed& packed) {
            return about_packed(packed);
        }
    });
}

val list_of(const Vec3& v) {
    val list = val::array();
    for (int i = 0; i < 3; ++i) list.set(i, v[i]);
    return list;
}

val description_of(const WebVolume& of) {
    const Volume& volume = of.volume();
    const Geometry& geometry = volume.geometry();
    val result = val::object(), direction = val::array();
    for (int i = 0; i < 9; ++i) direction.set(i, geometry.direction(i / 3, i % 3));
    result.set("type", std::string(name_of(volume.type())));
    result.set("size", list_of(geometry.size.cast<double>()));
    result.set("spacing", list_of(geometry.spacing));
    result.set("origin", list_of(geometry.origin));
    result.set("direction", direction);
    result.set("minimum", volume.minimum());
    result.set("maximum", volume.maximum());
    result.set("samples", val(typed_memory_view(volume.bytes(),
                                                static_cast<const unsigned char*>(volume.data()))));
    return result;
}

template <class T>
val copied(const char* type, const std::vector<T>& values) {
    return val::global(type).new_(typed_memory_view(values.size(), values.data()));
}

val as_arrays(const SurfaceMesh& mesh) {
    const auto floats = [](const std::vector<Vec3>& points) {
        std::vector<float> list;
        list.reserve(3 * points.size());
        for (const Vec3& point : points) {
            for (int i = 0; i < 3; ++i) list.push_back(static_cast<float>(point[i]));
        }
        return copied("Float32Array", list);
    };
    std::vector<unsigned> corners;
    for (const auto& triangle : mesh.triangles)
        corners.insert(corners.end(), triangle.begin(), triangle.end());
    val result = val::object();
    result.set("vertices", floats(mesh.vertices));
    result.set("normals", floats(mesh.normals));
    result.set("triangles", copied("Uint32Array", corners));
    return result;
}

/// The surface of a session's samples as they are, box by box, so that ticks can run in between.
class WebSurface {
  public:
    WebSurface(const WebSession& session, double isovalue)
        : field_(session.field()),
          isovalue_(isovalue),
          cells_(surface_cells(field_)),
          low_(cells_.low) {
        field_.use(session.samples());
    }

    /// The part in the next box of at most these cells, or null after the last one.
    val next(int x, int y, int z) {
        if ((low_.array() > cells_.high.array()).any()) return val::null();
        const Index3 edges = Index3(x, y, z).cwiseMax(1);
        SurfaceOptions options;
        options.normals = field_.interpolation() == Interpolation::cubic;
        options.cells = SampleBox{low_, (low_ + edges - Index3::Ones()).cwiseMin(cells_.high)};
        const SurfaceMesh mesh = extract_surface(field_, isovalue_, options);
        low_[0] += edges[0];
        for (int axis = 0; axis < 2 && low_[axis] > cells_.high[axis]; ++axis) {
            low_[axis] = cells_.low[axis];
            low_[axis + 1] += edges[axis + 1];
        }
        return as_arrays(mesh);
    }
    /// All of it.
    val whole() const {
        return as_arrays(extract_surface(
            field_, isovalue_, {.normals = field_.interpolation() == Interpolation::cubic}));
    }

  private:
    Field field_;
    double isovalue_;
    SampleBox cells_;
    Index3 low_;  // of the next box
};

/// `line` connects to the device (line.js), or is null.
std::shared_ptr<WebSession> new_session(const WebVolume& volume, const std::string& setup,
                                        const val& line) {
    return guarded([&] {
        Channel channel = line.isNull() ? nullptr : std::make_unique<PageChannel>(line);
        return std::make_shared<WebSession>(volume.samples(), setup, std::move(channel));
    });
}

std::shared_ptr<WebSurface> surface(const WebSession& session, double isovalue) {
    return guarded([&] { return std::make_shared<WebSurface>(session, isovalue); });
}
val next_part(WebSurface& surface, int x, int y, int z) {
    return guarded([&] { return surface.next(x, y, z); });
}
val whole_surface(const WebSurface& surface) {
    return guarded([&] { return surface.whole(); });
}

/// The session's snapshot where it lies: copy it before the next call.
val snapshot(WebSession& session) {
    const SnapshotNumbers& numbers = session.snapshot();
    return val(typed_memory_view(numbers.size(), numbers.data()));
}

/// A member function whose errors become those of the page.
template <auto member, class... Arguments>
auto caught(WebSession& session, Arguments... arguments) {
    return guarded([&] { return (session.*member)(arguments...); });
}

}  // namespace

EMSCRIPTEN_BINDINGS(palpate) {
    using Text = std::string;
    emscripten::class_<WebVolume>("Volume")
        .smart_ptr<std::shared_ptr<WebVolume>>("shared_ptr<Volume>")
        .function("description", &description_of);
    emscripten::function("newVolume", &new_volume);
    emscripten::function("scene", &scene);
    emscripten::function("read", &read_file);
    emscripten::class_<WebSurface>("Surface")
        .smart_ptr<std::shared_ptr<WebSurface>>("shared_ptr<Surface>")
        .function("next", &next_part)
        .function("whole", &whole_surface);
    emscripten::class_<WebSession>("Session")
        .smart_ptr<std::shared_ptr<WebSession>>("shared_ptr<Session>")
        .function("read", &WebSession::read)
        .function("lose", &WebSession::lose)
        .function("puck", &caught<&WebSession::puck, int, Text>)
        .function("step", &WebSession::step)
        .function("stepAt", &WebSession::step_at)
        .function("due", &WebSession::due)
        .function("stop", &WebSession::stop)
        .function("send", &caught<&WebSession::send, Text>)
        .function("settings", &WebSession::settings)
        .function("set", &caught<&WebSession::set, Text, double>)
        .function("edit", &caught<&WebSession::edit, Text, bool>)
        .function("drill", &caught<&WebSession::drill, double, bool>)
        .function("undo", &caught<&WebSession::undo>)
        .function("redo", &caught<&WebSession::redo>)
        .function("report", &WebSession::report)
        .function("record", &caught<&WebSession::record, Text>)
        .function("recording", &caught<&WebSession::recording>)
        .function("snapshot", &snapshot)
        .function("surface", &surface);
    emscripten::function("newSession", &new_session);
}

}  // namespace palpate::web
