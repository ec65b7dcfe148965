// Samples by their recipes.
#include "apps/live/recorded_samples.hpp"

#include <stdexcept>
#include <string>

namespace palpate::app {

std::function<Volume(int)> frames_of(const LoadedVolume& loaded) {
    if (loaded.sequence.count() == 0) return {};
    return [sequence = loaded.sequence](int frame) {
        if (frame < 0 || frame >= sequence.count()) {
            throw std::invalid_argument("a frame that the sequence does not have");
        }
        return io::read_frame(sequence, frame);
    };
}

RecordedSamples::RecordedSamples(std::shared_ptr<const Samples> start,
                                 std::function<Volume(int)> frame)
    : versions_{{0, std::move(start)}}, frame_(std::move(frame)) {}

Command RecordedSamples::whole(const Command& recorded) {
    const auto* samples = std::get_if<command::Samples>(&recorded);
    if (!samples || samples->samples) return recorded;
    command::Samples whole = *samples;
    whole.samples = made(*samples);
    return whole;
}

std::shared_ptr<const Samples> RecordedSamples::made(const command::Samples& recorded) {
    if (!recorded.recipe) {
        const auto known = versions_.find(recorded.version);
        if (known != versions_.end()) return known->second;
        throw std::invalid_argument("the samples of version " + std::to_string(recorded.version) +
                                    " came from outside and are not in the recording");
    }
    if (const auto* frames = std::get_if<FramesOf>(recorded.recipe.get())) {
        return frames_of(*frames);
    }
    const auto& edit = std::get<EditOf>(*recorded.recipe);
    const auto before = versions_.find(edit.version);
    if (before == versions_.end()) {
        throw std::invalid_argument("an edit of samples of version " +
                                    std::to_string(edit.version) +
                                    ", which are not in the recording");
    }
    return versions_[recorded.version] = edited(before->second, edit.edit).samples;
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

std::shared_ptr<const Samples> RecordedSamples::of(std::uint64_t version) const {
    const auto known = versions_.find(version);
    if (frames_ || known == versions_.end()) return frames_ ? frames_ : versions_.at(0);
    return known->second;
}

}  // namespace palpate::app
