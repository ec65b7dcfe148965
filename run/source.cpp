// Loads the volume that a source names.
#include "palpate/run/source.hpp"

#include <stdexcept>

#include "palpate/filters/dequantize.hpp"
#include "palpate/io/address.hpp"
#include "palpate/io/error.hpp"
#include "palpate/io/orientation.hpp"
#include "palpate/scenes/beating.hpp"
#include "palpate/scenes/volumes.hpp"
#include "stream/while_telling.hpp"

namespace palpate::run {
namespace {

/// [s] How long the first frame of a live source is waited for.
constexpr double longest_wait = 30;

/// The synthetic volume that is a sequence, with or without a size.
bool is_beating(const std::string& scene) {
    return scene == "beating" || scene.starts_with("beating:");
}

LoadedVolume loaded_from(Volume volume, const Source& source) {
    return {std::move(volume), source, name_of(source)};
}

LoadedVolume loaded_from(const scenes::Scene& scene, const Source& source) {
    LoadedVolume loaded = loaded_from(scene.volume, source);
    loaded.format = "synthetic (" + scene.description + ")";
    loaded.isovalue = scene.isovalue;
    return loaded;
}

LoadedVolume make_beating(const Source& source, const scenes::Scene& first,
                          const io::Progress& progress) {
    const Geometry grid = first.volume.geometry();
    const SampleType type = first.volume.type();
    const auto frame = [grid, type](int number, const io::Progress& each) {
        const double phase = double(number) / scenes::beating_frames;
        return scenes::beating_frame(grid, phase, type, each).volume;
    };
    LoadedVolume loaded = loaded_from(first, source);
    loaded.time_steps = scenes::beating_frames;
    if (source.frame) {
        if (*source.frame >= loaded.time_steps) {
            throw std::invalid_argument(loaded.name + " has " + std::to_string(loaded.time_steps) +
                                        " frames, from 0");
        }
        loaded.volume = frame(*source.frame, progress);
        return loaded;
    }
    const double usual = scenes::beating_period / scenes::beating_frames;
    loaded.sequence =
        io::made_sequence(scenes::beating_frames, source.frame_interval.value_or(usual), frame);
    return loaded;
}

LoadedVolume loaded_of(const SyntheticSource& synthetic, const Source& source,
                       const io::Progress& progress) {
    if (source.frame && !is_beating(synthetic.scene)) {
        throw std::invalid_argument(name_of(source) + ": is no sequence, so it has no time steps");
    }
    const scenes::Scene scene = scenes::make_volume(synthetic.scene, synthetic.type, progress);
    return is_beating(synthetic.scene) ? make_beating(source, scene, progress)
                                       : loaded_from(scene, source);
}

LoadedVolume loaded_of(const LiveSource& live, const Source& source, const io::Progress& progress) {
    if (source.smooth > 0 || source.dequantize > 0 || source.prefilter) {
        throw std::invalid_argument(live.path +
                                    ": a live source cannot be smoothed, dequantized or sharpened");
    }
    auto frames = std::make_shared<const io::LiveFrames>(live.path);
    const std::shared_ptr<const Samples> samples = frames->wait(longest_wait, progress);
    if (!samples) {
        throw io::InputError(live.path +
                             ": there is no frame yet; start the program that writes it");
    }
    LoadedVolume loaded = loaded_from(samples->volume(), source);
    loaded.format = "live source";
    loaded.live = std::move(frames);
    return loaded;
}

/// One frame of a file that holds several: read alone.
LoadedVolume one_frame_of(const FileSource& file, const Source& source, io::ReadOptions read) {
    read.time_step = *source.frame;
    io::VolumeFile got = io::read_volume(file.path, read);
    LoadedVolume loaded = loaded_from(std::move(got.volume), source);
    loaded.format = std::move(got.format);
    loaded.notes = std::move(got.notes);
    loaded.values = std::move(got.values);
    loaded.time_steps = got.time_steps;
    return loaded;
}

LoadedVolume loaded_of(const FileSource& file, const Source& source, const io::Progress& progress) {
    // Here, because the helper process would call it a fault of the file.
    if (!file.orientation.empty()) (void)io::direction_from(file.orientation);
    io::SequenceOptions options;
    options.interval = source.frame_interval.value_or(0);
    options.read.raw = file.raw;
    options.read.spacing = file.spacing;
    options.read.orientation = file.orientation;
    options.read.series = file.series;
    options.read.memory_limit_bytes = source.most_bytes;
    options.read.progress = progress;
    if (source.frame && !io::names_a_series(file.path)) {
        return one_frame_of(file, source, options.read);
    }
    io::SequenceFile got = io::open_sequence(file.path, options);
    LoadedVolume loaded = loaded_from(std::move(got.first), source);
    loaded.format = std::move(got.format);
    loaded.notes = std::move(got.notes);
    loaded.values = std::move(got.values);
    loaded.time_steps = got.sequence.count();
    if (!source.frame) {
        if (loaded.time_steps > 1) loaded.sequence = std::move(got.sequence);
        return loaded;
    }
    if (*source.frame >= loaded.time_steps) {
        throw io::InputError(file.path + ": there is no time step " +
                             std::to_string(*source.frame) + ": it has " +
                             std::to_string(loaded.time_steps) + " frames");
    }
    if (*source.frame > 0) {
        loaded.volume = io::read_frame(got.sequence, *source.frame, progress);
    }
    return loaded;
}

stream::StoreOptions options_of(const StoreSource& from, int time) {
    stream::StoreOptions options = from.options;
    options.time = time;
    // Bricks and chunks that are being unpacked share what the process may take.
    if (from.loader.whole_process) options.unpacking = from.loader.memory / 2;
    return options;
}

std::shared_ptr<const stream::Store> opened_store(const StoreSource& from, int time,
                                                  const io::Progress& progress) {
    try {
        return stream::open_store(from.address, options_of(from, time), progress);
    } catch (const io::InputError& e) {
        if (!from.lacks_secrets) throw;
        throw io::InputError(std::string(e.what()) +
                             "; this address was saved without its password and query: give the "
                             "whole one");
    }
}

LoadedVolume all_times_of(const StoreSource& from, const Source& source,
                          const io::Progress& progress) {
    if (source.frame) {
        throw std::invalid_argument(io::without_secrets(from.address) +
                                    ": one time step or all times, not both");
    }
    if (from.loader.whole_process || from.loader.coarse_first) {
        throw std::invalid_argument(io::without_secrets(from.address) +
                                    ": all times are read whole, so memory and coarse-first do "
                                    "nothing; --sequence-memory bounds the frames");
    }
    const auto open = [from](int time, const io::Progress& tell) {
        return opened_store(from, time, tell);
    };
    const auto first = open(0, progress);
    const stream::StoreInfo& info = first->info();
    if (info.times < 2) {
        throw std::invalid_argument(io::without_secrets(from.address) +
                                    ": there is one time: it is no sequence");
    }
    io::VolumeFile file{stream::read_level(*first, from.loader.level, progress), info.format,
                        info.times, info.notes, info.frame_interval};
    io::SequenceFile got = io::sequence_of(
        std::move(file), source.frame_interval.value_or(0),
        [open, level = from.loader.level](int time, const io::Progress& each) {
            return stream::read_level(*open(time, each), level, each);
        },
        [address = from.address](int time) { return address + ": time " + std::to_string(time); });
    LoadedVolume loaded = loaded_from(std::move(got.first), source);
    loaded.format = std::move(got.format);
    loaded.notes = std::move(got.notes);
    loaded.time_steps = got.sequence.count();
    loaded.sequence = std::move(got.sequence);
    return loaded;
}

/// So that edits are not saved for another volume that takes its place meanwhile.
void note_original(StreamedVolume& streamed, const std::function<void()>& tell) {
    std::error_code error;
    const auto whole = std::filesystem::absolute(streamed.opened.address, error);
    if (!error) streamed.opened.address = whole.string();
    try {
        streamed.opened.content = stream::while_telling(tell, [&](const std::stop_token& stop) {
            return stream::content_below_edits(*streamed.store, streamed.loader.level, stop);
        });
    } catch (const io::InputError&) {  // damaged somewhere: it can be touched elsewhere
    }
}

LoadedVolume loaded_of(const StoreSource& from, const Source& source,
                       const io::Progress& progress) {
    if (from.all_times) return all_times_of(from, source, progress);
    if (source.smooth > 0 || source.dequantize > 0 || source.prefilter) {
        throw std::invalid_argument(io::without_secrets(from.address) +
                                    ": is read while it is touched, so it cannot be smoothed, "
                                    "dequantized or sharpened");
    }
    const int time = source.frame.value_or(0);
    std::shared_ptr<const stream::Store> store = opened_store(from, time, progress);
    const stream::StoreInfo& info = store->info();
    std::function<void()> tell;
    if (progress) tell = [&] { progress(0.1); };
    LoadedVolume loaded =
        loaded_from(stream::while_telling(tell,
                                          [&](const std::stop_token& stop) {
                                              return stream::overview_of(
                                                  *store, stream::overview_samples, stop);
                                          }),
                    source);
    loaded.format = info.format;
    loaded.notes = info.notes;
    loaded.time_steps = info.times;
    const Index3& size = loaded.volume.geometry().size;
    loaded.notes.push_back(
        "it is read while it is touched; the histogram and the suggested isovalues are those of an "
        "overview of " +
        std::to_string(size[0]) + " x " + std::to_string(size[1]) + " x " +
        std::to_string(size[2]) + " samples");
    if (from.lacks_secrets) {
        loaded.notes.emplace_back("its address was saved without its password and query");
    }
    if (!info.range) {
        loaded.notes.emplace_back("its range is estimated from that overview");
    }
    loaded.streamed =
        StreamedVolume{std::move(store), from.loader, {from.address, options_of(from, time)}};
    loaded.streamed->loader.shared = stream::shared_loader(loaded.streamed->loader.threads);
    start_samples(loaded);  // says now what is wrong with the level
    if (!io::is_web_address(from.address)) note_original(*loaded.streamed, tell);
    return loaded;
}

/// The progress of a part of the work.
io::Progress part(const io::Progress& progress, double from, double to) {
    if (!progress) return {};
    return [&progress, from, to](double done) { progress(from + (to - from) * done); };
}

/// Filters every frame before anything else sees it.
class Preparation {
  public:
    explicit Preparation(const Source& source)
        : dequantize_(source.dequantize), smooth_(source.smooth), prefilter_(source.prefilter) {}

