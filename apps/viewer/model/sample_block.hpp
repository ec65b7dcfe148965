// Copies of a field's samples, edits and moment included: a box of them in one array, whose cost
// does not depend on the volume, and a coarse version of all of them.
#pragma once

#include <optional>
#include <vector>

#include "palpate/field.hpp"

namespace palpate::viewer {

/// Samples [data units] at `low` + (0, 0, 0) to `size` - 1, x fastest, at the field's moment and
/// with its edits. Outside the grid they are background.
std::vector<float> sample_block(const Field& field, const Index3& low, const Index3& size);

/// True if both are the same samples at the same moment.
bool same_samples(const Field& a, const Field& b);
/// The samples that differ between two versions on one grid, or a few more: whole bricks, or all
/// where more than edits has changed.
SampleBox changed_between(const Field& a, const Field& b);
/// The same for samples of one grid of which only edits differ.
SampleBox edited_between(const Samples& a, const Samples& b);
/// How many samples along each axis are left of `size` if there is one for each `every`.
inline Index3 coarse_size(const Index3& size, int every) {
    return (size.array() - 1) / every + 1;
}

/// The coarse samples that depend on these of the full grid.
SampleBox coarse_part(const SampleBox& box, const Index3& size, int every);

/// A sample for each `every`-th of the grid along each axis, in the same place, from those round
/// it, up to half as far as the next one: their mean and, by `extreme`, 0 to 1, the most solid of
/// them. At the field's moment, edits included. Reads all samples.
Volume coarse_volume(const Field& field, int every, double extreme);

/// Coarse volumes of the versions of a field, half mean and half extreme.
class CoarseSamples {
  public:
    explicit CoarseSamples(int every) : every_(every) {}

    /// These samples of the full grid are other ones.
    void mark(const SampleBox& changed) { changed_ = united(changed_, changed); }
    /// Of this version, made from the last one where samples have not been marked.
    Field of(const Field& field);
    std::int64_t samples() const { return volume_ ? sample_count(volume_->geometry()) : 0; }

  private:
    int every_;
    std::optional<Volume> volume_;
    SampleBox changed_;
};

}  // namespace palpate::viewer
