// Resident bricks: what is in memory reads as the same samples in one piece, versions share bricks.
#include "palpate/samples.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <functional>
#include <map>

#include "palpate/edit.hpp"
#include "palpate/field.hpp"
#include "palpate/renderer.hpp"
#include "support/constants.hpp"
#include "support/edits.hpp"
#include "support/resident.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

/// More than a brick along some axes, none along others.
std::vector<Geometry> large_grids() {
    return {grid({1, 1, 1}), grid({64, 65, 3}), grid({130, 40, 66}, {0.5, 1, 2}, {-3, 8, 1}),
            grid({63, 129, 2}, {1, 1, 1}, {5, 5, 5}, oblique_direction())};
}

TEST(Resident, a_field_of_all_bricks_is_the_field_of_the_same_samples_in_one_piece) {
    Random random(3);
    std::int64_t inner = 0;
    for (const SampleType type : sample_types) {
        for (const Geometry& geometry : large_grids()) {
            const Volume volume = noise_of(type, geometry, 7);
            PartOf part(volume);
            part.add_all();
            const Field bricks = linear_field(part.samples(), Solid::above, -7.25);
            const Field plain = linear_field(volume, Solid::above, -7.25);
            for (int i = 0; i < scaled(3000) + 10; ++i) {
                const Index3 at(random.below(geometry.size[0] + 4) - 2,
                                random.below(geometry.size[1] + 4) - 2,
                                random.below(geometry.size[2] + 4) - 2);
                ASSERT_EQ(bricks.cell(at), plain.cell(at)) << at.transpose();
                ASSERT_EQ(bricks.around(at), plain.around(at)) << at.transpose();
                inner += !plain.is_background_around(at);
            }
        }
    }
    EXPECT_GT(inner, 1000);
}

TEST(Resident, data_far_from_zero_are_read_with_their_offset) {
    const Geometry geometry = grid({70, 5, 5});
    const Volume volume = noise_volume<float>(geometry, 5, 1e9, 1e9 + 100);
    PartOf part(volume);
    part.add_all();
    const Field bricks = linear_field(part.samples()), plain(volume);
    ASSERT_NE(plain.offset(), 0);
    for_each_sample(geometry, [&](const Index3& at) {
        ASSERT_EQ(bricks.cell(at), plain.cell(at));
        ASSERT_EQ(bricks.around(at), plain.around(at));
    });
}

TEST(Resident, samples_that_are_missing_are_solid_on_either_side) {
    const Geometry geometry = grid({130, 66, 66});
    const Volume volume = noise_of(SampleType::uint8, geometry, 11);
    PartOf part(volume);
    part.add({0, 0, 0});
    for (const Solid solid : {Solid::above, Solid::below}) {
        const Field field = linear_field(part.samples(), solid);
        const double most = solid == Solid::above ? volume.maximum() : volume.minimum();
        for (const double sample : field.cell({64, 5, 5})) EXPECT_EQ(sample, most);
        const Field plain = linear_field(volume, solid);
        for (const int x : {63, 64}) {
            const Neighbours here = field.around({x, 5, 5}), whole = plain.around({x, 5, 5});
            for (int i = 0; i < 27; ++i) {
                const auto at = std::size_t(i);
                EXPECT_EQ(here[at], x - 1 + i % 3 < 64 ? whole[at] : most);
            }
        }
        EXPECT_EQ(field.cell({62, 5, 5}), plain.cell({62, 5, 5}));
        EXPECT_EQ(field.around({62, 5, 5}), plain.around({62, 5, 5}));
    }
}

/// The same grid for each level, with other samples. Bricks arrive at any of the levels.
struct Levels {
    std::vector<Volume> volumes;
    ResidentBricks bricks{volumes.front().geometry().size};

    void add(const Index3& brick, std::uint8_t level) {
        const ResidentBricks::Change change{brick, brick_of(volumes[level], brick, 0x55, level)};
        bricks = bricks.with({&change, 1});
    }
    std::shared_ptr<const Samples> samples() const {
        const Volume& first = volumes.front();
        return std::make_shared<const Samples>(first, first.geometry(), bricks, 0, 255);
    }
};

