// Saves the edits of a store. See palpate/stream/edits.hpp.
#include "palpate/stream/edits.hpp"

#include <atomic>
#include <cmath>
#include <cstring>
#include <map>

#include "io/system/growing_folder.hpp"
#include "io/system/own_names.hpp"
#include "palpate/io/output.hpp"
#include "palpate/stream/growing_image.hpp"
#include "stream/box_bytes.hpp"
#include "stream/formats/content.hpp"
#include "stream/formats/edited_store.hpp"
#include "stream/formats/stores.hpp"
#include "stream/while_telling.hpp"
#include "stream/writer/pyramid.hpp"

namespace palpate::stream {
namespace {

namespace fs = std::filesystem;

/// Chunks of each level whose stored samples are compared with finer ones.
constexpr std::size_t most_examined = 2;

/// The levels from one on, each with how many samples of the one before make one of it; zeros where
/// that is not a whole number.
std::vector<CoarserGrid> levels_from(const StoreInfo& info, int level) {
    std::vector<CoarserGrid> levels;
    for (std::size_t l = static_cast<std::size_t>(level); l < info.levels.size(); ++l) {
        const Geometry& grid = info.levels[l].geometry;
        CoarserGrid coarser{grid, Index3::Ones()};
        if (!levels.empty()) {
            const Geometry& finer = levels.back().geometry;
            for (int a = 0; a < 3; ++a) {
                const double ratio = grid.spacing[a] / finer.spacing[a];
                const int factor = static_cast<int>(std::lround(std::min(ratio, 1e6)));
                const bool whole = factor > 0 && std::abs(ratio - factor) < 1e-3 * factor &&
                                   std::int64_t{grid.size[a] - 1} * factor < finer.size[a];
                coarser.factor[a] = whole ? factor : 0;
            }
        }
        levels.push_back(coarser);
    }
    return levels;
}

/// The place of a box of the finer level in the coarser one.
SampleBox coarser_box(const SampleBox& box, const CoarserGrid& coarser) {
    return {
        box.low.cwiseQuotient(coarser.factor),
        box.high.cwiseQuotient(coarser.factor).cwiseMin(coarser.geometry.size - Index3::Ones())};
}

/// The chunks of another edge that hold the samples of these.
ChunkSet in_chunks_of(int edge, const ChunkSet& chunks, int edge_before, const Index3& size) {
    ChunkSet all;
    for (const Index3& chunk : chunks) {
        const Index3 low = chunk * edge_before;
        const SampleBox box{low,
                            (low + Index3::Constant(edge_before)).cwiseMin(size) - Index3::Ones()};
        for_each_piece(Index3::Constant(edge), box,
                       [&](const auto& other, const SampleBox&) { all.insert(other); });
    }
    return all;
}

class Saving {
  public:
    Saving(const Store& from, int level, const Samples& edits, fs::path folder, EditsNote note,
           std::atomic<double>& made, std::stop_token stop)
        : from_(from),
          level_(level),
          edits_(edits),
          folder_(std::move(folder)),
          note_(std::move(note)),
          levels_(levels_from(from.info(), level)),
          image_(folder_, from.info().type, levels_, {.chunk = note_.chunk, .progress = {}}),
          made_(made),
          stop_(std::move(stop)) {}

    EditsNote run() {
        image_.write_metadata(Range{edits_.minimum(), edits_.maximum()});
        written_ = open_zarr(folder_objects(folder_), folder_.string(), {});
        const std::vector<std::vector<SampleBox>> touched = touched_boxes();
        const CoarseningSeen seen = coarsening_of_original(touched);
        coarsening_ = seen.found();
        const auto any_coarser = [](const auto& boxes) { return !boxes.empty(); };
        if (!seen.is_known() && std::any_of(touched.begin() + 1, touched.end(), any_coarser)) {
            note_.guessed = coarsening_ == Coarsening::mean ? guessed_mean : guessed_single;
        }
        for (std::size_t l = 0; l < note_.chunks.size(); ++l) write_level(l, touched[l]);
        return std::move(note_);
    }

  private:
    /// The edited bricks, and the samples of each coarser level above them.
    std::vector<std::vector<SampleBox>> touched_boxes() const {
        std::vector<std::vector<SampleBox>> touched(1);
        const auto add = [&](const Index3& brick, const Brick&) {
            const Index3 low = brick * Bricks::edge;
            touched[0].push_back({low, (low + Index3::Constant(Bricks::edge - 1))
                                           .cwiseMin(edits_.geometry().size - Index3::Ones())});
        };
        if (edits_.bricks()) edits_.bricks()->for_each(add);
        while (touched.size() < note_.chunks.size()) {
            const CoarserGrid& grid = levels_[touched.size()];
            std::vector<SampleBox> boxes;
            if (grid.factor.minCoeff() > 0) {  // otherwise it stays as it was
                for (const SampleBox& box : touched.back()) {
                    boxes.push_back(coarser_box(box, grid));
                }
                std::erase_if(boxes, [](const SampleBox& box) { return box.empty(); });
            }
            touched.push_back(std::move(boxes));
        }
        return touched;
    }

