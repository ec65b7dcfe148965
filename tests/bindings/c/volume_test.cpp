// Volumes, fields, meshes and renderers through the C interface: who owns samples, what is refused,
// and that results are the core's.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string>
#include <thread>

#include "palpate/renderer.hpp"
#include "palpate/run/setup.hpp"
#include "support/eventually.hpp"
#include "support/scratch_folder.hpp"
#include "tests/bindings/c/ball.hpp"

namespace palpate::c::test {
namespace {

void count_release(void* context) {
    ++*static_cast<int*>(context);
}

TEST(CVolume, adopted_samples_stay_where_they_are_and_are_released_once_when_the_last_user_goes) {
    const std::vector<float> samples = ball_samples();
    const palpate_geometry geometry = ball_geometry();
    int released = 0;
    palpate_volume* volume = nullptr;
    ASSERT_EQ(palpate_volume_adopt(&geometry, PALPATE_FLOAT32, samples.data(), 4 * samples.size(),
                                   &count_release, &released, &volume),
              PALPATE_OK);
    EXPECT_EQ(palpate_volume_samples(volume), samples.data());
    palpate_field* field = nullptr;
    ASSERT_EQ(palpate_field_create(volume, nullptr, &field), PALPATE_OK);
    palpate_volume_destroy(volume);
    EXPECT_EQ(released, 0);
    palpate_field_destroy(field);
    EXPECT_EQ(released, 1);
}

TEST(CVolume, samples_that_are_refused_stay_the_callers) {
    const std::vector<float> samples = ball_samples();
    const palpate_geometry geometry = ball_geometry();
    int released = 0;
    palpate_volume* volume = nullptr;
    EXPECT_EQ(palpate_volume_adopt(&geometry, PALPATE_FLOAT32, samples.data(), 4, &count_release,
                                   &released, &volume),
              PALPATE_INVALID);
    EXPECT_STRNE(palpate_last_error(), "");
    EXPECT_EQ(released, 0);
    EXPECT_EQ(volume, nullptr);
}

TEST(CVolume, copied_samples_are_the_librarys_own) {
    std::vector<float> samples = ball_samples();
    const palpate_geometry geometry = ball_geometry();
    palpate_volume* volume = nullptr;
    ASSERT_EQ(palpate_volume_copy(&geometry, PALPATE_FLOAT32, samples.data(), 4 * samples.size(),
                                  &volume),
              PALPATE_OK);
    const std::vector<float> before = samples;
    samples.assign(samples.size(), 0);
    EXPECT_EQ(std::memcmp(palpate_volume_samples(volume), before.data(), 4 * before.size()), 0);
    palpate_volume_destroy(volume);
}

TEST(CVolume, a_geometry_that_cannot_be_is_refused_with_a_reason) {
    const std::vector<float> samples(8);
    palpate_volume* volume = nullptr;
    for (const int size : {0, -1, std::numeric_limits<int>::max()}) {
        palpate_geometry geometry = ball_geometry();
        geometry.size[1] = size;
        EXPECT_EQ(palpate_volume_copy(&geometry, PALPATE_FLOAT32, samples.data(), 32, &volume),
                  PALPATE_INVALID);
        EXPECT_STRNE(palpate_last_error(), "");
    }
    palpate_geometry turned = ball_geometry();
    turned.direction[0] = 2;
    EXPECT_EQ(palpate_volume_copy(&turned, PALPATE_FLOAT32, samples.data(), 32, &volume),
              PALPATE_INVALID);
    const palpate_geometry geometry = ball_geometry();
    EXPECT_EQ(palpate_volume_copy(&geometry, 4, samples.data(), 32, &volume), PALPATE_INVALID);
}

TEST(CVolume, a_file_that_is_not_there_is_an_input_error_that_names_it) {
    palpate_volume* volume = nullptr;
    EXPECT_EQ(palpate_volume_load("nowhere.nrrd", nullptr, &volume), PALPATE_INPUT);
    EXPECT_NE(std::strstr(palpate_last_error(), "nowhere.nrrd"), nullptr);
}

TEST(CVolume, a_frame_of_a_sequence_is_loaded_by_its_number_from_1_and_counts_as_one) {
    const auto frames = [](std::int32_t frame) {
        PALPATE_STRUCT(palpate_load_options, options);
        options.frame = frame;
        palpate_volume* volume = nullptr;
        const auto status = palpate_volume_load("synthetic:beating:16x16x16", &options, &volume);
        PALPATE_STRUCT(palpate_volume_info, info);
        if (status == PALPATE_OK) {
            EXPECT_EQ(palpate_volume_describe(volume, &info), PALPATE_OK);
        }
        palpate_volume_destroy(volume);
        return std::pair(status, info.frames);
    };
    EXPECT_EQ(frames(0), std::pair(PALPATE_OK, 20));
    EXPECT_EQ(frames(1), std::pair(PALPATE_OK, 1));
    EXPECT_EQ(frames(20), std::pair(PALPATE_OK, 1));
    EXPECT_EQ(frames(21).first, PALPATE_INVALID);
    EXPECT_EQ(frames(-1).first, PALPATE_INVALID);
}

TEST(CVolume, options_that_change_nothing_are_refused) {
    const support::ScratchFolder folder;
    std::ofstream(folder / "still.nrrd", std::ios::binary)
        << "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n\n"
        << "\1\2\3\4\5\6\7\x8";
    const auto refusal = [&](std::int32_t frame, const char* series) {
        PALPATE_STRUCT(palpate_load_options, options);
        options.frame = frame;
        options.series = series;
        palpate_volume* volume = nullptr;
        const std::string name = (folder / "still.nrrd").string();
        EXPECT_EQ(palpate_volume_load(name.c_str(), &options, &volume), PALPATE_INVALID);
        EXPECT_EQ(volume, nullptr);
        return std::string(palpate_last_error());
    };
    EXPECT_TRUE(refusal(1, nullptr).starts_with("frame does nothing: ")) << refusal(1, nullptr);
    EXPECT_TRUE(refusal(0, "1").starts_with("series does nothing: ")) << refusal(0, "1");
}

TEST(CStructs, of_an_earlier_version_are_filled_as_far_as_they_go) {
    palpate_volume* volume = ball();
    struct {
        palpate_volume_info info;
        unsigned char beyond[8];
    } box;
    std::memset(&box, 0x5a, sizeof box);
    box.info.size_of = offsetof(palpate_volume_info, minimum);
    ASSERT_EQ(palpate_volume_describe(volume, &box.info), PALPATE_OK);
    EXPECT_EQ(box.info.size_of, offsetof(palpate_volume_info, minimum));
    EXPECT_EQ(box.info.geometry.size[2], 64);
    const auto* bytes = reinterpret_cast<const unsigned char*>(&box);
    for (std::size_t i = box.info.size_of; i < sizeof box; ++i) ASSERT_EQ(bytes[i], 0x5a);
    palpate_volume_destroy(volume);
}

TEST(CStructs, of_a_later_version_are_taken_unless_they_ask_for_what_is_not_there) {
    palpate_volume* volume = ball();
    struct {
        palpate_field_options options;
        double later;
    } box{};
    box.options.size_of = sizeof box;
    palpate_field* field = nullptr;
    ASSERT_EQ(palpate_field_create(volume, &box.options, &field), PALPATE_OK);
    palpate_field_destroy(field);
    box.later = 1;
    EXPECT_EQ(palpate_field_create(volume, &box.options, &field), PALPATE_INVALID);
    box.options.size_of = 0;
    EXPECT_EQ(palpate_field_create(volume, &box.options, &field), PALPATE_INVALID);
    palpate_volume_destroy(volume);
}

TEST(CField, values_rays_and_meshes_are_those_of_the_ball) {
    palpate_volume* volume = ball();
    palpate_field* field = nullptr;
    ASSERT_EQ(palpate_field_create(volume, nullptr, &field), PALPATE_OK);
    const std::array<double, 6> points{10, 0, 0, 0, -15, 0};
    std::array<double, 2> densities{};
    std::array<double, 6> gradients{};
    ASSERT_EQ(palpate_field_values(field, points.data(), 2, densities.data(), gradients.data()),
              PALPATE_OK);
    EXPECT_NEAR(densities[0], 150, 1);
    EXPECT_NEAR(densities[1], 125, 1);
    EXPECT_NEAR(gradients[0], -5, 0.1);
    const std::array<double, 3> outside{40, 0, 0}, centre{0, 0, 0};
    PALPATE_STRUCT(palpate_ray_hit, hit);
    ASSERT_EQ(palpate_field_ray(field, 100, outside.data(), centre.data(), &hit), PALPATE_OK);
    EXPECT_EQ(hit.hit, 1);
    EXPECT_NEAR(hit.point[0], 20, 0.2);
    EXPECT_NEAR(hit.normal[0], 1, 1e-3);
    palpate_mesh* mesh = nullptr;
    ASSERT_EQ(palpate_mesh_create(field, 100, &mesh), PALPATE_OK);
    std::vector<float> vertices(3 * palpate_mesh_vertex_count(mesh));
    std::vector<std::uint32_t> triangles(3 * palpate_mesh_triangle_count(mesh));
    ASSERT_EQ(palpate_mesh_read(mesh, vertices.data(), triangles.data()), PALPATE_OK);
    ASSERT_GT(vertices.size(), 3000U);
    EXPECT_EQ(triangles.size(), 2 * vertices.size() - 12);  // Euler: a sphere
    for (std::size_t i = 0; i < vertices.size(); i += 3) {
        EXPECT_NEAR(std::hypot(vertices[i], vertices[i + 1], vertices[i + 2]), 20, 0.2);
    }
    palpate_mesh_destroy(mesh);
    palpate_field_destroy(field);
    palpate_volume_destroy(volume);
}

TEST(CRenderer, gives_the_cores_ticks_bit_for_bit) {
    palpate_volume* volume = ball();
    palpate_field* field = nullptr;
    ASSERT_EQ(palpate_field_create(volume, nullptr, &field), PALPATE_OK);
    PALPATE_STRUCT(palpate_render_options, options);
    options.has_isovalue = 1;
    options.isovalue = 100;
    options.stiffness = 0.4;
    options.static_friction = options.dynamic_friction = 0.2;
    palpate_renderer* renderer = nullptr;
    ASSERT_EQ(palpate_renderer_create(field, &options, nullptr, &renderer), PALPATE_OK);

    Geometry geometry;
    geometry.size = {64, 64, 64};
    geometry.origin = {-31.5, -31.5, -31.5};
    const Field core(Volume(geometry, ball_samples()), Solid::above, {}, Interpolation::cubic);
    run::RenderSetup setup;
    setup.stiffness = 0.4;
    setup.friction = Friction{0.2, 0.2};
    Renderer reference = make_renderer(core, 100, run::render_settings(setup, core, 100));
    int touched = 0;
    for (int tick = 0; tick < 500; ++tick) {
        PALPATE_STRUCT(palpate_hand, hand);
        hand.time = 0.001 * tick;
        hand.position[0] = 25 - 0.02 * tick;
        hand.position[1] = std::sin(0.02 * tick);
        PALPATE_STRUCT(palpate_felt, felt);
        ASSERT_EQ(palpate_renderer_render(renderer, &hand, &felt), PALPATE_OK);
        const Tick wanted = render(
            reference, {.time = hand.time, .position = {hand.position[0], hand.position[1], 0}});
        ASSERT_EQ(std::memcmp(felt.scp, wanted.proxy.scp.data(), sizeof felt.scp), 0) << tick;
        ASSERT_EQ(std::memcmp(felt.force, wanted.force.data(), sizeof felt.force), 0) << tick;
        touched += felt.mode == PALPATE_CONSTRAINED && wanted.force.norm() > 0.1;
    }
    EXPECT_GT(touched, 100);
    palpate_renderer_destroy(renderer);
    palpate_field_destroy(field);
    palpate_volume_destroy(volume);
}

TEST(CProgress, of_a_thread_is_told_by_every_long_call_and_can_stop_it) {
    PALPATE_STRUCT(palpate_geometry, grid);
    for (std::int32_t& size : grid.size) size = 128;
    std::vector<unsigned char> samples(std::size_t{128} * 128 * 128);
    for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = i < samples.size() / 2 ? 9 : 200;
    palpate_volume* volume = nullptr;
    palpate_data* data = nullptr;
    palpate_field* field = nullptr;
    palpate_mesh* mesh = nullptr;
    PALPATE_STRUCT(palpate_volume_info, info);
    const support::ScratchFolder folder;
    const std::string path = (folder / "saved.raw").string();
    const auto copy = [&] {
        return palpate_volume_copy(&grid, PALPATE_UINT8, samples.data(), samples.size(), &volume);
    };
    ASSERT_EQ(copy(), PALPATE_OK);
    ASSERT_EQ(palpate_data_create(volume, &data), PALPATE_OK);
    ASSERT_EQ(palpate_field_create(volume, nullptr, &field), PALPATE_OK);
    const palpate_field* const first = field;
    int calls = 0;
    const auto stop = [](double, void* context) {
        ++*static_cast<int*>(context);
        return 0;
    };
    palpate_set_progress(stop, &calls);
    EXPECT_EQ(copy(), PALPATE_CANCELLED);
    EXPECT_EQ(palpate_volume_load("synthetic:noise:128x128x128", nullptr, &volume),
              PALPATE_CANCELLED);
    EXPECT_EQ(palpate_volume_describe(volume, &info), PALPATE_CANCELLED);
    EXPECT_STREQ(palpate_last_error(), "the call was cancelled");
    EXPECT_EQ(palpate_field_create(volume, nullptr, &field), PALPATE_CANCELLED);
    EXPECT_EQ(palpate_data_field(data, nullptr, &field), PALPATE_CANCELLED);
    EXPECT_EQ(palpate_mesh_create(field, 100, &mesh), PALPATE_CANCELLED);
    EXPECT_EQ(palpate_data_save(data, path.c_str()), PALPATE_CANCELLED);
    palpate_device_list* devices = nullptr;
    EXPECT_EQ(palpate_device_list_create(&devices), PALPATE_CANCELLED);
    EXPECT_EQ(calls, 8) << "once each";
    EXPECT_EQ(field, first);
    std::thread([&] { EXPECT_EQ(palpate_volume_describe(volume, &info), PALPATE_OK); }).join();
    const auto describe = [](double, void* context) {
        PALPATE_STRUCT(palpate_volume_info, again);
        const auto* of = static_cast<const palpate_volume*>(context);
        const bool is_told = palpate_volume_describe(of, &again) == PALPATE_OK;
        return int{is_told && palpate_volume_describe(of, nullptr) == PALPATE_INVALID};
    };
    palpate_set_progress(describe, volume);  // which does not come to itself again
    EXPECT_EQ(palpate_volume_describe(volume, &info), PALPATE_OK);
    EXPECT_STREQ(palpate_last_error(), "");
    palpate_set_progress(nullptr, nullptr);
    EXPECT_EQ(palpate_volume_describe(volume, &info), PALPATE_OK);
    EXPECT_EQ(palpate_mesh_create(field, 100, &mesh), PALPATE_OK);
    EXPECT_EQ(palpate_data_save(data, path.c_str()), PALPATE_OK) << palpate_last_error();
    palpate_mesh_destroy(mesh);
    palpate_field_destroy(field);
    palpate_data_destroy(data);
    palpate_volume_destroy(volume);
}

TEST(CProgress, that_throws_cancels_the_call) {
    palpate_volume* volume = nullptr;
    palpate_set_progress([](double, void*) -> std::int32_t { throw std::runtime_error("enough"); },
                         nullptr);
    EXPECT_EQ(palpate_volume_load("synthetic:noise:64x64x64", nullptr, &volume), PALPATE_CANCELLED);
    EXPECT_STREQ(palpate_last_error(), "the progress function threw an exception: enough");
    palpate_set_progress(nullptr, nullptr);
    EXPECT_EQ(volume, nullptr);
}

TEST(CProgress, is_told_by_every_edit_and_can_stop_it) {
    palpate_volume* volume = ball();
    palpate_data* data = nullptr;
    palpate_field* field = nullptr;
    ASSERT_EQ(palpate_data_create(volume, &data), PALPATE_OK);
    ASSERT_EQ(palpate_field_create(volume, nullptr, &field), PALPATE_OK);
    const std::int32_t low[3] = {1, 1, 1}, high[3] = {3, 3, 3};
    EXPECT_EQ(palpate_data_fill(data, high, low, 77), PALPATE_INVALID);
    ASSERT_EQ(palpate_data_fill(data, low, high, 77), PALPATE_OK);
    int calls = 0;
    const auto stop = [](double, void* context) {
        ++*static_cast<int*>(context);
        return 0;
    };
    palpate_set_progress(stop, &calls);
    PALPATE_STRUCT(palpate_brush, brush);
    brush.radius = 9;
    brush.level = 100;
    const double at[3] = {0, 0, 0};
    const std::vector<double> points(std::size_t{3} * 5000);
    std::vector<double> values(5000);
    EXPECT_EQ(palpate_data_stroke(data, &brush, at, at), PALPATE_CANCELLED);
    EXPECT_EQ(palpate_data_fill(data, low, high, 99), PALPATE_CANCELLED);
    EXPECT_EQ(palpate_data_replace(data, low, volume), PALPATE_CANCELLED);
    EXPECT_EQ(palpate_data_undo(data, nullptr), PALPATE_CANCELLED);
    EXPECT_EQ(palpate_data_redo(data, nullptr), PALPATE_CANCELLED);
    EXPECT_EQ(palpate_field_values(field, points.data(), 5000, values.data(), nullptr),
              PALPATE_CANCELLED);
    EXPECT_EQ(calls, 6) << "once each";
    PALPATE_STRUCT(palpate_edit_state, edits);
    EXPECT_EQ(palpate_data_edits(data, &edits), PALPATE_OK);
    EXPECT_EQ(edits.version, 1U);
    palpate_set_progress(nullptr, nullptr);
    palpate_field_destroy(field);
    palpate_data_destroy(data);
    palpate_volume_destroy(volume);
}

TEST(CData, the_brush_of_a_hand_can_have_the_shape_of_its_tool) {
    const support::ScratchFolder folder;
    const std::string recording = (folder.path() / "run.csv").string();
    palpate_volume* volume = ball();
    palpate_data* data = nullptr;
    ASSERT_EQ(palpate_data_create(volume, &data), PALPATE_OK);
    PALPATE_STRUCT(palpate_brush, brush);
    brush.radius = 1;
    brush.rate = std::numeric_limits<double>::infinity();
    brush.as_tool = 1;
    const double at[3] = {0, 0, 0};
    EXPECT_EQ(palpate_data_stroke(data, &brush, at, at), PALPATE_INVALID);
    EXPECT_STREQ(palpate_last_error(), "brush.as_tool: is for a hand's brush only");
    ASSERT_EQ(palpate_data_set_brush(data, &brush), PALPATE_OK) << palpate_last_error();
    PALPATE_STRUCT(palpate_render_options, render);
    render.has_isovalue = 1;
    render.isovalue = 100;
    render.tool = "sphere:2";
    PALPATE_STRUCT(palpate_run_options, options);
    options.render = &render;
    options.device = "simulated:touchx,hand=press";
    options.recording = recording.c_str();
    options.no_real_time = 1;
    palpate_run* run = nullptr;
    ASSERT_EQ(palpate_run_create(data, &options, &run), PALPATE_OK) << palpate_last_error();
    ASSERT_EQ(palpate_run_start(run), PALPATE_OK);
    PALPATE_STRUCT(palpate_snapshot, now);  // of a tick that has the edit, so it is recorded
    EXPECT_TRUE(support::comes_true(
        [&] { return palpate_run_snapshot(run, &now) == PALPATE_OK && now.version > 0; }));
    palpate_run_destroy(run);
    palpate_data_destroy(data);
    palpate_volume_destroy(volume);
    const std::string recorded = support::bytes_of(recording);
    EXPECT_NE(recorded.find("\"sweep\""), std::string::npos);
    EXPECT_EQ(recorded.find("\"stroke\""), std::string::npos);
}

TEST(CHandles, that_are_null_are_refused_by_name_and_may_be_destroyed) {
    PALPATE_STRUCT(palpate_volume_info, info);
    EXPECT_EQ(palpate_volume_describe(nullptr, &info), PALPATE_INVALID);
    EXPECT_STREQ(palpate_last_error(), "volume is null");
    palpate_field* field = nullptr;
    EXPECT_EQ(palpate_field_create(nullptr, nullptr, &field), PALPATE_INVALID);
    palpate_volume* volume = ball();
    EXPECT_EQ(palpate_field_create(volume, nullptr, nullptr), PALPATE_INVALID);
    EXPECT_EQ(palpate_volume_describe(volume, nullptr), PALPATE_INVALID);
    palpate_volume_destroy(volume);
    EXPECT_EQ(palpate_run_start(nullptr), PALPATE_INVALID);
    EXPECT_EQ(palpate_run_set_isovalue(nullptr, 1), PALPATE_INVALID);
    EXPECT_EQ(palpate_data_undo(nullptr, nullptr), PALPATE_INVALID);
    EXPECT_EQ(palpate_mesh_vertex_count(nullptr), 0U);
    palpate_volume_destroy(nullptr);
    palpate_field_destroy(nullptr);
    palpate_run_destroy(nullptr);
    palpate_data_destroy(nullptr);
    EXPECT_STREQ(palpate_version(), PALPATE_VERSION);
}

TEST(CDevices, the_list_has_the_simulated_device) {
    palpate_device_list* list = nullptr;
    ASSERT_EQ(palpate_device_list_create(&list), PALPATE_OK);
    bool seen = false;
    for (std::size_t i = 0; i < palpate_device_list_count(list); ++i) {
        PALPATE_STRUCT(palpate_device_finding, finding);
        ASSERT_EQ(palpate_device_list_get(list, i, &finding), PALPATE_OK);
        if (std::string(finding.name) == "simulated") seen = finding.found != 0;
    }
    EXPECT_TRUE(seen);
    PALPATE_STRUCT(palpate_device_finding, finding);
    EXPECT_EQ(palpate_device_list_get(list, 1000, &finding), PALPATE_INVALID);
    palpate_device_list_destroy(list);
}

}  // namespace
}  // namespace palpate::c::test
