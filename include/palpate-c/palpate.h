/* The C interface of Palpate (libpalpate-c): volumes, fields, renderers, live runs on devices, edits
 * and recordings. C99. docs/c_api.md has the rules for growth and an example.
 *
 * Errors. Functions return a palpate_status. palpate_last_error() returns one line with the fault and
 * its remedy, for the last call of the same thread. No exception leaves the library. If a function
 * fails, it leaves its out-parameters unchanged. A null handle or pointer gives PALPATE_INVALID.
 *
 * Structs. Each begins with its own size. Write PALPATE_STRUCT(palpate_run_options, options); then
 * every other member is 0, and 0 always means the default. A later library accepts structs of earlier
 * ones. An earlier library refuses members that it does not know if they are not 0. A struct inside
 * another never grows, and its size_of is ignored. Enumerations and truth values (0: no) are int32_t.
 * Matrices are three rows of three. Quaternions are x, y, z, w.
 *
 * Space. Lengths in mm, physical space as in the file (LPS: x to the left, y to the back, z up).
 * Device axes: x to the right, y up, z towards the person. Forces in N, torques in N mm, times in s.
 *
 * Threads. Volumes, fields and meshes never change, so several threads may use one at the same time.
 * Any thread may use data and runs. Calls on the same run take turns. palpate_run_snapshot() never
 * waits for the servo, but it may wait for another call on the same run: starting, changing the device
 * and recording may take seconds. Only one thread at a time may use a renderer. Destroy a handle when
 * no other call uses it. Handles that were made from it remain valid. The servo has a thread of its
 * own, with real-time priority if the system grants it. It calls no function of yours. A callback must
 * not start, stop or destroy the run that it belongs to. Its other calls return PALPATE_WRONG_STATE if
 * they would have to wait for the run.
 */
#ifndef PALPATE_H
#define PALPATE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define PALPATE_API __attribute__((visibility("default")))
#else
#define PALPATE_API
#endif

/* Declares a struct with its size and all defaults. */
#ifdef __cplusplus
#define PALPATE_STRUCT(type, name) \
    type name{};                   \
    name.size_of = static_cast<uint32_t>(sizeof(type))
#else
#define PALPATE_STRUCT(type, name) type name = {.size_of = (uint32_t)sizeof(type)}
#endif

/* ---- Status and errors ------------------------------------------------------------------------ */

typedef enum palpate_status {
    PALPATE_OK = 0,
    PALPATE_INVALID = 1,       /* an impossible argument */
    PALPATE_INPUT = 2,         /* a file that cannot be read or is not valid */
    PALPATE_OUTPUT = 3,        /* a file that cannot be written */
    PALPATE_NO_DEVICE = 4,     /* the device is not available */
    PALPATE_QUEUE_FULL = 5,    /* commands were sent faster than they are carried out: try again */
    PALPATE_WRONG_STATE = 6,   /* not possible now: the run was not started, or has stopped, ... */
    PALPATE_NOTHING_YET = 7,   /* there was no tick yet */
    PALPATE_NO_MEMORY = 8,
    PALPATE_SYSTEM = 9,        /* the system refused something, for example a thread */
    PALPATE_CANCELLED = 10,    /* a progress callback returned 0, or threw an exception (in C++) */
    PALPATE_INTERNAL = 11      /* a mistake of this library: please report it */
} palpate_status;

PALPATE_API const char *palpate_version(void); /* MAJOR.MINOR.PATCH, for example "0.2.0" */
/* "" after a call without error. Valid until the next call of this thread. */
PALPATE_API const char *palpate_last_error(void);
/* Sets a function (or null) that reports the progress of long calls of this thread: they call it with
 * 0 to 1, unless their options have a function of their own. It returns 0 to cancel the call. Long calls
 * copy, adopt, load or describe a volume, look up many values, make a field, a mesh, a renderer or a
 * run, edit or save data, or read a tool. Others look for devices, change the device, begin a
 * recording, or end one whose pipe is read slowly. A cancelled edit is made as a whole or not at all. Calls from within a callback do not
 * call it. */