    /// Compares stored samples around the edits, in a few chunks of each level.
    CoarseningSeen coarsening_of_original(const std::vector<std::vector<SampleBox>>& touched) {
        const auto* edited = dynamic_cast<const EditedStore*>(&from_);
        const Store& original = edited ? edited->original() : from_;
        const int finest = level_ + (edited ? edited->note().level : 0);
        CoarseningSeen seen;
        for (std::size_t l = 1; l < touched.size(); ++l) {
            const CoarserGrid& grid = levels_[l];
            ChunkSet chunks;
            for (const SampleBox& box : touched[l]) {
                if (chunks.size() == most_examined) break;
                chunks.insert(box.low.cwiseQuotient(piece()));
            }
            for (const Index3& chunk : chunks) {
                const int level = static_cast<int>(l);
                const SampleBox box = image_.box(level, chunk);
                const SampleBox below = finer_box(box, grid.factor, levels_[l - 1].geometry);
                Bytes coarser(bytes_of(box, type())), finer(bytes_of(below, type()));
                original.read(finest + level, box, coarser, stop_);
                original.read(finest + level - 1, below, finer, stop_);
                seen.look(type(), finer, below, grid.factor, box, coarser);
            }
        }
        return seen;
    }

    void write_level(std::size_t level, const std::vector<SampleBox>& changed) {
        std::map<Index3, std::vector<SampleBox>, ByPlace> parts;
        for (const auto& chunk : note_.chunks[level]) parts[chunk];
        for (const SampleBox& box : changed) {
            for_each_piece(piece(), box, [&](const auto& chunk, const SampleBox& part) {
                parts[chunk].push_back(part);
            });
        }
        std::size_t done = 0;
        for (const auto& [chunk, boxes] : parts) {
            const SampleBox box = image_.box(static_cast<int>(level), chunk);
            Bytes samples(bytes_of(box, type()));
            const bool is_new = level == 0 && boxes.size() == 1 && boxes[0] == box;
            if (!is_new) from_.read(level_ + static_cast<int>(level), box, samples, stop_);
            for (const SampleBox& part : boxes) {
                if (level > 0) {
                    renew_above_edits(level, part, box, samples);
                    continue;
                }
                const Bytes now = edited(part);
                copy_box(part, now.data(), box, samples.data(), size_of(type()));
            }
            image_.write(static_cast<int>(level), chunk, samples, true);
            note_.chunks[level].insert(chunk);
            ++done;
            if (level == 0) made_ = double(done) / double(parts.size());
        }
    }

    /// Samples of an edited brick.
    Bytes edited(const SampleBox& box) const {
        Bytes samples(bytes_of(box, type()));
        with_type(type(), [&](auto zero) {
            std::byte* to = samples.data();
            for_each_index(box, [&](const Index3& at) {
                const auto sample = static_cast<decltype(zero)>(edits_.sample(at));
                std::memcpy(to, &sample, sizeof sample);
                to += sizeof sample;
            });
        });
        return samples;
    }

    /// Computes those samples of a part of a chunk again that lie above changed samples of the
    /// finer level, in which all changes are written already.
    void renew_above_edits(std::size_t level, const SampleBox& part, const SampleBox& chunk,
                           std::span<std::byte> samples) const {
        const CoarserGrid& grid = levels_[level];
        const SampleBox wanted = finer_box(part, grid.factor, levels_[level - 1].geometry);
        Bytes before(bytes_of(wanted, type()));
        const int fine = static_cast<int>(level) - 1;
        from_.read(level_ + fine, wanted, before, stop_);
        Bytes now = before;
        for_each_piece(piece(), wanted, [&](const auto& at, const SampleBox& written) {
            if (!note_.chunks[level - 1].contains(at)) return;
            Bytes stored(bytes_of(written, type()));
            written_->read(fine, written, stored, stop_);
            copy_box(written, stored.data(), wanted, now.data(), size_of(type()));
        });
        Bytes renewed(bytes_of(part, type()));
        take_coarser(coarsening_, type(), now, wanted, grid.factor, part, renewed);
        const std::size_t each = size_of(type());
        for_each_index(part, [&](const Index3& at) {
            const SampleBox below = finer_box({at, at}, grid.factor, levels_[level - 1].geometry);
            const bool changed = any_index(below, [&](const Index3& one) {
                const std::size_t place = place_in(wanted, one) * each;
                return std::memcmp(before.data() + place, now.data() + place, each) != 0;
            });
            if (!changed) return;
            std::memcpy(samples.data() + place_in(chunk, at) * each,
                        renewed.data() + place_in(part, at) * each, each);
        });
    }