TEST(Resident, where_bricks_of_different_levels_meet_each_sample_has_one_value) {
    Random random(8);
    const Geometry geometry = grid({130, 70, 66});
    Levels levels{{noise_volume<float>(geometry, 1, 0, 255),
                   noise_volume<float>(geometry, 2, 0, 255),
                   noise_volume<float>(geometry, 3, 0, 255)}};
    std::map<std::array<int, 3>, std::uint8_t> level_of;
    for_each_sample(grid(levels.bricks.count()), [&](const Index3& brick) {
        const auto level = static_cast<std::uint8_t>(random.below(3));
        levels.add(brick, level_of[{brick[0], brick[1], brick[2]}] = level);
    });
    const Field field = linear_field(levels.samples());
    std::vector<Field> plain;
    for (const Volume& volume : levels.volumes) plain.emplace_back(volume);
    const auto sample = [&](const Index3& at) {
        const Index3 brick = ResidentBricks::brick_of(at);
        return plain[level_of.at({brick[0], brick[1], brick[2]})].cell(at)[0];
    };
    for_each_sample(geometry, [&](const Index3& at) {
        const Index3 beside = at - Index3(at[0] % 64 == 0, at[1] % 64 == 0, at[2] % 64 == 0);
        if ((beside.array() < 0).any() || beside == at) return;
        const CellSamples cell = field.cell(beside);
        const Neighbours around = field.around(beside);
        for (int i = 0; i < 8; ++i) {
            const Index3 corner = beside + Index3(i & 1, i >> 1 & 1, i >> 2);
            if ((corner.array() >= geometry.size.array()).any()) continue;
            ASSERT_EQ(cell[std::size_t(i)], sample(corner)) << corner.transpose();
            const Index3 place = corner - beside + Index3::Ones();
            ASSERT_EQ(around[std::size_t(place[0] + 3 * place[1] + 9 * place[2])], sample(corner));
        }
    });
}

/// Solid up to a height [voxel].
Volume floor_of(const Geometry& geometry, double height) {
    std::vector<float> samples;
    for_each_sample(geometry, [&](const Index3& at) {
        samples.push_back(static_cast<float>(128 + 2 * (height - at[2])));
    });
    return {geometry, std::move(samples)};
}

TEST(Resident, a_proxy_does_not_go_into_a_finer_brick_that_says_solid) {
    const Geometry geometry = grid({128, 64, 64});
    for (const Interpolation interpolation : {Interpolation::linear, Interpolation::cubic}) {
        for (const double coarse : {24.0, 29.5, 36.0}) {
            Levels levels{{floor_of(geometry, 30), floor_of(geometry, coarse)}};
            levels.add({0, 0, 0}, 0);
            levels.add({1, 0, 0}, 1);
            const Field field(levels.samples(), Solid::above, 0, interpolation);
            Renderer renderer = make_renderer(field, 128.0);
            int held = 0;
            for (int tick = 0; tick < 400; ++tick) {  // down beside the border, then across it
                const Vec3 hand(std::min(100.0, 120.0 - 0.2 * tick), 32,
                                std::max(12.0, 45 - 0.5 * tick));
                const ProxyUpdate update = render(renderer, {0.001 * tick, hand}).proxy;
                ASSERT_EQ(update.status, UpdateStatus::done);
                ASSERT_LE(value_at(field, update.scp), 128 + 255e-9) << tick;
                held += update.mode == Mode::constrained;
            }
            EXPECT_GT(held, 200);
        }
    }
}

/// A row of ten bricks, solid but for x from `low` to `high`, of which the first two and the last
/// two are in memory. Space outside is solid.
Field long_row(int low, int high, Interpolation interpolation) {
    const Geometry geometry = grid({640, 64, 64});
    const Volume volume = volume_of<std::uint8_t>(
        geometry, [&](const Index3& at) { return at[0] >= low && at[0] < high ? 0 : 200; });
    PartOf part(volume);
    for (const int x : {0, 1, 8, 9}) part.add({x, 0, 0});
    return Field(part.samples(), Solid::above, 200, interpolation);
}

