// Random runs with layers of every kind, on every field, over samples of every kind. The SCP is
// never in a forbidden place, by a slow evaluation of the field of its own, and only punctures open
// surfaces.
#include <gtest/gtest.h>

#include "palpate/session.hpp"
#include "support/constants.hpp"
#include "support/edits.hpp"
#include "support/hand.hpp"
#include "support/labelled.hpp"
#include "support/layer.hpp"
#include "support/parameter.hpp"
#include "support/press.hpp"
#include "support/resident.hpp"
#include "support/scripted_device.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

enum class Kind { levels, labels, both };
/// Kinds of samples: as they were read, edited now and then, at moments between frames, or bricks
/// of a large grid that come and go.
enum class Data { plain, edited, moments, resident };

struct Life {
    Interpolation interpolation;
    Kind kind;
    Data data;
    Solid solid;
};

Layers layers_for(const Life& life, Random& random) {
    Layers layers;
    const int levels = life.kind == Kind::labels ? 0 : 3;
    const int labels = life.kind == Kind::levels ? 0 : 3;
    for (int i = 0; i < levels; ++i) {
        const double part = 0.3 + 0.2 * i;
        const double level = 256 * (life.solid == Solid::above ? part : 1 - part);
        layers.layers.push_back(layer_of("level " + std::to_string(i), level,
                                         random.uniform(0.3, 1), i == 2 ? infinity : 0.3));
    }
    for (int i = 1; i <= labels; ++i) {
        layers.layers.push_back(layer_of("label " + std::to_string(i), i, random.uniform(0.3, 1),
                                         i == 3 ? infinity : 0.25));
    }
    if (labels > 0) {
        layers.by_label = true;
        layers.levels_beside_labels = std::size_t(levels);
        layers.labels = numbered_labels(
            // No sample of the data lies half-way between two labels.
            random_labels(9, 3, grid(cube(16), Vec3::Constant(1.5), {-1, 0.5, 0.2})), layers.layers,
            layers.levels_beside_labels);
    }
    return layers;
}

/// The samples, and their changes.
class Source {
  public:
    Source(Data kind, std::uint64_t seed)
        : kind_(kind),
          random_(seed),
          volume_(noise_volume<std::uint8_t>(
              grid(kind == Data::resident ? Index3(72, 24, 24) : cube(24)), seed, 0, 256)),
          part_(volume_) {
        samples_ = std::make_shared<const Samples>(volume_);
        const auto frame = [&] { return noise_of(SampleType::uint8, volume_.geometry(), ++seed); };
        if (kind == Data::moments) {
            samples_ = std::make_shared<const Samples>(
                std::vector<Frame>{{0, volume_}, {1, frame()}, {2, frame()}});
        }
        part_.add_all();
        if (kind == Data::resident) samples_ = part_.samples();
    }
    const std::shared_ptr<const Samples>& samples() const { return samples_; }
    /// True if it changed.
    bool change(Session& session) {
        if (kind_ == Data::plain || !random_.chance(0.02)) return false;
        if (kind_ == Data::moments) {
            apply(session, command::Moment{random_.uniform(0, 2)});
            return true;
        }
        if (kind_ == Data::resident) {
            part_.change(random_, 0.5);
            samples_ = part_.samples();
        } else {
            samples_ = edited(samples_, random_edit(random_, volume_.geometry(), SampleType::uint8))
                           .samples;
        }
        apply(session, command::Samples{samples_});
        return true;
    }

  private:
    Data kind_;
    Random random_;
    Volume volume_;
    PartOf part_;
    std::shared_ptr<const Samples> samples_;
};

struct Tally {
    int touched = 0, punctured = 0, inside = 0, judged = 0;
};

void live(const Life& life, std::uint64_t seed, Tally& tally) {
    Random random(seed);
    const Layers layers = layers_for(life, random);
    Source source(life.data, seed);
    RendererSettings settings = at_once();
    settings.layers = std::make_shared<const Layers>(layers);
    const Field data(source.samples(), life.solid, life.solid == Solid::above ? 0 : 255,
                     life.interpolation);
    Session session{make_renderer(data, layers.layers[0].level, settings),
                    {.fastest_hand = infinity}};
    const Renderer& renderer = session.renderer;
    Hand hand(grid(cube(24)), seed);
    bool settled = false;  // no samples have changed since the proxy was where it belongs
    for (int i = 0; i < scaled(3000); ++i) {
        SCOPED_TRACE("seed " + std::to_string(seed) + ", tick " + std::to_string(i));
        const LayerState before = renderer.layers;
        if (source.change(session)) settled = false;
        const Tick tick = advance(session, (i + 1) * 0.001, ready_at(hand.next())).tick;
        const UpdateStatus status = tick.proxy.status;
        if (status == UpdateStatus::waiting) {
            ASSERT_EQ(life.data, Data::resident);
            settled = false;
        }
        if (settled) {
            ASSERT_EQ(status, UpdateStatus::done);
        }
        if (status != UpdateStatus::done) continue;
        const LayerState& state = renderer.layers;
        const TouchedField now{renderer.field, layers, state};
        ASSERT_LE(now.beyond(tick.proxy.scp), 1e-9);
        if (settled && tick.layers.punctured == 0) {
            const TouchedField was{renderer.field, layers, before};
            ASSERT_LE(was.beyond(tick.proxy.scp), 1e-9);
            ASSERT_EQ(state.open & ~before.open, 0U);
            if (before.open & state.open & 1U) {
                ASSERT_LE(state.inner, before.inner);
                ASSERT_GE(state.outer, before.outer);
            }
        }
        tally.judged += settled;
        tally.touched += tick.layers.touched >= 0;
        tally.punctured += tick.layers.punctured;
        tally.inside += tick.layers.inside > 0;
        settled = true;
    }
}

class LayerLives : public testing::TestWithParam<Life> {};

TEST_P(LayerLives, stay_in_what_is_open_and_open_nothing_without_a_puncture) {
    Tally tally;
    for (std::uint64_t seed = 1; seed <= 2 && !HasFatalFailure(); ++seed) {
        live(GetParam(), seed, tally);
    }
    if (HasFatalFailure()) return;
    // Hands wait for bricks more often than they touch.
    const int few = GetParam().data == Data::resident ? 8 : 1;
    EXPECT_GT(tally.judged, scaled(1500) / few);
    EXPECT_GT(tally.touched, scaled(1000) / few);
    EXPECT_GT(tally.punctured, scaled(30) / few);
    EXPECT_GT(tally.inside, scaled(200) / few);
}

std::vector<Life> lives() {
    std::vector<Life> all;
    int n = 0;
    for (const auto interpolation : {Interpolation::linear, Interpolation::cubic}) {
        for (const Kind kind : {Kind::levels, Kind::labels, Kind::both}) {
            for (const Data data : {Data::plain, Data::edited, Data::moments, Data::resident}) {
                all.push_back({interpolation, kind, data, n++ % 2 ? Solid::below : Solid::above});
            }
        }
    }
    return all;
}

std::ostream& operator<<(std::ostream& out, const Life& life) {
    const std::array<const char*, 3> kinds{"levels", "labels", "both"};
    const std::array<const char*, 4> data{"plain", "edited", "moments", "resident"};
    return out << name_of(life.interpolation) << "_" << kinds[std::size_t(life.kind)] << "_"
               << data[std::size_t(life.data)];
}

INSTANTIATE_TEST_SUITE_P(Kinds, LayerLives, testing::ValuesIn(lives()),
                         testing::PrintToStringParamName());

}  // namespace