    SampleType type() const { return from_.info().type; }
    Index3 piece() const { return Index3::Constant(note_.chunk); }

    const Store& from_;
    int level_;
    const Samples& edits_;
    fs::path folder_;
    EditsNote note_;
    std::vector<CoarserGrid> levels_;
    Coarsening coarsening_ = Coarsening::mean;
    GrowingImage image_;
    std::shared_ptr<const Store> written_;
    std::atomic<double>& made_;  // of the finest level
    const std::stop_token stop_;
};

/// Content of the original, which must be the one that was opened.
std::string checked_content(const Store& from, const Opened& opened, int level,
                            const std::stop_token& stop) {
    if (opened.is_rescue) return opened.content;
    std::string content = content_below_edits(from, level, stop);
    if (opened.content.empty() || content == opened.content) return content;
    throw io::OutputError(opened.address +
                          ": was replaced since it was opened, so that these edits do not fit it; "
                          "put it back and save them again");
}

/// The note before anything is written, with the edits that the store itself has.
EditsNote note_for(const Store& from, const Opened& opened, int level, const Samples& edits,
                   const std::stop_token& stop) {
    const auto* edited = dynamic_cast<const EditedStore*>(&from);
    EditsNote note{.of = opened, .level = level, .bounds = {edits.minimum(), edits.maximum()}};
    note.chunks.resize(from.info().levels.size() - static_cast<std::size_t>(level));
    if (opened.is_rescue) {  // nothing of the original, which may be gone, silent or replaced
        note.chunk = Bricks::edge;
        note.chunks.resize(1);
    }
    note.content = checked_content(from, opened, level, stop);
    if (!edited) return note;
    const EditsNote& before = edited->note();
    note.of = before.of;
    note.level += before.level;
    note.guessed = before.guessed;
    note.bounds.minimum = std::min(note.bounds.minimum, before.bounds.minimum);
    note.bounds.maximum = std::max(note.bounds.maximum, before.bounds.maximum);
    for (std::size_t l = 0; l < note.chunks.size(); ++l) {
        const std::size_t at = l + static_cast<std::size_t>(level);
        note.chunks[l] = in_chunks_of(note.chunk, before.chunks[at], before.chunk,
                                      from.info().levels[at].geometry.size);
    }
    return note;
}

/// Edits that save_edits() wrote, and nothing else, may be replaced. A name alone is no proof: the
/// note must be whole, and list every chunk.
void check_replaceable(const fs::path& out) {
    const auto refuse = [&](const std::string& why) {
        throw io::OutputError(out.string() + ": " + why + "; give another name");
    };
    std::error_code error;
    if (!fs::is_directory(fs::symlink_status(out, error)) || !holds_edits(out)) {
        refuse("is there already and is no folder of edits");
    }
    std::string unknown = io::unknown_below(out, io::OwnFolder::image);
    try {
        if (unknown.empty()) unknown = unlisted_chunk(out);
    } catch (const io::InputError& e) {
        refuse("cannot be replaced, since it may not be of Palpate (" + std::string(e.what()) +
               ")");
    }
    if (!unknown.empty()) refuse("holds " + unknown + ", which Palpate did not write");
}

}  // namespace

std::string content_below_edits(const Store& from, int level, const std::stop_token& stop) {
    const auto* edited = dynamic_cast<const EditedStore*>(&from);
    return edited ? content_of(edited->original(), edited->note().level + level, stop)
                  : content_of(from, level, stop);
}

void check_edits_name(const fs::path& out) {
    const fs::path name = io::without_slash(out);
    if (name.extension() == ".zarr" && !name.stem().empty()) return;
    throw std::invalid_argument(out.string() +
                                ": edits of a volume that is read while it is touched are saved as "
                                "a folder: give a name that ends with .zarr");
}

void check_edits_place(const fs::path& out, const Opened& opened) {
    check_edits_name(out);
    std::error_code error;
    if (fs::equivalent(out, opened.address, error)) {
        throw io::OutputError(out.string() + ": is the open volume; save under another name");
    }
    io::check_in_place(out, check_replaceable);
    io::check_parent(out);
}

void save_edits(const Store& from, const Opened& opened, int level, const Samples& edits,
                const fs::path& name, const io::Progress& progress) {
    const fs::path out = io::without_slash(name);
    check_edits_place(out, opened);
    io::GrowingFolder folder = io::GrowingFolder::alone(out);
    while_telling(progress, [&](const std::stop_token& stop, std::atomic<double>& made) {
        Saving saving(from, level, edits, folder.result(),
                      note_for(from, opened, level, edits, stop), made, stop);
        write_note(folder.result(), out, saving.run());
    });
    if (progress) progress(1);
    folder.put_in_place(check_replaceable);
}

}  // namespace palpate::stream