struct Touching {
    Interpolation interpolation;
    std::shared_ptr<const Tool> tool = nullptr;

    Renderer on(const Field& field) const {
        RendererSettings settings;
        settings.tool = tool;
        return make_renderer(field, 100, settings);
    }
};
const std::array touching{
    Touching{Interpolation::linear}, Touching{Interpolation::cubic},
    Touching{Interpolation::cubic, std::make_shared<const Tool>(sphere_tool(2, 1))}};

TEST(Resident, a_hand_that_was_put_into_the_solid_is_felt_where_it_comes_out) {
    for (const Touching& hand : touching) {
        Renderer renderer = hand.on(long_row(590, 640, hand.interpolation));
        int waiting = 0, tick = 0;
        const auto at = [&](double x) {
            const Tick now = render(renderer, {0.001 * ++tick, Vec3(x, 32, 32)});
            waiting += now.proxy.status == UpdateStatus::waiting;
            EXPECT_EQ(now.force, Vec3::Zero());
            return now.proxy;
        };
        while (tick < 500) at(64);  // where nothing within memory is free
        EXPECT_GT(waiting, 0);
        ProxyUpdate update;
        while (tick < 1000) update = at(615);
        EXPECT_EQ(update.status, UpdateStatus::done);
        EXPECT_EQ(update.mode, Mode::free);
        EXPECT_EQ(update.scp, Vec3(615, 32, 32));
    }
}

TEST(Resident, a_hand_over_which_a_solid_came_is_not_let_through_it) {
    for (const Touching& hand : touching) {
        Renderer renderer = hand.on(long_row(590, 640, hand.interpolation));
        (void)render(renderer, {0.001, Vec3(615, 32, 32)});
        const Field covered = long_row(0, 128, hand.interpolation);
        field_will_change(renderer.proxy, renderer.field);
        renderer.field.use(covered.shared_samples());
        for (int tick = 2; tick < 500; ++tick) {
            const ProxyUpdate update =
                render(renderer, {0.001 * tick, Vec3(std::max(64, 616 - tick), 32, 32)}).proxy;
            ASSERT_NE(update.status, UpdateStatus::done);
            ASSERT_NEAR(update.scp[0], 615, 1e-9);
        }
    }
}

TEST(Resident, versions_are_what_a_map_of_bricks_says_and_share_what_stayed) {
    Random random(5);
    // More than one leaf of bricks along x.
    const Index3 size(64 * 20, 64 * 2, 65);
    ResidentBricks bricks(size);
    std::map<std::array<int, 3>, Brick> expected;
    for (int step = 0; step < scaled(300) + 20; ++step) {
        std::vector<ResidentBricks::Change> changes;
        const ResidentBricks before = bricks;
        const auto old = expected;
        for (int n = 1 + random.below(5); n > 0; --n) {
            const Index3 at(random.below(20), random.below(2), random.below(2));
            Brick to;
            if (random.chance(0.6)) to.samples = std::make_shared<std::byte[]>(1);
            to.level = static_cast<std::uint8_t>(random.below(3));
            changes.push_back({at, to});
            expected[{at[0], at[1], at[2]}] = to;
        }
        bricks = bricks.with(changes);
        const auto agrees = [&](const ResidentBricks& version, const auto& map) {
            std::size_t held = 0;
            for (const auto& [at, brick] : map) {
                const Brick* found = version.at({at[0], at[1], at[2]});
                ASSERT_EQ(found ? found->samples : nullptr, brick.samples);
                ASSERT_EQ(found ? found->level : brick.level, brick.level);
                held += brick.samples != nullptr;
            }
            ASSERT_EQ(version.size(), held);
        };
        agrees(before, old);
        agrees(bricks, expected);
        if (HasFatalFailure()) return;
    }
    const ResidentBricks::Change beyond{{20, 0, 0}, {}};
    EXPECT_THROW((void)bricks.with({&beyond, 1}), std::out_of_range);
}

