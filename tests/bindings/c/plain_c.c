/* The header as C99 sees it, and a renderer from C: a hand presses into a ball of 20 mm. */
#include <math.h>
#include <palpate.h>
#include <stdio.h>
#include <stdlib.h>

enum { SIDE = 64 };

static void require(int is_true, const char *what) {
    if (is_true) return;
    fprintf(stderr, "%s: %s\n", what, palpate_last_error());
    exit(1);
}

int main(void) {
    short *samples = malloc(sizeof(short) * SIDE * SIDE * SIDE), *at = samples;
    palpate_volume *volume = NULL;
    palpate_field *field = NULL;
    palpate_renderer *renderer = NULL;
    PALPATE_STRUCT(palpate_geometry, geometry);
    PALPATE_STRUCT(palpate_render_options, options);
    double force = 0, distance = 0;
    int i, j, k, tick;
    require(samples != NULL, "memory");
    for (k = 0; k < SIDE; ++k)
        for (j = 0; j < SIDE; ++j)
            for (i = 0; i < SIDE; ++i) {
                const double x = i - 31.5, y = j - 31.5, z = k - 31.5;
                *at++ = (short)(2000 - 50 * sqrt(x * x + y * y + z * z));
            }
    for (i = 0; i < 3; ++i) {
        geometry.size[i] = SIDE;
        geometry.origin[i] = -31.5;
    }
    require(palpate_volume_adopt(&geometry, PALPATE_INT16, samples,
                                 sizeof(short) * SIDE * SIDE * SIDE, free, samples,
                                 &volume) == PALPATE_OK,
            "volume");
    require(palpate_field_create(volume, NULL, &field) == PALPATE_OK, "field");
    options.has_isovalue = 1;
    options.isovalue = 1000;
    options.stiffness = 0.5;
    require(palpate_renderer_create(field, &options, NULL, &renderer) == PALPATE_OK, "renderer");
    for (tick = 0; tick < 1000; ++tick) {
        PALPATE_STRUCT(palpate_hand, hand);
        PALPATE_STRUCT(palpate_felt, felt);
        hand.time = 0.001 * tick;
        hand.position[0] = 26 - 0.01 * tick;
        require(palpate_renderer_render(renderer, &hand, &felt) == PALPATE_OK, "render");
        force = felt.force[0];
        distance = felt.scp[0];
    }
    printf("force %.3f N, proxy at %.3f mm\n", force, distance);
    require(fabs(distance - 20) < 0.2, "the proxy is on the ball");
    require(fabs(force - 0.5 * (distance - 16.01)) < 0.02, "the force is the spring's");
    palpate_renderer_destroy(renderer);
    palpate_field_destroy(field);
    palpate_volume_destroy(volume);
    return 0;
}