PALPATE_API void palpate_set_progress(int32_t (*progress)(double fraction, void *context),
                                      void *context);

/* ---- Volumes ---------------------------------------------------------------------------------- */

typedef struct palpate_volume palpate_volume;

enum { PALPATE_UINT8 = 0, PALPATE_INT16 = 1, PALPATE_UINT16 = 2, PALPATE_FLOAT32 = 3 };

typedef struct palpate_geometry {
    uint32_t size_of;
    int32_t size[3];     /* samples along x, y, z; x varies fastest in memory */
    double spacing[3];   /* [mm]; all 0: 1, assumed */
    double origin[3];    /* [mm] of the first sample */
    double direction[9]; /* columns are the grid's axes, orthonormal; all 0: identity, and it is
                            not known which side is left */
} palpate_geometry;

/* Copies the samples. */
PALPATE_API palpate_status palpate_volume_copy(const palpate_geometry *geometry, int32_t type,
                                               const void *samples, size_t bytes,
                                               palpate_volume **out);
/* Uses the samples in place, so they must not change. `release` (may be null) is called once when they
 * are no longer needed, on any thread but the servo's. It is not called if this call fails. */
PALPATE_API palpate_status palpate_volume_adopt(const palpate_geometry *geometry, int32_t type,
                                                const void *samples, size_t bytes,
                                                void (*release)(void *context), void *context,
                                                palpate_volume **out);

typedef struct palpate_load_options {
    uint32_t size_of;
    int32_t smooth;     /* passes of the binomial kernel */
    int32_t dequantize; /* rounds of the filter that removes the steps of rounded data; 0: none */
    int32_t frame;      /* only this frame of a sequence, from 1; 0: all. Refused for others */
    const char *series; /* DICOM series: its UID or number; null: the only one. Refused for others */
    /* Called from this thread with 0 to 1; returns 0 to cancel. */
    int32_t (*progress)(double fraction, void *context);
    void *context;
} palpate_load_options;

/* A file, a folder of DICOM or TIFF slices, a numbered series (heart_%03d.nrrd), or
 * "synthetic:NAME:WxHxD". Files are read by the program palpate-io-helper. options: may be null. */
PALPATE_API palpate_status palpate_volume_load(const char *name, const palpate_load_options *options,
                                               palpate_volume **out);

typedef struct palpate_volume_info {
    uint32_t size_of;
    int32_t type;
    palpate_geometry geometry;
    double minimum, maximum;
    double isovalue; /* a suggested one; NaN for constant data */
    int32_t frames;  /* number of frames; 1 unless it is a sequence */
    int32_t unused;
} palpate_volume_info;
PALPATE_API palpate_status palpate_volume_describe(const palpate_volume *volume,
                                                   palpate_volume_info *out);
/* Null for a null handle. Valid as long as the handle exists. */
PALPATE_API const void *palpate_volume_samples(const palpate_volume *volume);
PALPATE_API void palpate_volume_destroy(palpate_volume *volume);

/* ---- Fields: a density at every point of space ------------------------------------------------ */

typedef struct palpate_field palpate_field;
typedef struct palpate_mesh palpate_mesh;

enum { PALPATE_SOLID_ABOVE = 0, PALPATE_SOLID_BELOW = 1 };
enum { PALPATE_CUBIC = 0, PALPATE_LINEAR = 1 };

typedef struct palpate_field_options {
    uint32_t size_of;
    int32_t solid;          /* which side of the isovalue is solid */
    int32_t interpolation;
    int32_t has_background; /* 0: the data's minimum, or its maximum if the solid is below */
    double background;      /* density outside the grid */
} palpate_field_options;

PALPATE_API palpate_status palpate_field_create(const palpate_volume *volume,
                                                const palpate_field_options *options,
                                                palpate_field **out);
/* Densities [data units] and gradients [data units/mm] at `count` points [mm] (x, y, z of each). Either
 * result may be null. A call that is cancelled has written the results of the first points. */
PALPATE_API palpate_status palpate_field_values(const palpate_field *field, const double *points,
                                                size_t count, double *densities, double *gradients);