/// Reads boxes of a volume, and counts how many.
struct Reader {
    const Volume& volume;
    int boxes = 0;

    void operator()(const SampleBox& box, std::span<std::byte> out) {
        ++boxes;
        const std::size_t each = size_of(volume.type());
        const Index3& size = volume.geometry().size;
        std::size_t to = 0;
        for (int z = box.low[2]; z <= box.high[2]; ++z) {
            for (int y = box.low[1]; y <= box.high[1]; ++y) {
                const std::size_t row = std::size_t(box.high[0] - box.low[0] + 1) * each;
                const std::size_t from = (std::size_t(z) * std::size_t(size[1]) + std::size_t(y)) *
                                             std::size_t(size[0]) +
                                         std::size_t(box.low[0]);
                ASSERT_LE(to + row, out.size());
                std::memcpy(out.data() + to,
                            static_cast<const std::byte*>(volume.data()) + from * each, row);
                to += row;
            }
        }
        ASSERT_EQ(to, out.size());
    }
};

TEST(Resident, edits_made_without_bricks_are_those_of_the_same_samples_in_one_piece) {
    std::uint64_t seed = 40;
    int changed = 0, neighbours = 0;
    for (const SampleType type : sample_types) {
        for (const Geometry& geometry : large_grids()) {
            Random random(++seed);
            const Volume volume = noise_of(type, geometry, seed);
            Reader reader{volume};
            PartOf part(volume);
            auto plain = samples_of(volume);
            auto large = part.samples();
            EXPECT_THROW(edited(large, edit::Fill{}), std::invalid_argument) << "nothing reads it";
            for (int i = 0; i < scaled(6) + 4; ++i) {
                const Edit edit = random_edit(random, geometry, type);
                const Edited expected = edited(plain, edit);
                const Edited got = edited(large, edit, std::ref(reader));
                ASSERT_EQ(got.changed, expected.changed);
                ASSERT_EQ(got.samples->minimum(), expected.samples->minimum());
                ASSERT_EQ(got.samples->maximum(), expected.samples->maximum());
                plain = expected.samples;
                large = got.samples;
                changed += !got.changed.empty();
            }
            EXPECT_EQ(large->resident()->size(), 0U);
            part.add_all();
            const Field field = linear_field(
                std::make_shared<const Samples>(large->with(part.bricks())), Solid::above, -7.25);
            const Field same = linear_field(plain, Solid::above, -7.25);
            for (int i = 0; i < scaled(3000) + 10; ++i) {
                const Index3 at(random.below(geometry.size[0] + 4) - 2,
                                random.below(geometry.size[1] + 4) - 2,
                                random.below(geometry.size[2] + 4) - 2);
                ASSERT_EQ(field.cell(at), same.cell(at)) << at.transpose();
                ASSERT_EQ(field.around(at), same.around(at)) << at.transpose();
                const auto visited = [&](const Field& f) {
                    return f.visit_around(at, [](const auto* p, auto row, auto slice) {
                        return std::array{double(p[0]), double(p[1]), double(p[-row]),
                                          double(p[slice]), double(p[-slice - row - 1])};
                    });
                };
                ASSERT_EQ(visited(field), visited(same)) << at.transpose();
                neighbours +=
                    field.around(at) != linear_field(volume, Solid::above, -7.25).around(at);
            }
        }
    }
    EXPECT_GT(changed, 30);
    EXPECT_GT(neighbours, 50) << "few samples lie near an edit";
}

