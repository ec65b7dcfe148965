// Makes samples from their recipes.
#include "palpate/run/recorded_samples.hpp"

#include <stdexcept>
#include <string>

#include "stream/while_telling.hpp"

namespace palpate::run {

std::function<Volume(int)> frames_of(const LoadedVolume& loaded) {
    if (loaded.sequence.count() == 0) return {};
    return [sequence = loaded.sequence](int frame) {
        if (frame < 0 || frame >= sequence.count()) {
            throw std::invalid_argument("a frame that the sequence does not have");
        }
        return io::read_frame(sequence, frame);
    };
}

GridReader grid_of(const LoadedVolume& loaded, std::function<void()> tell) {
    if (!loaded.streamed) return {};
    auto loader = std::make_shared<stream::BrickLoader>(loaded.streamed->store, loaded.volume,
                                                        loaded.streamed->loader);
    return {[loader, tell](const Index3& brick, int level) {
                return stream::while_telling(tell, [&](const std::stop_token& stop) {
                    return loader->read(brick, level, stop);
                });
            },
            [loader, tell](const SampleBox& box, std::span<std::byte> out) {
                stream::while_telling(
                    tell, [&](const std::stop_token& stop) { loader->read(box, out, stop); });
            }};
}

RecordedSamples::RecordedSamples(std::shared_ptr<const Samples> start,
                                 std::function<Volume(int)> frame, GridReader grid)
    : kept_{{0, std::move(start)}}, frame_(std::move(frame)), grid_(std::move(grid)) {
    if (const ResidentBricks* none = kept_.at(0)->resident()) bricks_ = *none;
}

Command RecordedSamples::whole(const Command& recorded) {
    return std::visit(Overloaded{[&](command::Samples samples) -> Command {
                                     if (!samples.samples) samples.samples = made(samples);
                                     return samples;
                                 },
                                 [](const auto& other) -> Command { return other; }},
                      recorded);
}

/// For a large grid: edits together with the samples in memory.
std::shared_ptr<const Samples> RecordedSamples::felt(std::shared_ptr<const Samples> edits) const {
    return bricks_ ? std::make_shared<const Samples>(edits->with(*bricks_)) : edits;
}

std::shared_ptr<const Samples> RecordedSamples::made(const command::Samples& recorded) {
    if (!recorded.recipe) {
        if (auto known = made_again(recorded.version)) {
            edits_version_ = recorded.version;
            return felt(std::move(known));
        }
        throw std::invalid_argument("the samples of version " + std::to_string(recorded.version) +
                                    " came from outside and are not in the recording");
    }
    return std::visit(
        Overloaded{[&](const FramesOf& frames) { return frames_of(frames); },
                   [&](const BricksOf& bricks) { return bricks_of(bricks, recorded.version); },
                   [&](const EditOf& edit) {
                       auto edits = edit_of(edit, recorded.version);
                       edits_version_ = recorded.version;
                       return felt(std::move(edits));
                   }},
        *recorded.recipe);
}

std::shared_ptr<const Samples> RecordedSamples::bricks_of(const BricksOf& bricks,
                                                          std::uint64_t version) {
    if (!bricks_ || !grid_.brick) {
        throw std::invalid_argument("bricks of a large grid, which the volume is not");
    }
    if (bricks.version != bricks_version_) {
        throw std::invalid_argument("bricks after version " + std::to_string(bricks.version) +
                                    ", but the last was " + std::to_string(bricks_version_));
    }
    std::vector<ResidentBricks::Change> changes;
    for (const BricksOf::Change& brick : bricks.bricks) {
        const Index3& count = bricks_->count();
        if ((brick.at.array() < 0).any() || (brick.at.array() >= count.array()).any()) {
            throw std::invalid_argument("a brick outside the grid");
        }
        changes.push_back(
            {brick.at, brick.level < 0 ? Brick{} : grid_.brick(brick.at, brick.level)});
    }
    bricks_ = bricks_->with(changes);
    bricks_version_ = version;
    edits_at_[version] = edits_version_;
    return felt(made_again(edits_version_));
}

std::shared_ptr<const Samples> RecordedSamples::edit_of(const EditOf& edit, std::uint64_t version) {
    const auto before = made_again(edit.version);
    if (!before) {
        throw std::invalid_argument("an edit of samples of version " +
                                    std::to_string(edit.version) +
                                    ", which are not in the recording");
    }
    if (version == 0 || versions_.contains(version)) {
        throw std::invalid_argument("the samples of version " + std::to_string(version) +
                                    " came about twice");
    }
    auto samples = edited(before, edit.edit, grid_.box).samples;
    const auto parent = versions_.find(edit.version);
    versions_[version] = {edit, parent == versions_.end() ? 1 : parent->second.edits + 1};
    remember(version, samples);
    return samples;
}

std::shared_ptr<const Samples> RecordedSamples::find(std::uint64_t version) const {
    const auto kept = kept_.find(version);
    if (kept != kept_.end()) return kept->second;
    for (const auto& [number, samples] : recent_) {
        if (number == version) return samples;
    }
    return nullptr;
}

void RecordedSamples::remember(std::uint64_t version,
                               const std::shared_ptr<const Samples>& samples) {
    constexpr int edits_between_kept = 16;
    constexpr std::size_t most_recent = 16;
    if (versions_.at(version).edits % edits_between_kept == 0) {
        kept_[version] = samples;
        return;
    }
    recent_.emplace_back(version, samples);
    if (recent_.size() > most_recent) recent_.pop_front();
}

/// From the nearest version before it that is in memory; null if it never was.
std::shared_ptr<const Samples> RecordedSamples::made_again(std::uint64_t version) {
    std::vector<std::uint64_t> missing;
    std::shared_ptr<const Samples> samples = find(version);
    while (!samples) {
        const auto known = versions_.find(version);
        if (known == versions_.end()) return nullptr;
        missing.push_back(version);
        version = known->second.made.version;
        samples = find(version);
    }
    for (std::size_t i = missing.size(); i-- > 0;) {
        samples = edited(samples, versions_.at(missing[i]).made.edit, grid_.box).samples;
        remember(missing[i], samples);
    }
    return samples;
}

std::shared_ptr<const Samples> RecordedSamples::frames_of(const FramesOf& frames) {
    if (!frame_) throw std::invalid_argument("frames of a sequence, which the volume is not");
    std::map<int, Volume> held;
    std::vector<Frame> window;
    for (std::size_t i = 0; i < frames.numbers.size(); ++i) {
        const int number = frames.numbers[i];
        auto at = held.find(number);
        if (at == held.end()) {
            const auto before = read_.find(number);
            at =
                held.emplace(number, before != read_.end() ? before->second : frame_(number)).first;
        }
        window.push_back({frames.times[i], at->second, number});
    }
    read_ = std::move(held);
    frames_ = std::make_shared<const Samples>(std::move(window), frames.period);
    return frames_;
}

std::shared_ptr<const Samples> RecordedSamples::of(std::uint64_t version) {
    if (frames_) return frames_;
    const auto edits = edits_at_.find(version);
    const auto samples = made_again(edits == edits_at_.end() ? version : edits->second);
    return samples ? samples : kept_.at(0);
}

}  // namespace palpate::run