typedef struct palpate_ray_hit {
    uint32_t size_of;
    int32_t hit;
    double point[3];  /* without a hit, the end of the segment */
    double normal[3]; /* unit, out of the solid */
} palpate_ray_hit;
/* Finds the first point of a segment on the isosurface. */
PALPATE_API palpate_status palpate_field_ray(const palpate_field *field, double isovalue,
                                             const double from[3], const double to[3],
                                             palpate_ray_hit *out);
PALPATE_API void palpate_field_destroy(palpate_field *field);

/* The whole isosurface as a closed mesh, for display. Triangles run counter-clockwise seen from outside. */
PALPATE_API palpate_status palpate_mesh_create(const palpate_field *field, double isovalue,
                                               palpate_mesh **out);
PALPATE_API size_t palpate_mesh_vertex_count(const palpate_mesh *mesh);
PALPATE_API size_t palpate_mesh_triangle_count(const palpate_mesh *mesh);
/* Writes into arrays of the caller, 3 numbers per vertex or triangle. Either may be null. */
PALPATE_API palpate_status palpate_mesh_read(const palpate_mesh *mesh, float *vertices,
                                             uint32_t *triangles);
PALPATE_API void palpate_mesh_destroy(palpate_mesh *mesh);

/* ---- Renderers: one tick at a time, in your own loop ------------------------------------------ */

typedef struct palpate_renderer palpate_renderer;

typedef struct palpate_render_options {
    uint32_t size_of;
    int32_t has_isovalue;  /* 0: the volume's own or a suggested one. Refused with layers and with
                              ranges, which have levels of their own */
    double isovalue;
    double stiffness;      /* [N/mm] 0: 0.5, or what the device is rated for if that is less */
    double damping;        /* [N s/mm] */
    double viscosity;      /* [N s/mm] */
    double force_limit;    /* [N] 0: the device's; renderer: 3.3 */
    double static_friction, dynamic_friction;
    double penetration;    /* [device mm] at which the surface gives way; 0: never; not with layers */
    double scale;          /* physical mm per device mm; 0: fits the workspace; renderer: 0 is that
                              of its transform, which this replaces otherwise */
    double rate;           /* [Hz] 250 to 8000; 0: 1000, or 250 if the device renders no force */
    const char *tool;      /* "sphere:5", "needle", a file, ...; null: a point */
    const char *layers;    /* a file or the name of a built-in set; null: none */
    const double *ranges;  /* low, high, low, high, ... [data units]: only these levels are touched, and
                              a press by `penetration` (0: 1) leads to the next range; null: none.
                              Since 0.3 */
    size_t range_count;    /* pairs, at most 16 */
} palpate_render_options;

/* Place of the device's space: physical = translation + scale * rotation * device. */
typedef struct palpate_transform {
    uint32_t size_of;
    int32_t unused;
    double rotation[9]; /* all 0: identity */
    double translation[3];
    double scale;       /* 0: 1 */
} palpate_transform;

typedef struct palpate_hand {
    uint32_t size_of;
    int32_t invalid;       /* not 0: no force, the proxy stays */
    double time;           /* [s], rising */
    double position[3];    /* [device mm] */
    double orientation[4]; /* x, y, z, w; tool to device axes; all 0: identity */
} palpate_hand;

enum { PALPATE_FREE = 0, PALPATE_CONSTRAINED = 1 };
/* How an update ended: done, to be continued in the next tick, on its way out of the solid, ... */
enum {
    PALPATE_DONE = 0,
    PALPATE_OUT_OF_BUDGET = 1,
    PALPATE_RECOVERING = 2,
    PALPATE_REFUSED = 3,
    PALPATE_NOT_FINITE = 4,
    PALPATE_WAITING = 5 /* for samples of a store: no force */
};