TEST(Resident, an_edit_reads_only_bricks_that_it_reaches_and_each_once) {
    const Geometry geometry = grid(cube(100));
    const Volume volume = noise_of(SampleType::uint8, geometry, 3);
    Reader reader{volume};
    Brush brush;
    brush.kind = BrushKind::paint;
    brush.radius = 1.5;
    brush.value = 300;
    // Along the diagonal: its box has 7^3 bricks.
    const edit::Stroke stroke{brush, Vec3::Zero(), Vec3::Constant(99)};
    const Edited once = edited(PartOf(volume).samples(), stroke, std::ref(reader));
    EXPECT_GE(reader.boxes, 7);
    EXPECT_LE(reader.boxes, 7 * 8);
    const int before = reader.boxes;
    edited(once.samples, stroke, std::ref(reader));
    EXPECT_EQ(reader.boxes, before);
}

TEST(Resident, an_edited_brick_that_went_is_missing_and_comes_back_edited) {
    const Geometry geometry = grid(cube(130));
    const Volume volume = noise_of(SampleType::int16, geometry, 5);
    Reader reader{volume};
    PartOf part(volume);
    part.add_all();
    const edit::Fill fill{{{60, 60, 60}, {70, 70, 70}}, 99};
    const Samples after = *edited(part.samples(), fill, std::ref(reader)).samples;
    part.drop({0, 0, 0});
    const Field without = linear_field(std::make_shared<const Samples>(after.with(part.bricks())));
    for (const double sample : without.cell({61, 61, 61})) EXPECT_EQ(sample, after.maximum());
    for (const double sample : without.cell({65, 65, 65})) EXPECT_EQ(sample, 99);
    part.add({0, 0, 0});
    const Field again = linear_field(std::make_shared<const Samples>(after.with(part.bricks())));
    for (const double sample : again.cell({61, 61, 61})) EXPECT_EQ(sample, 99);
    EXPECT_THROW(after.with(ResidentBricks(cube(64))), std::invalid_argument);
}

TEST(Resident, the_overview_shows_edits_that_its_samples_lie_in) {
    const Geometry geometry = grid(cube(128));
    const Volume volume = noise_of(SampleType::uint8, geometry, 6);
    // A sample for 4 x 4 x 4, in the middle of them.
    const Geometry coarse = grid(cube(32), Vec3::Constant(4), Vec3::Constant(1.5));
    const Volume overview(coarse, std::vector<std::uint8_t>(32 * 32 * 32, 7));
    Reader reader{volume};
    const auto large =
        std::make_shared<const Samples>(overview, geometry, ResidentBricks(geometry.size), 0, 255);
    const edit::Fill fill{{{0, 16, 16}, {127, 47, 47}}, 200};
    const Volume shown = flattened(*edited(large, fill, std::ref(reader)).samples);
    ASSERT_EQ(shown.geometry(), coarse);
    for_each_sample(coarse, [&](const Index3& at) {
        const bool in_bricks = at[1] < 12 && at[2] < 12;
        const bool filled = in_bricks && at[1] >= 4 && at[2] >= 4;
        const double own = in_bricks ? volume.sample(4 * at + Index3::Constant(2)) : 7;
        ASSERT_EQ(shown.sample(at), filled ? 200 : own) << at.transpose();
    });
}

/// The value that a grid shows with edits, sample by sample.
double shown_at(const Volume& plain, const Samples& edited, const Index3& at) {
    const Vec3 there = index_from_physical(
        edited.geometry(), physical_from_index(plain.geometry(), at.cast<double>()));
    const Index3 nearest = (there.array() + 0.5).floor().matrix().cast<int>();
    const bool inside =
        (nearest.array() >= 0).all() && (nearest.array() < edited.geometry().size.array()).all();
    if (!inside || !edited.bricks() || !edited.bricks()->of_sample(nearest))
        return plain.sample(at);
    return edited.sample(nearest);
}

