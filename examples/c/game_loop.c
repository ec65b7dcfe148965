/* How a game engine embeds Palpate: the servo feels at 1 kHz on its own thread, and the frame loop
 * reads the newest snapshot 60 times a second to place the tool and draw the force. It gets the mesh
 * to show once. A plug-in for Unity or Unreal has the same five calls in its own callbacks.
 * usage: game_loop [VOLUME [DEVICE [FRAMES]]], which ends once the surface was felt for FRAMES frames
 * (600), or with the device's hand. */
#define _POSIX_C_SOURCE 199309L
#include <math.h>
#include <palpate.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static void check(palpate_status status) {
    if (status == PALPATE_OK) return;
    fprintf(stderr, "game_loop: %s\n", palpate_last_error());
    exit(1);
}

/* The engine's mesh: the surface that is felt. */
static void load_mesh(const palpate_volume *volume, double isovalue) {
    palpate_field *field = NULL;
    palpate_mesh *mesh = NULL;
    float *vertices;
    uint32_t *triangles;
    check(palpate_field_create(volume, NULL, &field));
    check(palpate_mesh_create(field, isovalue, &mesh));
    vertices = malloc(3 * sizeof *vertices * palpate_mesh_vertex_count(mesh));
    triangles = malloc(3 * sizeof *triangles * palpate_mesh_triangle_count(mesh));
    if (!vertices || !triangles) exit(1);
    check(palpate_mesh_read(mesh, vertices, triangles));
    printf("mesh of %lu vertices and %lu triangles\n",
           (unsigned long)palpate_mesh_vertex_count(mesh),
           (unsigned long)palpate_mesh_triangle_count(mesh));
    /* Hand both to the engine here. */
    free(triangles);
    free(vertices);
    palpate_mesh_destroy(mesh);
    palpate_field_destroy(field);
}

static double length_of(const double *v) {
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* Draws a frame. Engines have other axes: Unity's are left-handed and in metres, so a point (x, y, z)
 * in mm (LPS) is (-x, z, -y) / 1000 there. */
static void draw(const palpate_snapshot *now, int frame) {
    if (frame % 30 != 0) return;
    printf("frame %4d  tick %6ld  tool at %7.2f %7.2f %7.2f mm  force %.2f N\n", frame,
           (long)now->number, now->felt.scp[0], now->felt.scp[1], now->felt.scp[2],
           length_of(now->felt.force));
}

static void play(palpate_run *run, int frames) {
    const struct timespec pause = {0, 1000000000 / 60};
    double force, most = 0;
    int frame, felt = 0, ended = 0;
    for (frame = 0; felt < frames && !ended; ++frame) {
        PALPATE_STRUCT(palpate_snapshot, now);
        const palpate_status status = palpate_run_snapshot(run, &now);
        if (status != PALPATE_NOTHING_YET) {
            check(status);
            draw(&now, frame);
            force = length_of(now.felt.force);
            most = force > most ? force : most;
            felt += force > 0.1; /* N */
            ended = now.device_status == PALPATE_DEVICE_FINISHED;
        }
        nanosleep(&pause, NULL); /* the engine waits for the display */
    }
    printf("felt for %d of %d frames, the greatest force was %.2f N\n", felt, frame, most);
}

int main(int count, char **words) {
    palpate_volume *volume = NULL;
    palpate_data *data = NULL;
    palpate_run *run = NULL;
    char problem[256];
    PALPATE_STRUCT(palpate_volume_info, info);
    PALPATE_STRUCT(palpate_run_options, options);
    PALPATE_STRUCT(palpate_report, report);
    check(palpate_volume_load(count > 1 ? words[1] : "synthetic:torus", NULL, &volume));
    check(palpate_volume_describe(volume, &info));
    load_mesh(volume, info.isovalue);

    check(palpate_data_create(volume, &data));
    palpate_volume_destroy(volume);
    options.device = count > 2 ? words[2] : "simulated:touchx,hand=hold,depth=4";
    check(palpate_run_create(data, &options, &run));
    check(palpate_run_start(run));
    play(run, count > 3 ? atoi(words[3]) : 600);

    check(palpate_run_stop(run));
    check(palpate_run_text(run, PALPATE_TEXT_PROBLEM, problem, sizeof problem, NULL));
    check(palpate_run_report(run, &report));
    printf("%ld ticks, %ld missed; compute time p99 %.1f us %s\n", (long)report.ticks,
           (long)report.missed, 1e-3 * (double)report.compute_p99_ns, problem);
    palpate_run_destroy(run);
    palpate_data_destroy(data);
    return 0;
}