typedef struct palpate_felt {
    uint32_t size_of;
    int32_t mode, status;
    int32_t contacts;      /* points of a tool that touch */
    double time;           /* [s] */
    double hip[3];         /* the hand [mm, physical] */
    double scp[3];         /* the proxy [mm, physical]: draw the tool here */
    double force[3];       /* [N, device axes] */
    double torque[3];      /* [N mm, device axes] */
    double hand[4];        /* orientations x, y, z, w, tool to physical axes */
    double proxy[4];
    double density, isovalue; /* [data units] */
    int32_t layer, inside; /* the touched layer (-1: none), and how many layers contain the proxy */
} palpate_felt;

/* The interpolation is that of the field. transform: may be null. */
PALPATE_API palpate_status palpate_renderer_create(const palpate_field *field,
                                                   const palpate_render_options *options,
                                                   const palpate_transform *transform,
                                                   palpate_renderer **out);
/* Computes a tick. Does not allocate, lock or wait. */
PALPATE_API palpate_status palpate_renderer_render(palpate_renderer *renderer,
                                                   const palpate_hand *hand, palpate_felt *out);
PALPATE_API palpate_status palpate_renderer_set_isovalue(palpate_renderer *renderer,
                                                         double isovalue);
PALPATE_API void palpate_renderer_destroy(palpate_renderer *renderer);

/* ---- Settings by name: of renderers and runs. Since 0.3 ---------------------------------------- */

/* All settings, from the library's own table. palpate_setting_describe() gives the same.
 *   `force.stiffness` [N/mm] Stiffness (default: 0.5).
 *   `force.damping` [N s/mm] Damping along the contact normal (default: 0).
 *   `force.viscosity` [N s/mm] Viscosity of the medium (default: 0).
 *   `force.magnet.distance` [device mm] Distance at which the magnet ends (0: off) (default: 0).
 *   `force.magnet.peak` [N] Force of the magnet at half of that distance (default: 0).
 *   `force.texture.amplitude` [mm, physical] Height of the bumps (0: off) (default: 0).
 *   `force.texture.wavelength` [mm, physical] Distance from one bump to the next (default: 2).
 *   `force.limit` [N] Largest force, within the device's limit (default: 3.3).
 *   `force.rate_limit` [N/s] Largest change of force (default: 2000).
 *   `force.ramp` [s] Duration of the rise of the force from zero at the start (default: 0.25).
 *   `force.stale_after` [s] A longer time between two readings of the device is a pause (default: 0.02).
 *   `force.start_below` [N] No force after a start or a pause until the computed one is this small (inf:
 *       do not wait) (default: inf).
 *   `force.rotational_stiffness` [N mm/rad] Rotational stiffness of a tool (0: from stiffness and the
 *       tool's gyration) (default: 0).
 *   `force.rotational_damping` [N mm s/rad] Rotational damping of a tool (default: 0).
 *   `force.torque_limit` [N mm] Largest torque (default: inf).
 *   `force.torque_rate_limit` [N mm/s] Largest change of torque (default: 200000).
 *   `friction.static_coefficient` Pull along the surface that moves a resting proxy, as a part of the
 *       pull into it (0: none) (default: 0).
 *   `friction.dynamic_coefficient` The same for a moving proxy. At most the static one (default: 0).
 *   `limits.maximum_force` [N] Largest force that the device may get (default: 3.3).
 *   `limits.rate` [Hz] Rate of the servo loop (default: 1000).
 *   `limits.physical_damping` [N s/mm] Damping of device and hand themselves (default: 0.0025).
 *   `limits.maximum_torque` [N mm] Largest torque that the device may get (0: it renders none) (default:
 *       0).
 *   `limits.physical_rotational_damping` [N mm s/rad] Damping of device and hand themselves against
 *       turning (default: 1).
 *   `limits.delay` [s] Time from measuring a position until the force for it acts, without the sampling
 *       (default: 0).
 *   `limits.continuous_force` [N] Force that the motors can give for hours (inf: all that they can give)
 *       (default: inf).
 *   `limits.warming_time` [s] Time in which a constant force brings the motors to 63 % of its warmth
 *       (default: 60).
 */
typedef struct palpate_setting {
    uint32_t size_of;
    int32_t open;       /* 1: `least` itself is not accepted */
    const char *name;   /* texts live as long as the library */
    const char *unit;   /* "" without one */
    const char *about;
    double least, most; /* accepted */
    double usual;       /* the default, if no device asks for less */
} palpate_setting;

