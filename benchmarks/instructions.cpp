// A driver for instructions.sh: runs a number of updates of one case and prints a hash of where the
// proxy was. Counted with two numbers of updates, the difference is the cost of the updates alone.
#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "benchmarks/hand.hpp"
#include "benchmarks/tool_hand.hpp"
#include "palpate/baselines/methods.hpp"
#include "palpate/layers.hpp"

using namespace palpate;
using namespace palpate::benchmarks;

namespace {

/// How layers are given: all by level, all by label, or the innermost by label.
enum class By { level, label, both };

struct Case {
    const char* name;
    const char* method;
    Touch (*touch)();
    int layers = 0;  ///< of which the middle one is touched
    By by = By::level;
    bool looks = false;  ///< whether all samples within reach are in memory, before each update
};

template <SampleType type, int tenths_voxel_per_mm, int depth>
Touch cylinder() {
    return cylinder_touch(type, 0.1 * tenths_voxel_per_mm, depth);
}

/// The cost of the loop around the updates, which is subtracted from the other cases.
ProxyUpdate no_update(Proxy&, const Field&, const Vec3& hip, const ProxySettings&, StepObserver) {
    return {.scp = hip};
}

constexpr Case cases[] = {
    {"nothing", "nothing", cylinder<SampleType::uint8, 5, 1>},
    {"contact/uint8/0.5", "exact", cylinder<SampleType::uint8, 5, 1>},
    {"contact/uint8/3", "exact", cylinder<SampleType::uint8, 30, 1>},
    {"contact/float32/0.5", "exact", cylinder<SampleType::float32, 5, 1>},
    {"contact/float32/3", "exact", cylinder<SampleType::float32, 30, 1>},
    {"free/uint8/0.5", "exact", cylinder<SampleType::uint8, 5, -3>},
    {"free/uint8/3", "exact", cylinder<SampleType::uint8, 30, -3>},
    {"free/float32/0.5", "exact", cylinder<SampleType::float32, 5, -3>},
    {"free/float32/3", "exact", cylinder<SampleType::float32, 30, -3>},
    {"edited/uint8/3", "exact", [] { return all_in_bricks(cylinder<SampleType::uint8, 30, 1>()); }},
    {"resident/uint8/3", "exact", [] { return all_resident(cylinder<SampleType::uint8, 30, 1>()); },
     0, By::level, true},
    {"resident/smooth/contact/uint8/3", "exact",
     [] { return all_resident(smooth(cylinder<SampleType::uint8, 30, 1>())); }, 0, By::level, true},
    {"between/uint8/3", "exact",
     [] { return between_frames(cylinder<SampleType::uint8, 30, 1>()); }},
    {"noise/float32/3", "exact", [] { return noise_touch(SampleType::float32, 3); }},
    {"smooth/contact/uint8/0.5", "exact",
     [] { return smooth(cylinder<SampleType::uint8, 5, 1>()); }},
    {"smooth/contact/uint8/3", "exact",
     [] { return smooth(cylinder<SampleType::uint8, 30, 1>()); }},
    {"smooth/contact/float32/3", "exact",
     [] { return smooth(cylinder<SampleType::float32, 30, 1>()); }},
    {"smooth/free/uint8/3", "exact", [] { return smooth(cylinder<SampleType::uint8, 30, -3>()); }},
    {"smooth/noise/float32/3", "exact", [] { return smooth(noise_touch(SampleType::float32, 3)); }},
    {"layers/1/smooth/contact/uint8/3", "exact",
     [] { return smooth(cylinder<SampleType::uint8, 30, 1>()); }, 1},
    {"layers/5/smooth/contact/uint8/3", "exact",
     [] { return smooth(cylinder<SampleType::uint8, 30, 1>()); }, 5},
    {"labels/5/smooth/contact/uint8/3", "exact",
     [] { return smooth(cylinder<SampleType::uint8, 30, 1>()); }, 5, By::label},
    {"both/5/smooth/contact/uint8/3", "exact",
     [] { return smooth(cylinder<SampleType::uint8, 30, 1>()); }, 5, By::both},
    {"layers/1/contact/uint8/3", "exact", cylinder<SampleType::uint8, 30, 1>, 1},
    {"layers/5/contact/uint8/3", "exact", cylinder<SampleType::uint8, 30, 1>, 5},
    {"labels/5/contact/uint8/3", "exact", cylinder<SampleType::uint8, 30, 1>, 5, By::label},
    {"both/5/contact/uint8/3", "exact", cylinder<SampleType::uint8, 30, 1>, 5, By::both},
    {"paper/uint8/0.5", "paper", cylinder<SampleType::uint8, 5, 1>},
    {"gradient/uint8/0.5", "gradient", cylinder<SampleType::uint8, 5, 1>},
    {"gradient-improved/uint8/0.5", "gradient-improved", cylinder<SampleType::uint8, 5, 1>},
};

/// FNV-1a over the bits of a point.
void mix(std::uint64_t& hash, const Vec3& point) {
    for (int a = 0; a < 3; ++a) {
        hash = (hash ^ std::bit_cast<std::uint64_t>(point[a])) * 0x100000001b3U;
    }
}

/// Levels a tenth of the range apart, or the bodies that they bound as labels.
Layers layers_round(const Touch& touch, int count, By by) {
    Layers layers;
    layers.by_label = by != By::level;
    if (by == By::both) layers.levels_beside_labels = static_cast<std::size_t>(count - 1);
    const auto level = [&](int i) {
        return touch.isovalue + (i - count / 2) * 0.1 * touch.field.range();
    };
    for (int i = 0; i < count; ++i) {
        const bool label = is_label(layers, static_cast<std::size_t>(i));
        layers.layers.push_back({.name = std::to_string(i), .level = label ? i + 1 : level(i)});
        if (label) layers.layers.back()[HapticProperty::puncture_force] = 1e9;
    }
    if (by == By::level) return layers;
    const Volume& volume = touch.field.volume();
    std::vector<std::uint8_t> labels(static_cast<std::size_t>(sample_count(volume.geometry())));
    with_type(volume.type(), [&](auto zero) {
        const auto* samples = static_cast<const decltype(zero)*>(volume.data());
        for (std::size_t s = 0; s < labels.size(); ++s) {
            while (labels[s] < count && samples[s] > level(labels[s])) ++labels[s];
        }
    });
    layers.labels = numbered_labels(Volume(volume.geometry(), std::move(labels)), layers.layers,
                                    layers.levels_beside_labels);
    return layers;
}

/// The same updates through a tick of layers.
void run_layers(const Case& chosen, const Touch& touch, Proxy proxy, long updates) {
    const auto layers =
        std::make_shared<const Layers>(layers_round(touch, chosen.layers, chosen.by));
    LayerState state;
    LayerInput input;
    input.method = baselines::method_named(chosen.method);
    // By labels a hand starts in the layer that it is in, which here has to be the one outside of
    // the middle one, and not where recovery finds the nearest way out of all of them.
    if (chosen.by != By::level) {
        input.hip = proxy.scp_physical + normal_at(proxy, touch.field);
        update_layers(layers, state, proxy, touch.field, input);
    }
    HandMotion hand(touch.path);
    std::uint64_t hash = 0xcbf29ce484222325U;
    for (long i = 0; i < updates; ++i) {
        input.hip = hand.next();
        input.time += 0.001;
        mix(hash, update_layers(layers, state, proxy, touch.field, input).proxy.scp);
    }
    std::printf("%-28s %ld updates, hash of the SCPs %016llx\n", chosen.name, updates,
                static_cast<unsigned long long>(hash));
}

void run(const Case& chosen, long updates) {
    Touch touch = chosen.touch();
    const bool idle = std::strcmp(chosen.method, "nothing") == 0;
    const ProxyMethod method = idle ? no_update : baselines::method_named(chosen.method);
    Proxy proxy;
    proxy.isovalue = touch.isovalue;
    place(proxy, touch.field, touch.path.front(), touch.isovalue);
    if (chosen.layers > 0) return run_layers(chosen, touch, proxy, updates);
    HandMotion hand(touch.path);
    std::uint64_t hash = 0xcbf29ce484222325U;
    for (long i = 0; i < updates; ++i) {
        const Vec3& hip = hand.next();
        if (chosen.looks && !is_resident(touch.field, hip, (hip - proxy.scp_physical).norm())) {
            std::abort();
        }
        mix(hash, method(proxy, touch.field, hip, {}, {}).scp);
    }
    std::printf("%-28s %ld updates, hash of the SCPs %016llx\n", chosen.name, updates,
                static_cast<unsigned long long>(hash));
}

void run_tool(const ToolCase& chosen, long updates) {
    const ToolTouch touch = chosen.touch(1000);
    ToolProxy proxy(touch.tool);
    proxy.isovalue = touch.isovalue;
    std::uint64_t hash = 0xcbf29ce484222325U;
    long rounds = 0, contacts = 0, work = 0, unfinished = 0;
    const long count = static_cast<long>(touch.path.size());
    for (long i = 0; i < updates; ++i) {
        const long at = i / count % 2 == 0 ? i % count : count - 1 - i % count;
        const ToolUpdate update =
            update_tool(proxy, touch.field, touch.path[static_cast<std::size_t>(at)]);
        mix(hash, update.proxy.position);
        mix(hash, update.proxy.orientation.vec());
        rounds += update.rounds;
        contacts += update.contacts;
        work += update.work;
        unfinished += update.status != UpdateStatus::done;
    }
    const auto mean = [&](long sum) { return double(sum) / double(updates); };
    std::printf(
        "%-28s %ld updates, hash of the poses %016llx; %.2f rounds, %.2f contacts, %.1f "
        "cubes, %ld not finished\n",
        chosen.name, updates, static_cast<unsigned long long>(hash), mean(rounds), mean(contacts),
        mean(work), unfinished);
}

}  // namespace

/// Without arguments: every case once. With `--list`: their names. Else CASE UPDATES.
int main(int argc, char** argv) {
    if (argc == 2 && std::strcmp(argv[1], "--list") == 0) {
        for (const Case& c : cases) std::puts(c.name);
        for (const ToolCase& c : tool_cases()) std::puts(c.name);
        return 0;
    }
    if (argc == 3) {
        for (const Case& c : cases) {
            if (std::strcmp(c.name, argv[1]) != 0) continue;
            run(c, std::atol(argv[2]));
            return 0;
        }
        for (const ToolCase& c : tool_cases()) {
            if (std::strcmp(c.name, argv[1]) != 0) continue;
            run_tool(c, std::atol(argv[2]));
            return 0;
        }
        std::fprintf(stderr, "no case '%s'; --list names them\n", argv[1]);
        return 2;
    }
    for (const Case& c : cases) run(c, 100000);
    for (const ToolCase& c : tool_cases()) run_tool(c, 10000);
    return 0;
}
