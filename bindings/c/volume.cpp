// Volumes of the C interface: copied, adopted or loaded.
#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "bindings/c/handles.hpp"
#include "bindings/c/structs.hpp"
#include "palpate/run/no_effect.hpp"

namespace palpate::c {
namespace {

/// Calls the caller's function when the last copy goes, unless it was called off.
struct Release {
    void (*release)(void*);
    void* context;
    bool armed = false;

    ~Release() {
        if (armed && release) release(context);
    }
};

palpate_volume* in_memory(Volume volume) {
    return new palpate_volume{
        {.volume = std::move(volume), .source = run::source_named("memory"), .name = "memory"}};
}

SampleType type_from(std::int32_t type) {
    return one_of<SampleType>(type, "type");
}

void* copied(const void* samples, std::size_t bytes) {
    void* copy = ::operator new(bytes);
    std::memcpy(copy, samples, bytes);
    return copy;
}

}  // namespace

extern "C" PALPATE_API palpate_status palpate_volume_copy(const palpate_geometry* geometry,
                                                          int32_t type, const void* samples,
                                                          size_t bytes, palpate_volume** out) {
    return guarded([&] {
        given(out, "out");
        if (!samples) throw std::invalid_argument("samples is null");
        const Geometry grid = geometry_from(geometry);
        // Before the copy, which may be large: the volume would find out after it.
        check(grid);
        const auto wanted =
            static_cast<std::uint64_t>(sample_count(grid)) * size_of(type_from(type));
        if (bytes != wanted) {
            throw std::invalid_argument("bytes is " + std::to_string(bytes) +
                                        "; the geometry takes " + std::to_string(wanted));
        }
        const std::shared_ptr<const void> own(copied(samples, bytes),
                                              [](void* p) { ::operator delete(p); });
        *out = in_memory(Volume(grid, type_from(type), own, bytes, progress_of_thread()));
    });
}

extern "C" PALPATE_API palpate_status palpate_volume_adopt(const palpate_geometry* geometry,
                                                           int32_t type, const void* samples,
                                                           size_t bytes,
                                                           void (*release)(void* context),
                                                           void* context, palpate_volume** out) {
    return guarded([&] {
        given(out, "out");
        if (!samples) throw std::invalid_argument("samples is null");
        const auto released = std::make_shared<Release>(Release{release, context});
        const std::shared_ptr<const void> shared(released, samples);
        *out = in_memory(
            Volume(geometry_from(geometry), type_from(type), shared, bytes, progress_of_thread()));
        released->armed = true;
    });
}

extern "C" PALPATE_API palpate_status palpate_volume_load(const char* name,
                                                          const palpate_load_options* options,
                                                          palpate_volume** out) {
    return guarded([&] {
        given(out, "out");
        const auto asked = taken_or_default(options, "options");
        run::Source source = run::source_named(&given(name, "name"));
        source.smooth = asked.smooth;
        source.dequantize = asked.dequantize;
        if (asked.frame < 0) throw std::invalid_argument("frame is 0, or a number from 1");
        if (asked.frame != 0) source.frame = asked.frame - 1;
        if (asked.series) {
            auto* file = std::get_if<run::FileSource>(&source.from);
            if (!file) throw std::invalid_argument("series is for files");
            file->series = asked.series;
        }
        run::LoadedVolume loaded = run::load(source, progress_of(asked, "loading was cancelled"));
        std::vector<run::NoEffect> useless = run::without_effect(loaded);
        for (run::NoEffect& one : useless) {  // with the name that it has here
            std::ranges::replace(one.names, std::string("time_step"), std::string("frame"));
        }
        run::refuse_without_effect(
            useless, {{"series", asked.series != nullptr}, {"frame", asked.frame != 0}});
        *out = new palpate_volume{std::move(loaded)};
    });
}

extern "C" PALPATE_API palpate_status palpate_volume_describe(const palpate_volume* volume,
                                                              palpate_volume_info* out) {
    return guarded([&] {
        const run::LoadedVolume& loaded = given(volume, "volume").loaded;
        auto info = sized<palpate_volume_info>();
        info.type = static_cast<std::int32_t>(loaded.volume.type());
        info.geometry = geometry_to(loaded.volume.geometry());
        info.minimum = loaded.volume.minimum();
        info.maximum = loaded.volume.maximum();
        info.isovalue = usual_isovalue(loaded).value_or(std::numeric_limits<double>::quiet_NaN());
        info.frames = static_cast<std::int32_t>(std::max(1, loaded.sequence.count()));
        give(out, "out", info);
    });
}

extern "C" PALPATE_API const void* palpate_volume_samples(const palpate_volume* volume) {
    return volume ? volume->loaded.volume.data() : nullptr;
}

extern "C" PALPATE_API void palpate_volume_destroy(palpate_volume* volume) {
    delete volume;
}

}  // namespace palpate::c
