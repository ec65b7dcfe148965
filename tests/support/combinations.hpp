// Every combination of field, surfaces, tool and samples, each with a hand on a closed path, for
// the tests of energy and of the guarantees.
#pragma once

#include <memory>
#include <numbers>
#include <ostream>
#include <string>
#include <vector>

#include "palpate/session.hpp"
#include "support/constants.hpp"
#include "support/edits.hpp"
#include "support/labelled.hpp"
#include "support/layer.hpp"
#include "support/press.hpp"
#include "support/resident.hpp"
#include "support/scripted_device.hpp"

namespace palpate::support::combinations {

/// `curves`: the level, with a stiffness that varies along it, and penetrability that never presses
/// through.
enum class Surfaces { level, levels, labels, both, curves };
enum class Touching { point, rod, box };
enum class Data { plain, edited, between_frames, resident };

struct Combination {
    Interpolation field;
    Surfaces surfaces;
    Touching tool;
    Data data;
};

inline std::vector<Combination> all_combinations() {
    std::vector<Combination> all;
    for (const Data data : {Data::plain, Data::edited, Data::between_frames, Data::resident}) {
        for (const auto field : {Interpolation::linear, Interpolation::cubic}) {
            for (const Surfaces surfaces : {Surfaces::level, Surfaces::levels, Surfaces::labels,
                                            Surfaces::both, Surfaces::curves}) {
                all.push_back({field, surfaces, Touching::point, data});
            }
        }
        for (const Touching tool : {Touching::rod, Touching::box}) {
            all.push_back({Interpolation::cubic, Surfaces::level, tool, data});
        }
    }
    return all;
}

inline std::ostream& operator<<(std::ostream& out, const Combination& of) {
    const std::array<const char*, 5> surfaces{"level", "levels", "labels", "both", "curves"};
    const std::array<const char*, 3> tools{"point", "rod", "box"};
    const std::array<const char*, 4> data{"plain", "edited", "between_frames", "resident"};
    return out << name_of(of.field) << '_' << surfaces[std::size_t(of.surfaces)] << '_'
               << tools[std::size_t(of.tool)] << '_' << data[std::size_t(of.data)];
}

/// In noise a body has room above a higher level only.
inline double level_of(Touching tool) {
    return tool == Touching::point ? 128.5 : 165.5;
}

/// Samples of two bricks of a large grid, the border between which lies at x = 64.
inline const Index3 source_size(80, 24, 24);
inline const Vec3 source_middle(64, 12, 12);

/// The samples of a combination; of resident ones, bricks come and go.
class Source {
  public:
    Source(Data data, std::uint64_t seed)
        : random_(seed),
          volume_(noise_volume<std::uint8_t>(grid(source_size), seed, 0, 256)),
          part_(volume_) {
        samples_ = std::make_shared<const Samples>(volume_);
        if (data == Data::between_frames) {
            samples_ = std::make_shared<const Samples>(std::vector<Frame>{
                {0, volume_},
                {1, noise_volume<std::uint8_t>(grid(source_size), seed + 1, 0, 256)}});
        }
        for (int i = 0; data == Data::edited && i < 8; ++i) {
            samples_ = edited(samples_, random_edit(random_, grid(source_size), SampleType::uint8))
                           .samples;
        }
        part_.add_all();
        if (data == Data::resident) samples_ = part_.samples();
    }
    const std::shared_ptr<const Samples>& samples() const { return samples_; }
    void come_and_go(Session& session) {
        if (!samples_->resident() || !random_.chance(0.003)) return;
        part_.change(random_, 0.2);
        samples_ = part_.samples();
        apply(session, command::Samples{samples_});
    }

