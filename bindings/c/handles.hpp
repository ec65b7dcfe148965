// The contents of the handles of the C interface.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "bindings/c/status.hpp"
#include "palpate-c/palpate.h"
#include "palpate/devices/devices.hpp"
#include "palpate/run/run.hpp"
#include "palpate/surface.hpp"

struct palpate_volume {
    palpate::run::LoadedVolume loaded;
};
struct palpate_field {
    palpate::Field field;
    std::optional<double> isovalue;  ///< one that is worth feeling
};
struct palpate_mesh {
    palpate::SurfaceMesh mesh;
};
struct palpate_renderer {
    palpate::Renderer renderer;
};
struct palpate_device_list {
    std::vector<palpate::devices::DeviceFinding> findings;
};
struct palpate_data {
    std::shared_ptr<palpate::run::Data> data;
};
struct palpate_run {
    /// Of calls from outside; the servo never takes it.
    mutable std::mutex mutex;
    std::shared_ptr<palpate::run::Data> data;
    std::unique_ptr<palpate::run::Run> run;
    std::string own_device;  ///< its name; empty: none
};

namespace palpate::c {

/// The run for this call alone. A callback does not wait for it: a call that holds the run may be
/// waiting for the callback.
inline std::unique_lock<std::mutex> locked(const palpate_run* run) {
    std::mutex& mutex = given(run, "run").mutex;
    if (!calls_back) return std::unique_lock(mutex);
    std::unique_lock lock(mutex, std::try_to_lock);
    if (!lock) throw WrongState("another call uses the run, and a callback does not wait for it");
    return lock;
}

}  // namespace palpate::c