PALPATE_API size_t palpate_setting_count(void);
PALPATE_API palpate_status palpate_setting_describe(size_t index, palpate_setting *out);
/* Settings of a renderer. A change has its effect from the next tick on. */
PALPATE_API palpate_status palpate_renderer_get(const palpate_renderer *renderer, const char *name,
                                                double *value);
PALPATE_API palpate_status palpate_renderer_set(palpate_renderer *renderer, const char *name,
                                                double value);

/* ---- Devices ---------------------------------------------------------------------------------- */

typedef struct palpate_device_list palpate_device_list;

typedef struct palpate_device_finding {
    uint32_t size_of;
    int32_t found;       /* it could be opened now */
    const char *name;    /* texts live as long as the list */
    const char *what;    /* what was found */
    const char *missing; /* what was looked for, and what to install */
    const char *options; /* KEY=VALUE options with their defaults */
} palpate_device_finding;

/* Looks for all kinds of devices, which takes up to a second. No device moves. */
PALPATE_API palpate_status palpate_device_list_create(palpate_device_list **out);
PALPATE_API size_t palpate_device_list_count(const palpate_device_list *list);
PALPATE_API palpate_status palpate_device_list_get(const palpate_device_list *list, size_t index,
                                                   palpate_device_finding *out);
PALPATE_API void palpate_device_list_destroy(palpate_device_list *list);

enum {
    PALPATE_DEVICE_STARTING = 0,
    PALPATE_DEVICE_READY = 1,
    PALPATE_DEVICE_UNCALIBRATED = 2,
    PALPATE_DEVICE_STALE = 3,
    PALPATE_DEVICE_LOST = 4,
    PALPATE_DEVICE_FAULT = 5,
    PALPATE_DEVICE_FINISHED = 6
};

typedef struct palpate_reading {
    uint32_t size_of;
    int32_t status;        /* force only while READY */
    double position[3];    /* [device mm] */
    double orientation[4]; /* x, y, z, w; tool to device axes; all 0: identity */
    double age;            /* [s] since the measurement; above 0.02 the reading is stale */
    uint32_t buttons;      /* bit b: button b is held */
    uint32_t unused;
    double opening;        /* [rad] of a gripper, 0: closed; with has_gripper. Since 0.3 */
} palpate_reading;

typedef struct palpate_wrench {
    uint32_t size_of;
    int32_t unused;
    double force[3];  /* [N, device axes] */
    double torque[3]; /* [N mm, device axes] */
} palpate_wrench;

/* A device of your own. Its callbacks run on a thread of their own, never on the servo's, one after
 * the other: read, write, read, ... at `rate`. The newest reading and the newest force are exchanged
 * without waiting. write gets a force of zero when the servo has been silent for 20 ms, and after the
 * run was stopped. `close` (may be null) is the last call, after a zero force. It is called once for
 * each time that the device was opened, also if palpate_run_create() fails afterwards. A pose that is
 * not finite counts as a fault (DEVICE_FAULT), without force. While a callback does not return, your
 * device keeps the last force, so give the device limits of its own. If it returns only after the run
 * was destroyed, write gets a force of zero and `close` is called then: keep the callbacks and `context`
 * until `close`. `read` and `context` tell one device from another. A device is refused (NO_DEVICE) for
 * another run until it is closed. */
typedef struct palpate_own_device {
    uint32_t size_of;
    int32_t buttons;               /* number of buttons */
    const char *name, *model;      /* null: "own" */
    double maximum_force;          /* [N] > 0; never exceeded */
    double maximum_torque;         /* [N mm] 0: it renders none */
    double stiffness;              /* [N/mm] it is rated for; 0: 0.5 */
    double physical_damping;       /* [N s/mm] of device and hand; 0: 0.0025 */
    double workspace_low[3];       /* [device mm]; all 0: -80 */
    double workspace_high[3];      /* all 0: 80 */
    double rate;                   /* [Hz] of the callbacks, 50 to 8000; 0: 1000. It limits the
                                      stiffness: a reading and a force wait up to one period each */
    int32_t has_orientation;
    int32_t has_gripper; /* readings have an opening. Since 0.3 */
    /* Fills in *reading (its size is set, the rest is 0). Returns 0, or another number if the device
     * is lost. */
    int32_t (*read)(palpate_reading *reading, void *context);
    /* Returns 0, or another number if the device is lost. */
    int32_t (*write)(const palpate_wrench *wrench, void *context);
    void (*close)(void *context);
    void *context;
} palpate_own_device;