TEST(Resident, shown_edits_follow_all_versions_and_share_what_did_not_change) {
    Random random(8);
    const Geometry geometry = grid({97, 70, 41}, {0.5, 1, 2}, {5, 5, 5}, oblique_direction());
    const Volume volume = noise_of(SampleType::int16, geometry, 5);
    Reader reader{volume};
    const auto part = [&](const Index3& low, const Index3& size, double coarser) {
        Geometry box = geometry;
        box.size = size;
        box.spacing *= coarser;
        box.origin = physical_from_index(geometry, low.cast<double>().array() + (coarser - 1) / 2);
        return noise_of(SampleType::int16, box, 9);
    };
    std::vector<Volume> grids{part({0, 0, 0}, {33, 24, 14}, 3), part({37, 21, 9}, {50, 33, 32}, 1),
                              part({-5, 3, 2}, {17, 16, 1}, 2.5)};
    std::vector<ShownEdits> shown(grids.begin(), grids.end());
    std::vector<std::shared_ptr<const Samples>> versions{PartOf(volume).samples()};
    int edits = 0;
    for (int step = 0; step < 30; ++step) {
        // Undo goes back to any version.
        std::shared_ptr<const Samples> now = versions[random.bits() % versions.size()];
        if (random.chance(0.7)) {
            const Index3 low(random.below(90), random.below(60), random.below(38));
            const Index3 high = (low + Index3(random.below(30), random.below(20), random.below(9)))
                                    .cwiseMin(geometry.size - Index3::Ones());
            now = edited(now, edit::Fill{{low, high}, random.uniform(-99, 99)}, std::ref(reader))
                      .samples;
            versions.push_back(now);
        }
        for (std::size_t g = 0; g < grids.size(); ++g) {
            EXPECT_EQ(shown[g].of(*versions.front())->bricks(), nullptr);
            const auto after = shown[g].of(*now);
            EXPECT_EQ(shown[g].of(*now), after);
            for_each_sample(grids[g].geometry(), [&](const Index3& at) {
                const double expected = shown_at(grids[g], *now, at);
                ASSERT_EQ(after->sample(at), expected) << g << ": " << at.transpose();
                edits += expected != grids[g].sample(at);
            });
            // A cell is read from one brick, which has copies of the next one's samples.
            const Field field = linear_field(after, Solid::above, 0.0),
                        flat(flattened(*after), Solid::above, 0.0);
            for_each_sample(grids[g].geometry(), [&](const Index3& at) {
                ASSERT_EQ(field.cell(at), flat.cell(at)) << g << ": " << at.transpose();
            });
            ASSERT_EQ(
                std::memcmp(flattened(*after).data(),
                            flattened(*ShownEdits(grids[g]).of(*now)).data(), grids[g].bytes()),
                0);
        }
    }
    EXPECT_GT(edits, 1000);
    // One more edit: bricks elsewhere stay the same ones.
    const auto far =
        edited(versions.back(), edit::Fill{{{96, 69, 40}, {96, 69, 40}}, 1}, std::ref(reader));
    const auto first = shown[0].of(*versions.back()), second = shown[0].of(*far.samples);
    ASSERT_TRUE(first->bricks() && second->bricks());
    int apart = 0;
    first->bricks()->for_each_apart(*second->bricks(), [&](const auto&...) { ++apart; });
    EXPECT_LE(apart, 1);
    EXPECT_GT(first->bricks()->size(), 1U);
}

TEST(Resident, samples_refuse_bricks_of_another_grid_and_bounds_that_are_none) {
    const Volume overview = noise_of(SampleType::uint8, grid({4, 4, 4}), 1);
    const Geometry large = grid({130, 66, 66});
    EXPECT_THROW(Samples(overview, large, ResidentBricks({64, 64, 64}), 0, 1),
                 std::invalid_argument);
    EXPECT_THROW(Samples(overview, large, ResidentBricks(large.size), 1, 0), std::invalid_argument);
    EXPECT_THROW(Samples(overview, large, ResidentBricks(large.size), not_a_number, 1),
                 std::invalid_argument);
    const Samples samples(overview, large, ResidentBricks(large.size), 0, 1);
    EXPECT_EQ(samples.geometry(), large);
    EXPECT_EQ(samples.volume().geometry(), overview.geometry());
}

}  // namespace