  private:
    Random random_;
    Volume volume_;
    PartOf part_;
    std::shared_ptr<const Samples> samples_;
};

inline std::shared_ptr<const Layers> layers_of(Surfaces surfaces) {
    auto layers = std::make_shared<Layers>();
    if (surfaces == Surfaces::curves) {
        (*layers)[HapticProperty::stiffness].gradient.knots = {{0, 0.1}, {150, 1.5}};
        return layers;
    }
    const int levels = surfaces == Surfaces::labels ? 0 : 3;
    for (int i = 0; i < levels; ++i) {
        layers->layers.push_back(layer_of("level " + std::to_string(i), 100.5 + 25 * i,
                                          0.4 + 0.5 * i, i == 2 ? infinity : 0.5));
    }
    if (surfaces == Surfaces::levels) return layers;
    for (int i = 1; i <= 3; ++i) {
        layers->layers.push_back(
            layer_of("label " + std::to_string(i), i, 0.4 * i, i == 3 ? infinity : 0.4));
    }
    layers->by_label = true;
    layers->levels_beside_labels = std::size_t(levels);
    const Geometry geometry = grid({54, 16, 16}, Vec3::Constant(1.5), {-0.5, 0.5, 0.2});
    layers->labels = numbered_labels(random_labels(9, 3, geometry), layers->layers,
                                     layers->levels_beside_labels);
    return layers;
}

inline RendererSettings settings_for(const Combination& of) {
    RendererSettings settings = at_once();
    settings.force.limit = settings.device.maximum_force = 1e6;
    settings.device.physical_damping = 1;
    settings.device.maximum_torque = 1e6;
    settings.device.physical_rotational_damping = 1e3;
    settings.force.torque_rate_limit = infinity;
    if (of.surfaces != Surfaces::level) settings.layers = layers_of(of.surfaces);
    if (of.surfaces == Surfaces::curves) {
        settings.penetrability = penetrability_threshold(infinity, level_of(of.tool), Solid::above);
    }
    if (of.tool == Touching::rod) settings.tool = std::make_shared<const Tool>(rod_tool(3, 1));
    if (of.tool == Touching::box) {
        settings.tool = std::make_shared<const Tool>(box_tool({2, 2, 1}, 1));
    }
    return settings;
}

/// The level of a combination without layers, as a set of one.
inline Layers level_alone(Touching tool) {
    Layers layers;
    layers.layers.push_back(layer_of("level", level_of(tool), 1, infinity));
    return layers;
}
/// What the proxy touches. `of_level`: without layers.
inline TouchedField touched_by(const Renderer& renderer, const Layers& of_level) {
    const std::shared_ptr<const Layers>& layers = renderer.settings.layers;
    return {renderer.field, have_surfaces(layers) ? *layers : of_level, renderer.layers};
}

inline Session session_on(const Source& source, const Combination& of,
                          const RendererSettings& settings) {
    Field field(source.samples(), Solid::above, 0, of.field);
    field.set_time(0.4);
    return {make_renderer(field, level_of(of.tool), settings), {.fastest_hand = infinity}};
}

/// A closed path, of which the turn is closed as well.
struct Loop {
    Vec3 centre;
    std::array<Vec3, 4> sines, cosines, turns;

    Loop(Random& random, const Vec3& at) : centre(at) {
        for (int i = 0; i < 4; ++i) {
            sines[i] = 3.0 / (1 + i) * random.uniform(0, 1) * random.direction();
            cosines[i] = 3.0 / (1 + i) * random.uniform(0, 1) * random.direction();
            turns[i] = 0.6 / (1 + i) * random.uniform(0, 1) * random.direction();
        }
    }
    DeviceReading at(double part) const {
        DeviceReading reading = ready_at(centre);
        Vec3 turn = Vec3::Zero();
        for (int i = 0; i < 4; ++i) {
            const double phase = 2 * std::numbers::pi * (i + 1) * part;
            reading.position += std::sin(phase) * sines[i] + (std::cos(phase) - 1) * cosines[i];
            turn += std::sin(phase) * turns[i];
        }
        reading.orientation = turned(Quaternion::Identity(), turn).toRotationMatrix();
        return reading;
    }
};

}  // namespace palpate::support::combinations
