// Live runs of the C interface.
#include <algorithm>
#include <functional>
#include <limits>
#include <vector>

#include "bindings/c/handles.hpp"
#include "bindings/c/own_device.hpp"
#include "bindings/c/structs.hpp"
#include "palpate/devices/error.hpp"
#include "palpate/run/no_effect.hpp"

namespace palpate::c {
namespace {

void choose_device(const palpate_run_options& asked, run::Setup& setup) {
    if (asked.own) {
        const palpate_own_device own = taken(asked.own, "own");
        const std::string name = name_of(own);
        setup.device = {name, {}};
        // The caller's texts need not live as long.
        setup.open_device = [own, name, model = std::string(own.model ? own.model : name)](
                                const devices::DeviceChoice& choice,
                                const devices::DeviceScene& scene) -> std::unique_ptr<Device> {
            if (choice.name != name) return devices::open_device(choice, scene);
            palpate_own_device named = own;
            named.name = name.c_str();
            named.model = model.c_str();
            return make_own_device(named);
        };
    }
    if (asked.device && setup.device.name != asked.device) {  // own names may have a colon
        setup.device = devices::parse_device(asked.device);
    }
}

void choose_button(const char* member, std::int32_t number, run::ButtonSetup& button) {
    if (number == 0) return;
    button = run::button_from(member, number == -1 ? "none" : std::to_string(number));
}

run::Setup setup_from(const palpate_run_options& asked) {
    const auto render = taken_or_default(asked.render, "render");
    run::Setup setup;
    setup.field = field_setup(asked.field);
    setup.render = render_setup(render);
    setup.render.force.start_below = run::live_start_below;
    if (render.has_isovalue) setup.field.isovalue = render.isovalue;
    run::refuse_without_effect(run::without_effect(setup.render),
                               {{"isovalue", render.has_isovalue != 0}});
    setup.facing = one_of<Facing>(asked.facing, "facing");
    setup.real_time = asked.no_real_time == 0;
    choose_button("clutch_button", asked.clutch_button, setup.buttons.clutch);
    choose_button("deadman_button", asked.deadman_button, setup.buttons.deadman);
    choose_device(asked, setup);
    return setup;
}

palpate_snapshot snapshot_from(const Snapshot& from) {
    const SessionTick& tick = from.session;
    auto to = sized<palpate_snapshot>();
    to.device_status = static_cast<std::int32_t>(tick.device.status);
    to.number = from.number;
    to.missed = from.missed;
    to.version = tick.version;
    to.felt = felt_from(tick.tick);
    to.transform = transform_to(tick.transform);
    put(tick.device.position, to.position);
    put(from.normal, to.normal);
    to.stiffness = from.stiffness;
    to.moment = tick.moment;
    to.buttons = tick.device.buttons;
    to.frozen = tick.frozen;
    to.clutched = tick.clutched;
    to.forces_on = from.forces_on;
    to.opening = tick.device.opening.value_or(std::numeric_limits<double>::quiet_NaN());
    return to;
}

std::string text_of(const run::Run& run, std::int32_t which) {
    std::string text;
    if (which == PALPATE_TEXT_DEVICE) return run.device().model;
    if (which == PALPATE_TEXT_PROBLEM) {
        text = run.device_problem();
        if (text.empty()) text = run.data().problem();
        if (text.empty() && run.recording()) text = run.recording()->problem();
    } else if (which != PALPATE_TEXT_PRIVILEGES) {
        throw std::invalid_argument("which: there is no such text");
    } else if (run.started()) {
        for (const std::string& line : run.privileges()) text += line + '\n';
    }
    return text;
}

}  // namespace

extern "C" PALPATE_API palpate_status palpate_run_create(palpate_data* data,
                                                         const palpate_run_options* options,
                                                         palpate_run** out) {
    return guarded([&] {
        given(out, "out");
        const auto asked = taken_or_default(options, "options");
        auto made = std::make_unique<palpate_run>();
        made->data = given(data, "data").data;
        const OnProgress progress = progress_of(asked, "the run was cancelled");
        made->run = std::make_unique<run::Run>(made->data, setup_from(asked), progress);
        if (asked.own) made->own_device = name_of(taken(asked.own, "own"));
        if (asked.recording) made->run->record(asked.recording, progress);
        *out = made.release();
    });
}

extern "C" PALPATE_API palpate_status palpate_run_start(palpate_run* run) {
    return guarded([&] {
        const auto lock = locked(run);
        run->run->start();
    });
}

extern "C" PALPATE_API palpate_status palpate_run_stop(palpate_run* run) {
    return guarded([&] {
        const auto lock = locked(run);
        run->run->stop();
        const std::string unanswered = run->run->unanswered();
        if (!unanswered.empty()) throw devices::DeviceError(unanswered);
    });
}

extern "C" PALPATE_API void palpate_run_destroy(palpate_run* run) {
    delete run;
}

extern "C" PALPATE_API palpate_status palpate_run_snapshot(const palpate_run* run,
                                                           palpate_snapshot* out) {
    return guarded([&] {
        size_of(given(out, "out"), "out");
        std::optional<Snapshot> snapshot;
        {
            const auto lock = locked(run);
            snapshot = run->run->snapshot();
        }
        if (!snapshot) throw NothingYet("there was no tick yet");
        give(out, "out", snapshot_from(*snapshot));
    });
}

extern "C" PALPATE_API palpate_status palpate_run_report(const palpate_run* run,
                                                         palpate_report* out) {
    return guarded([&] {
        const auto lock = locked(run);
        const ServoReport from = run->run->report();
        auto to = sized<palpate_report>();
        to.device_failed = static_cast<std::int32_t>(run->run->device_failure());
        to.ticks = from.ticks;
        to.missed = from.missed;
        to.overruns = from.overruns;
        to.unrecorded = from.unrecorded;
        to.lateness_p50_ns = from.lateness.p50;
        to.lateness_p99_ns = from.lateness.p99;
        to.lateness_max_ns = from.lateness.max;
        to.compute_p50_ns = from.compute.p50;
        to.compute_p99_ns = from.compute.p99;
        to.compute_max_ns = from.compute.max;
        give(out, "out", to);
    });
}

extern "C" PALPATE_API palpate_status palpate_run_text(const palpate_run* run, int32_t which,
                                                       char* buffer, size_t size, size_t* needed) {
    return guarded([&] {
        const auto lock = locked(run);
        const std::string text = text_of(*run->run, which);
        if (size > 0) {
            const std::size_t length = std::min(text.size(), size - 1);
            std::memcpy(&given(buffer, "buffer"), text.data(), length);
            buffer[length] = '\0';
        }
        if (needed) *needed = text.size() + 1;
    });
}

extern "C" PALPATE_API palpate_status palpate_run_use_device(palpate_run* run, const char* device) {
    return guarded([&] {
        if (calls_back) throw WrongState("a callback cannot change the device: use another thread");
        const auto lock = locked(run);
        const std::string name = &given(device, "device");
        const bool is_own = !run->own_device.empty() && name == run->own_device;
        run->run->use_device(is_own ? devices::DeviceChoice{name, {}} : devices::parse_device(name),
                             progress_of_thread());
        const std::string& before = run->run->left_behind();
        if (!before.empty()) throw devices::DeviceError(before + "; the run has the new device");
    });
}

extern "C" PALPATE_API palpate_status palpate_run_record(palpate_run* run, const char* path) {
    return guarded([&] {
        const auto lock = locked(run);
        run->run->record(&given(path, "path"), progress_of_thread());
    });
}

extern "C" PALPATE_API palpate_status palpate_run_record_together(palpate_run* const* runs,
                                                                  size_t count, const char* path) {
    return guarded([&] {
        given(runs, "runs");
        std::vector<palpate_run*> all;
        for (std::size_t i = 0; i < count; ++i) all.push_back(&given(runs[i], "runs"));
        std::vector<run::Run*> hands;
        for (palpate_run* const one : all) hands.push_back(one->run.get());
        // In one order for all threads.
        std::ranges::sort(all, std::less<>());
        if (std::ranges::adjacent_find(all) != all.end()) {
            throw std::invalid_argument("runs: one is there twice");
        }
        std::vector<std::unique_lock<std::mutex>> locks;
        for (palpate_run* const one : all) locks.push_back(locked(one));
        run::Run::record_together(hands, &given(path, "path"), progress_of_thread());
    });
}

extern "C" PALPATE_API palpate_status palpate_run_stop_recording(palpate_run* run, int64_t* ticks) {
    return guarded([&] {
        const auto lock = locked(run);
        const std::int64_t recorded = run->run->stop_recording(progress_of_thread());
        if (ticks) *ticks = recorded;
    });
}

extern "C" PALPATE_API palpate_status palpate_run_aim(palpate_run* run, const double position[3]) {
    return guarded([&] {
        const auto lock = locked(run);
        if (!run->run->mouse()) throw WrongState("the device is not the mouse");
        run->run->mouse()->aim(vec3(&given(position, "position")));
    });
}

}  // namespace palpate::c