/* ---- Data: the samples that one or several runs touch, and edits ------------------------------ */

typedef struct palpate_data palpate_data;

enum { PALPATE_CARVE = 0, PALPATE_ADD = 1, PALPATE_SMOOTH = 2, PALPATE_PAINT = 3 };

typedef struct palpate_brush {
    uint32_t size_of;
    int32_t kind;
    double radius;         /* [mm] > 0 */
    double softness;       /* 0: a sharp edge, 1: as wide as the brush */
    double rate;           /* [1/s] of a hand's brush; 0: 10, infinity: at once */
    double level;          /* for a stroke: carve and add shape the surface at this level */
    int32_t solid;         /* for a stroke: which side of `level` is solid */
    int32_t has_value;     /* 0: carve leaves the background, and add a value as far on the other
                              side of the level */
    double value;          /* the value that the brush leaves; always used for strokes and for paint */
    int32_t as_tool;       /* of a hand's brush: it has the shape of the tool, and works as far as `radius`
                              beyond its surface; 0: a ball. Since 0.3 */
    int32_t unused;
} palpate_brush;

typedef struct palpate_edit_state {
    uint32_t size_of;
    int32_t changed;    /* since the start or the last save */
    uint64_t version;   /* as in snapshots */
    uint64_t undo_steps, redo_steps;
} palpate_edit_state;

PALPATE_API palpate_status palpate_data_create(const palpate_volume *volume, palpate_data **out);
/* Sets the brush of every run on this data. It works where the proxy touches. Null: no brush. */
PALPATE_API palpate_status palpate_data_set_brush(palpate_data *data, const palpate_brush *brush);
/* Single edits, each a step for undo. A call returns when the edit was sent to every run. A stroke sweeps
 * a ball from one point to another [mm, physical]. A fill sets the samples from index `low` to index
 * `high`, both included, to a value [data units]. */
PALPATE_API palpate_status palpate_data_stroke(palpate_data *data, const palpate_brush *brush,
                                               const double from[3], const double to[3]);
PALPATE_API palpate_status palpate_data_fill(palpate_data *data, const int32_t low[3],
                                             const int32_t high[3], double value);
/* Puts the samples of another volume into the grid, the first one at `at`, for example of a simulation. */
PALPATE_API palpate_status palpate_data_replace(palpate_data *data, const int32_t at[3],
                                                const palpate_volume *samples);
/* done (may be null): 0 if there was nothing to undo or redo. */
PALPATE_API palpate_status palpate_data_undo(palpate_data *data, int32_t *done);
PALPATE_API palpate_status palpate_data_redo(palpate_data *data, int32_t *done);
PALPATE_API palpate_status palpate_data_edits(const palpate_data *data, palpate_edit_state *out);
/* The samples as they are now, for display and for your own queries. */
PALPATE_API palpate_status palpate_data_field(const palpate_data *data,
                                              const palpate_field_options *options,
                                              palpate_field **out);
PALPATE_API palpate_status palpate_data_save(palpate_data *data, const char *path);
/* Sets the speed of a sequence (1: as recorded, 0: paused), and its time [s]. */
PALPATE_API palpate_status palpate_data_play(palpate_data *data, double speed);
PALPATE_API palpate_status palpate_data_seek(palpate_data *data, double time);
PALPATE_API void palpate_data_destroy(palpate_data *data);

/* ---- Runs: a servo on a device ---------------------------------------------------------------- */
/* Several runs on the same data are the hands of one session. Each feels the edits of the others. If one
 * device fails, the other runs continue. */