    bool any() const { return dequantize_ != 0 || smooth_ != 0 || prefilter_; }

    /// The volume is not kept while it is dequantized, to save memory.
    Volume operator()(Volume prepared, const io::Progress& progress) const {
        if (dequantize_ != 0) {
            filters::DequantizeOptions options;
            options.rounds = dequantize_;
            options.progress = part(progress, 0, 0.8);
            prepared = filters::dequantized(std::move(prepared), options);
        }
        prepared = smoothed(prepared, smooth_, part(progress, 0.8, 0.9));
        if (prefilter_) prepared = sharpened(prepared, part(progress, 0.9, 1));
        if (progress) progress(1);
        return prepared;
    }

    /// The progress of reading, if that is the first part of the work, and that of the rest.
    io::Progress reading(const io::Progress& progress) const { return part(progress, 0, reading_); }
    io::Progress preparing(const io::Progress& progress) const {
        return part(progress, reading_, 1);
    }

  private:
    int dequantize_, smooth_;
    bool prefilter_;
    double reading_ = any() ? 0.2 : 1;  ///< of the time
};

}  // namespace

std::shared_ptr<const Samples> start_samples(const LoadedVolume& loaded) {
    if (!loaded.streamed) return std::make_shared<const Samples>(loaded.volume);
    return stream::empty_samples(*loaded.streamed->store, loaded.volume,
                                 loaded.streamed->loader.level, loaded.streamed->loader.memory);
}

LoadedVolume load(const Source& source, const io::Progress& progress) {
    if (source.frame.value_or(0) < 0) {
        throw std::invalid_argument("frame " + std::to_string(*source.frame) +
                                    ": frames are numbered from 0");
    }
    const Preparation prepare(source);
    LoadedVolume loaded = std::visit(
        [&](const auto& from) { return loaded_of(from, source, prepare.reading(progress)); },
        source.from);
    if (!prepare.any()) return loaded;
    const io::Progress preparing = prepare.preparing(progress);
    if (source.dequantize > 0 && !filters::level_of(loaded.volume, part(preparing, 0, 0))) {
        loaded.notes.emplace_back(
            "its samples do not lie on levels, so there is no rounding to undo");
    }
    loaded.volume = prepare(std::move(loaded.volume), preparing);
    if (loaded.sequence.count() == 0) return loaded;
    loaded.sequence.type = loaded.volume.type();
    loaded.sequence.reader = [read = std::move(loaded.sequence.reader), prepare](
                                 int frame, const io::Progress& each) {
        return prepare(read(frame, prepare.reading(each)), prepare.preparing(each));
    };
    return loaded;
}

}  // namespace palpate::run
