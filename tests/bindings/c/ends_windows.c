/* However a program ends on Windows, the force is zero: a device written in C, on which the servo
 * presses, in a program that crashes, aborts, raises an exception or stops the run. The test starts
 * itself once for each end and looks at what reached the device last.
 *
 *   ends_windows [SECONDS]    all ends; the run that is stopped lasts SECONDS (1) */
#include <math.h>
#include <palpate.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <windows.h>

/* What the device shares with the test. */
struct motors {
    volatile double last; /* [N] the newest force */
    volatile double most; /* [N] */
    volatile LONG writes;
    volatile LONG closed;
};

static struct motors *shared_motors(const char *name) {
    HANDLE memory = CreateFileMappingA(INVALID_HANDLE_VALUE, NULL, PAGE_READWRITE, 0,
                                       sizeof(struct motors), name);
    return memory ? MapViewOfFile(memory, FILE_MAP_ALL_ACCESS, 0, 0, 0) : NULL;
}

static void require(int is_true, const char *what) {
    if (is_true) return;
    fprintf(stderr, "%s: %s\n", what, palpate_last_error());
    exit(1);
}

/* ---- The program that ends -------------------------------------------------------------------- */

/* The hand comes to the ball of 20 mm along z and stops 4 mm in it. If it feels nothing there, it comes
 * anew: a force begins small, so after a stall of the machine there is none deep inside. */
static int32_t read_hand(palpate_reading *reading, void *context) {
    static double place = 30, step = -0.02;
    const struct motors *motors = context;
    if (place <= 16 && motors->last == 0) step = 0.02;
    if (place >= 30) step = -0.02;
    if (place > 16 || step > 0) place += step;
    reading->status = PALPATE_DEVICE_READY;
    reading->position[2] = place;
    return 0;
}

static int32_t write_force(const palpate_wrench *wrench, void *context) {
    struct motors *motors = context;
    const double *f = wrench->force;
    const double size = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
    motors->last = size;
    if (size > motors->most) motors->most = size;
    InterlockedIncrement(&motors->writes);
    return 0;
}

static void close_device(void *context) {
    ((struct motors *)context)->closed = 1;
}

static volatile int zero, *volatile nowhere;

static int run_out_of_stack(volatile int depth) {
    volatile char much[4096];
    much[depth % 4096] = 1;
    if (depth < 0) return 0; /* never */
    return run_out_of_stack(depth + 1) + much[0];
}

static DWORD WINAPI write_nowhere(void *unused) {
    (void)unused;
    return (DWORD)(*nowhere = 1);
}

static void end_by(const char *how) {
    if (!strcmp(how, "access")) *nowhere = 1;
    if (!strcmp(how, "division")) zero = 7 / zero;
    if (!strcmp(how, "stack")) zero = run_out_of_stack(1);
    if (!strcmp(how, "raised")) RaiseException(0xE0001234, EXCEPTION_NONCONTINUABLE, 0, NULL);
    if (!strcmp(how, "abort")) abort();
    if (!strcmp(how, "thread")) {
        WaitForSingleObject(CreateThread(NULL, 0, write_nowhere, NULL, 0, NULL), INFINITE);
    }
}

static palpate_data *ball(void) {
    enum { SIDE = 64 };
    static float samples[SIDE * SIDE * SIDE];
    palpate_volume *volume = NULL;
    palpate_data *data = NULL;
    PALPATE_STRUCT(palpate_geometry, geometry);
    for (int n = 0; n < SIDE * SIDE * SIDE; ++n) {
        const double x = n % SIDE - 31.5, y = n / SIDE % SIDE - 31.5, z = n / (SIDE * SIDE) - 31.5;
        samples[n] = (float)(200 - 5 * sqrt(x * x + y * y + z * z));
    }
    for (int i = 0; i < 3; ++i) {
        geometry.size[i] = SIDE;
        geometry.origin[i] = -31.5;
    }
    require(palpate_volume_copy(&geometry, PALPATE_FLOAT32, samples, sizeof samples, &volume) ==
                PALPATE_OK,
            "volume");
    require(palpate_data_create(volume, &data) == PALPATE_OK, "data");
    palpate_volume_destroy(volume);
    return data;
}