typedef struct palpate_run palpate_run;

enum {
    PALPATE_ANTERIOR = 0,
    PALPATE_POSTERIOR = 1,
    PALPATE_LEFT = 2,
    PALPATE_RIGHT = 3,
    PALPATE_SUPERIOR = 4,
    PALPATE_INFERIOR = 5
};

typedef struct palpate_run_options {
    uint32_t size_of;
    int32_t facing;                       /* side of the body that faces the person */
    const palpate_field_options *field;   /* null: the defaults, here and below */
    const palpate_render_options *render;
    const char *device;                   /* "haply", "simulated:touchx,hand=press", ...; null: own,
                                             else simulated */
    const palpate_own_device *own;        /* found under its name; null: none */
    const char *recording;                /* a new file to record into from the start; null: none */
    int32_t no_real_time;                 /* not 0: does not ask for real-time priority */
    int32_t deadman_button;               /* from 1: no force unless it is held; 0: none */
    /* Called from this thread with 0 to 1 during the search for an isovalue, while the device is opened,
     * while a tool is made and while a recording begins. Returns 0 to cancel. Since 0.3. */
    int32_t (*progress)(double fraction, void *context);
    void *context;
    int32_t clutch_button;                /* from 1: moves the volume with the hand while held; 0: button 2,
                                             or 1 if it is the only one; -1: none. Since 0.3 */
} palpate_run_options;

typedef struct palpate_snapshot {
    uint32_t size_of;
    int32_t device_status;
    int64_t number;            /* of the tick, from 0 */
    int64_t missed;            /* deadlines so far */
    uint64_t version;          /* of the samples */
    palpate_felt felt;
    palpate_transform transform;
    double position[3];        /* of the device [device mm] */
    double normal[3];          /* of the surface at the proxy, out of the solid; 0: none */
    double stiffness;          /* [N/mm] in use */
    double moment;             /* [s] of a sequence */
    uint32_t buttons;
    int32_t frozen, clutched, forces_on;
    double opening;            /* [rad] of a gripper, 0: closed; NaN: it has none. Since 0.3 */
} palpate_snapshot;

typedef struct palpate_report {
    uint32_t size_of;
    int32_t device_failed;     /* 1: it threw, 2: it hung; the session has ended without force */
    int64_t ticks, missed, overruns, unrecorded;
    int64_t lateness_p50_ns, lateness_p99_ns, lateness_max_ns;
    int64_t compute_p50_ns, compute_p99_ns, compute_max_ns;
} palpate_report;

enum { PALPATE_TEXT_PROBLEM = 0, PALPATE_TEXT_PRIVILEGES = 1, PALPATE_TEXT_DEVICE = 2 };

/* Opens the device and fits it to the data. Nothing moves before palpate_run_start(). */
PALPATE_API palpate_status palpate_run_create(palpate_data *data, const palpate_run_options *options,
                                              palpate_run **out);
PALPATE_API palpate_status palpate_run_start(palpate_run *run);
/* Sets the force to zero and ends the servo for good. Returns when the device (also one of your own) has
 * got the zero. If it does not answer for half a second, for example because a callback does not return,
 * returns PALPATE_NO_DEVICE: its force may still be on, and it gets the zero as soon as it answers. */
PALPATE_API palpate_status palpate_run_stop(palpate_run *run);
/* Stops, finishes a recording, closes the device. A callback that does not return for a second is left
 * alone with its thread, which closes the device when it returns. */
PALPATE_API void palpate_run_destroy(palpate_run *run);

/* The newest tick. PALPATE_NOTHING_YET before the first. */
PALPATE_API palpate_status palpate_run_snapshot(const palpate_run *run, palpate_snapshot *out);
PALPATE_API palpate_status palpate_run_report(const palpate_run *run, palpate_report *out);
/* Returns a text: a problem of the device, the edits or the recording ("" if there is none), the
 * real-time privileges that were granted (one per line), or the device's model. Writes at most `size`
 * bytes, including the final zero. needed (may be null) gets the size of the whole text. */
PALPATE_API palpate_status palpate_run_text(const palpate_run *run, int32_t which, char *buffer,
                                            size_t size, size_t *needed);

/* The value of a setting as it was last requested. Since 0.3. */
PALPATE_API palpate_status palpate_run_get(const palpate_run *run, const char *name, double *value);

/* Commands, carried out within a tick or two. After palpate_run_stop() they give PALPATE_WRONG_STATE. */
/* Changes a setting. Limits can only be lowered, and the delay can only be raised: other values give
 * PALPATE_INVALID. Since 0.3. */
PALPATE_API palpate_status palpate_run_set(palpate_run *run, const char *name, double value);
PALPATE_API palpate_status palpate_run_set_isovalue(palpate_run *run, double isovalue);
PALPATE_API palpate_status palpate_run_set_forces(palpate_run *run, int32_t on);
PALPATE_API palpate_status palpate_run_set_frozen(palpate_run *run, int32_t on);
PALPATE_API palpate_status palpate_run_set_clutch(palpate_run *run, int32_t on);
/* [physical mm per device mm] */
PALPATE_API palpate_status palpate_run_set_scale(palpate_run *run, double scale);
PALPATE_API palpate_status palpate_run_set_transform(palpate_run *run, const palpate_transform *to);
PALPATE_API palpate_status palpate_run_set_stiffness(palpate_run *run, double newton_per_mm);
/* Both in N s/mm. */
PALPATE_API palpate_status palpate_run_set_damping(palpate_run *run, double damping,
                                                   double viscosity);
PALPATE_API palpate_status palpate_run_set_force_limit(palpate_run *run, double newton);
PALPATE_API palpate_status palpate_run_set_friction(palpate_run *run, double static_coefficient,
                                                    double dynamic_coefficient);
/* [device mm] Threshold at which the surface gives way, to the levels behind the present one; 0: never. */
PALPATE_API palpate_status palpate_run_set_penetration(palpate_run *run, double threshold);
/* Only `count` ranges of levels are touched, as in palpate_render_options. Since 0.3. */
PALPATE_API palpate_status palpate_run_set_ranges(palpate_run *run, double threshold,
                                                  const double *ranges, size_t count);
/* These two: as in palpate_render_options; null: none. */
PALPATE_API palpate_status palpate_run_set_tool(palpate_run *run, const char *tool);
PALPATE_API palpate_status palpate_run_set_layers(palpate_run *run, const char *layers);
/* The same for the present surfaces with other levels or properties: surfaces that gave way stay open.
 * Since 0.3. */
PALPATE_API palpate_status palpate_run_change_layers(palpate_run *run, const char *layers);

/* Lifts the hand off: the proxy leaves anything that holds it, such as a closed shell, and starts at the
 * hand. The force starts again. Since 0.3. */
PALPATE_API palpate_status palpate_run_lift(palpate_run *run);

/* Continues with another device and with all settings requested so far. NO_DEVICE if that cannot be
 * opened; and if the device before does not answer, whose force may then still be on. WRONG_STATE after
 * palpate_run_stop(). */
PALPATE_API palpate_status palpate_run_use_device(palpate_run *run, const char *device);
/* Records into a new file. An existing file is refused. The session and its force continue. */
PALPATE_API palpate_status palpate_run_record(palpate_run *run, const char *path);
/* The same for several runs on the same data, into one file: they are its hands, in this order. The file
 * is complete when the last of them has stopped its recording. Since 0.3. */
PALPATE_API palpate_status palpate_run_record_together(palpate_run *const *runs, size_t count,
                                                       const char *path);
/* ticks (may be null): how many were recorded. The reader of a pipe that reads slowly is waited for until
 * the progress function cancels, or for half a second without one. */
PALPATE_API palpate_status palpate_run_stop_recording(palpate_run *run, int64_t *ticks);
/* Sets the target of the hand of the device "mouse" [device mm]. */
PALPATE_API palpate_status palpate_run_aim(palpate_run *run, const double position[3]);

#ifdef __cplusplus
}
#endif

#endif