static void press_and_end(struct motors *motors, const char *how, double seconds) {
    palpate_data *data = ball();
    palpate_run *run = NULL;
    PALPATE_STRUCT(palpate_own_device, own);
    PALPATE_STRUCT(palpate_render_options, render);
    PALPATE_STRUCT(palpate_run_options, options);
    PALPATE_STRUCT(palpate_report, report);
    own.read = read_hand;
    own.write = write_force;
    own.close = close_device;
    own.context = motors;
    own.maximum_force = 2;
    render.has_isovalue = 1;
    render.isovalue = 100;
    render.scale = 1;
    render.stiffness = 0.4;
    options.own = &own;
    options.render = &render;
    require(palpate_run_create(data, &options, &run) == PALPATE_OK, "run");
    require(palpate_run_start(run) == PALPATE_OK, "start");
    /* On a busy machine a reading may be older than 20 ms every time, and the force would never rise. */
    require(palpate_run_set(run, "force.stale_after", 3600) == PALPATE_OK, "stale_after");
    while (motors->last < 1) Sleep(10); /* however long a busy machine takes */
    Sleep((DWORD)(1000 * seconds));
    end_by(how);
    require(palpate_run_report(run, &report) == PALPATE_OK, "report");
    palpate_run_destroy(run);
    palpate_data_destroy(data);
    printf("%ld ticks, %ld missed, lateness %.2f ms at most\n", (long)report.ticks,
           (long)report.missed, 1e-6 * (double)report.lateness_max_ns);
    require(report.device_failed == 0 && motors->closed, "the device was closed in good order");
}

/* ---- The test --------------------------------------------------------------------------------- */

/* Starts this program to end in a way; its exit status. */
static DWORD status_of(const char *how, const char *memory, const char *seconds) {
    char program[MAX_PATH], line[3 * MAX_PATH];
    STARTUPINFOA start = {.cb = sizeof start};
    PROCESS_INFORMATION process;
    DWORD status = 0;
    GetModuleFileNameA(NULL, program, sizeof program);
    snprintf(line, sizeof line, "\"%s\" %s %s %s", program, how, memory, seconds);
    if (!CreateProcessA(program, line, NULL, NULL, FALSE, 0, NULL, NULL, &start, &process)) {
        fprintf(stderr, "%s cannot be started\n", program);
        exit(1);
    }
    WaitForSingleObject(process.hProcess, INFINITE);
    GetExitCodeProcess(process.hProcess, &status);
    CloseHandle(process.hThread);
    CloseHandle(process.hProcess);
    return status;
}

static int ends_without_force(const char *how, DWORD wanted, const char *seconds) {
    char name[64];
    snprintf(name, sizeof name, "palpate-ends-%lu-%s", (unsigned long)GetCurrentProcessId(), how);
    struct motors *motors = shared_motors(name);
    if (!motors) return 0;
    const DWORD status = status_of(how, name, seconds);
    const int good = status == wanted && motors->most >= 1 && motors->last == 0;
    printf("%-9s status 0x%lx, %ld forces, largest %.2f N, last %.2f N%s\n", how,
           (unsigned long)status, (long)motors->writes, motors->most, motors->last,
           good ? "" : "  <-- wrong");
    fflush(stdout);
    return good;
}

int main(int count, char **words) {
    static const struct {
        const char *how;
        DWORD status;
    } ends[] = {{"stopped", 0},           {"access", EXCEPTION_ACCESS_VIOLATION},
                {"thread", EXCEPTION_ACCESS_VIOLATION},
                {"division", EXCEPTION_INT_DIVIDE_BY_ZERO},
                {"stack", EXCEPTION_STACK_OVERFLOW},
                {"raised", 0xE0001234},   {"abort", 3}};
    int all_good = 1;
    SetErrorMode(SEM_NOGPFAULTERRORBOX | SEM_FAILCRITICALERRORS);
    if (count == 4) {
        struct motors *motors = shared_motors(words[2]);
        require(motors != NULL, "shared memory");
        press_and_end(motors, words[1], atof(words[3]));
        return 0;
    }
    for (size_t i = 0; i < sizeof ends / sizeof *ends; ++i) {
        const char *seconds = i == 0 && count > 1 ? words[1] : "0.2";
        all_good &= ends_without_force(ends[i].how, ends[i].status, seconds);
    }
    return all_good ? 0 : 1;
}
