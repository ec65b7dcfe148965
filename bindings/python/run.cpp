// Live runs: a device by name, data that may be edited or played, recordings.
#include "palpate/run/run.hpp"

#include <exception>
#include <mutex>
#include <utility>

#include "bindings/python/arrays.hpp"
#include "bindings/python/bindings.hpp"
#include "bindings/python/commands.hpp"
#include "bindings/python/edited_data.hpp"
#include "bindings/python/progress.hpp"
#include "bindings/python/python_device.hpp"
#include "bindings/python/record.hpp"
#include "bindings/python/without_gil.hpp"
#include "palpate/io/error.hpp"
#include "palpate/run/no_effect.hpp"

namespace palpate::python {
namespace {

using Unlocked = py::call_guard<GilReleased>;
constexpr double usual_device_rate = 1000;  // [Hz]
namespace fs = std::filesystem;

struct Setup : run::Setup {
    RenderSetup asked;  ///< in place of its `render`
};

run::Setup live_setup(const Setup& given) {
    run::Setup setup = given;
    ForceSettings usual;
    usual.start_below = run::live_start_below;
    setup.render = setup_of(given.asked, usual);
    return setup;
}

using GivenButton = std::optional<std::variant<int, std::string>>;

/// By its number or as in files. Nothing: what it is by default.
template <class Setting>
void add_button(Record<Setup>& record, const Setting& one) {
    const auto get = [one](const Setup& s) -> GivenButton {
        const run::ButtonSetup& button = s.buttons.*one.member;
        if (const auto* numbered = std::get_if<run::Button>(&button)) return numbered->number;
        if (button == run::Buttons{}.*one.member) return std::nullopt;
        return run::text_of(button);
    };
    const auto set = [one](Setup& s, const GivenButton& given) {
        run::ButtonSetup button = run::Buttons{}.*one.member;
        if (given) {
            const auto* number = std::get_if<int>(&*given);
            button = run::button_from(
                one.name, number ? std::to_string(*number) : std::get<std::string>(*given));
        }
        s.buttons.*one.member = button;
    };
    record.property(one.name, get, set, text_of(one).c_str());
}

/// The bits of buttons follow from clutch and dead-man switch.
void add_number(Record<Setup>&, const Setting<SessionSettings, std::uint32_t>&) {}
void add_number(Record<Setup>& record, const Setting<SessionSettings, double>& one) {
    const auto get = [one](const Setup& s) { return s.session.*one.member; };
    const auto set = [one](Setup& s, double value) {
        check_range(one, value);
        s.session.*one.member = value;
    };
    record.property(one.name, get, set, text_of(one).c_str());
}

void bind_setup(py::module_& module) {
    using S = Setup;
    using F = run::FieldSetup;
    Record<S> record(module, "Setup", "How a volume is felt live; what is None is filled in.");
    record.part("solid", "'above' or 'below' the isovalue.", &S::field, &F::solid)
        .part("background", Ranged{"Level outside the data, or None.", ranges::finite}, &S::field,
              &F::background)
        .part("isovalue",
              Ranged{"A number [data units], '53%', or None: a suggested one.", ranges::any},
              &S::field, &F::isovalue)
        .part("interpolation", "'linear', 'cubic' or None: as the method.", &S::field,
              &F::interpolation)
        .field("render", &S::asked, "RenderSetup")
        .property(
            "device", [](const S& s) { return run::text_of(s.device); },
            [](S& s, const std::string& text) {
                const devices::DeviceChoice choice = devices::parse_device(text);
                const std::vector<std::string> names = devices::device_names();
                if (std::ranges::find(names, choice.name) == names.end()) {
                    throw std::invalid_argument("there is no device '" + choice.name +
                                                "': " + use_one_of(names, choice.name));
                }
                s.device = choice;
            },
            "As for --device: 'simulated', 'haply:port=10001', ...")
        .field("facing", &S::facing, "The side of the body that faces the person.");
    for_each_setting<run::Buttons>([&](const auto& one) { add_button(record, one); });
    for_each_setting<SessionSettings>([&](const auto& one) { add_number(record, one); });
    using P = run::PlaybackSetup;
    using L = io::LoaderSettings;
    record
        .part("speed", Ranged{"Of a sequence, at the start.", ranges::speed}, &S::playback,
              &P::speed)
        .part("loop", "A sequence begins again.", &S::playback, &P::loader, &L::loop)
        .part("memory_bytes", Ranged{"For frames of a sequence.", ranges::any}, &S::playback,
              &P::loader, &L::memory_bytes)
        .field("real_time", &S::real_time, "Ask for real-time priority.")
        .done();
}

struct LiveRun : run::Run {
    LiveRun(const std::shared_ptr<EditedData>& its_data, const run::Setup& setup,
            PythonDevice* its_device)
        : Run({its_data, &its_data->data}, setup, ctrl_c()),
          edited(its_data),
          python_device(its_device) {}

    /// False if the device's thread goes on for good (PythonDevice::finish()). A recording ends in
    /// any case.
    bool finish() {
        stop();
        const bool ended = !python_device || python_device->finish();
        const std::lock_guard lock(finishing_);
        if (!recording()) return ended;
        try {
            ticks_recorded_ = stop_recording(ended ? ctrl_c() : OnProgress{});
        } catch (const io::OutputError&) {  // it is cut off: stop_recording() raises it
            unfinished_ = std::current_exception();
        }
        return ended;
    }

    /// Also after finish(): then the ticks of the recording that it ended, once.
    std::int64_t end_of_recording() {
        const std::lock_guard lock(finishing_);
        if (const auto error = std::exchange(unfinished_, nullptr)) std::rethrow_exception(error);
        if (recording()) return stop_recording(ctrl_c());
        return std::exchange(ticks_recorded_, 0);
    }

    /// For calls that have no effect in a forked child. Throws std::logic_error there.
    LiveRun& here() {
        process.check();
        return *this;
    }

    OwnProcess process;
    const std::shared_ptr<EditedData> edited;
    PythonDevice* const python_device;  ///< where the device is written in Python, the run's own

  private:
    std::mutex finishing_;
    std::int64_t ticks_recorded_ = 0;
    std::exception_ptr unfinished_;
};

bool is_store(py::handle what) {
    return py::isinstance(what, py::module_::import("palpate._palpate").attr("Store"));
}
bool can_be_felt(PyObject* what) {
    return py::isinstance<run::LoadedVolume>(what) || py::isinstance<Volume>(what) ||
           is_store(what) || py::isinstance<LiveRun>(what);
}

}  // namespace

/// The data of a Run. A Store is not converted implicitly, because errors in reading would be lost.
struct Feelable : py::object {
    PYBIND11_OBJECT(Feelable, py::object, can_be_felt)
};

}  // namespace palpate::python

template <>
struct pybind11::detail::handle_type_name<palpate::python::Feelable> {
    static constexpr auto name = const_name(
        "Union[palpate._palpate.LoadedVolume, palpate._palpate.Volume, "
        "palpate._palpate.Store, palpate._palpate.Run]");
};

namespace palpate::python {
namespace {

/// For a Run, returns its data, which is then shared.
std::shared_ptr<EditedData> data_from(const Feelable& what, const run::PlaybackSetup& playback) {
    if (py::isinstance<LiveRun>(what)) {
        const auto& other = what.cast<const LiveRun&>();
        other.process.check();
        return other.edited;
    }
    const py::module_ module = py::module_::import("palpate._palpate");
    const auto loaded = is_store(what) ? module.attr("LoadedVolume")(what).cast<run::LoadedVolume>()
                                       : what.cast<run::LoadedVolume>();
    return made_edited_data(loaded, playback);
}

/// Throws std::invalid_argument for settings that change nothing: only the first run on a sequence
/// decides on its playback.
void check_playback(const Setup& given, const Feelable& what, const run::Data& data) {
    const bool is_shared = py::isinstance<LiveRun>(what);
    if (data.is_sequence() && !is_shared) return;
    const run::PlaybackSetup usual, &now = given.playback;
    run::refuse_without_effect(
        {{{"speed", "loop", "memory_bytes"},
          is_shared ? "the run that this one shares its data with has set this; use play()"
                    : "this is no sequence"}},
        {{"speed", now.speed != usual.speed},
         {"loop", now.loader.loop != usual.loader.loop},
         {"memory_bytes", now.loader.memory_bytes != usual.loader.memory_bytes}});
}

std::shared_ptr<LiveRun> make(const Feelable& what, const std::optional<Setup>& given,
                              const py::object& device, double device_rate) {
    run::Setup setup = live_setup(given.value_or(Setup{}));
    run::refuse_without_effect(run::without_effect(setup.render),
                               {{"isovalue", setup.field.isovalue.has_value()}});
    run::refuse_without_effect(
        {{{"Setup.device"}, "the device in Python is used"}},
        {{"Setup.device", !device.is_none() && setup.device != run::Setup{}.device}});
    run::refuse_without_effect(
        {{{"device_rate"}, "there is no device in Python"}},
        {{"device_rate", device.is_none() && device_rate != usual_device_rate}});
    std::shared_ptr<EditedData> data = data_from(what, setup.playback);
    if (given) check_playback(*given, what, data->data);
    PythonDevice* python_device = nullptr;
    if (!device.is_none()) {
        // Made here, with the GIL: copies of the setup must not hold a Python object.
        const auto made = std::make_shared<std::unique_ptr<PythonDevice>>(
            make_python_device(device, device_rate));
        python_device = made->get();
        setup.device = {python_device->info().name, {}};
        setup.open_device = [made](const auto&, const auto&) { return std::move(*made); };
    }
    const std::shared_ptr<LiveRun> made(
        without_gil([&] { return new LiveRun(data, setup, python_device); }),
        &destroy_session<LiveRun>);
    warn_of_level(given.value_or(Setup{}).asked, made->field(), made->isovalue(), 2);
    if (const auto& layers = made->setup().render.layers) {
        warn(without_gil([&] { return run::layers_warning(*layers, made->data().loaded()); }), 2);
    }
    return made;
}

void bind_playback(py::class_<LiveRun, std::shared_ptr<LiveRun>>& run) {
    using R = LiveRun;
    run.def(
           "play", [](R& r, double speed) { r.here().data().player().play(speed); },
           py::arg("speed"), Unlocked(),
           "Plays a sequence at this speed, in seconds of it per second; 0 pauses.")
        .def(
            "seek", [](R& r, double time) { r.here().data().player().seek(time); }, py::arg("time"),
            Unlocked(), "Goes to a time of the sequence [s].")
        .def_property_readonly(
            "problem",
            [](const R& r) {
                const GilReleased unlocked;
                const std::string device = r.device_problem();
                return device.empty() ? r.data().problem() : device;
            },
            "What is wrong with device, edits or frames; usually empty.");
}

void bind_editing(py::class_<LiveRun, std::shared_ptr<LiveRun>>& run) {
    using R = LiveRun;
    run.def(
           "edit", [](R& r, const Edit& edit) { r.here().data().editor().apply(edit, ctrl_c()); },
           py::arg("edit"), Unlocked(),
           "Makes an edit (Stroke, Sweep, Fill, Replace): one undo step.")
        .def(
            "undo", [](R& r) { return r.here().data().editor().undo(ctrl_c()); }, Unlocked(),
            "False if there is nothing to undo.")
        .def(
            "redo", [](R& r) { return r.here().data().editor().redo(ctrl_c()); }, Unlocked(),
            "False if there is nothing to redo.")
        .def(
            "set_brush",
            [](R& r, const std::optional<run::HandBrush>& brush) {
                r.here().data().editor().set_brush(brush);
            },
            py::arg("brush"), Unlocked(), "A HandBrush that follows the proxy; None: only feel.")
        .def(
            "save", [](R& r, const fs::path& path) { return r.edited->save(path); },
            py::arg("path"), Unlocked(), "Writes the samples as they are now. Raises OutputError.");
}

void record_together(const std::vector<std::shared_ptr<LiveRun>>& runs, const fs::path& path) {
    std::vector<run::Run*> hands;
    for (const auto& one : runs) hands.push_back(&one->here());
    run::Run::record_together(hands, path, ctrl_c());
}

void send(LiveRun& r, const Sent& sent) {
    const Field field = r.here().field_now();
    r.send(command_of(sent, field, r.isovalue(), r.settings().force));
}

}  // namespace

void bind_run(py::module_& module) {
    tell_at_exit(module);
    bind_setup(module);
    using R = LiveRun;
    py::class_<R, std::shared_ptr<R>> live(
        module, "Run",
        "A live run: a servo with its device, data and recording. Use it as a context manager.\n"
        "By one thread at a time. Edits that were not saved when the last run on their data goes,\n"
        "or when the program ends, are a ResourceWarning. After an error they are kept in a new\n"
        "folder for temporary files, and a UserWarning names the file: if a save() or a with "
        "block\n"
        "failed, or an exception ended the program.");
    live.def(py::init(&make), py::arg("loaded"), py::arg("setup") = py::none(), py::kw_only(),
             py::arg("device") = py::none(), py::arg("device_rate") = usual_device_rate,
             "loaded: from load(), a Volume, a Store, or another Run: then both are hands in the\n"
             "same data, and each feels what the other edits. setup: Setup, by default Setup().\n"
             "device: one that is written in Python, as for a Servo, in place of the setup's;\n"
             "device_rate [Hz]: how often it is asked; it limits the stiffness, too.\n"
             "Opens the device; nothing moves before start(). Raises ValueError, InputError,\n"
             "DeviceError.")
        .def("send", &send, py::arg("command"), Unlocked(),
             "As Servo.send(). Raises ValueError, QueueFull.")
        .def(
            "record", [](R& r, const fs::path& path) { r.here().record(path, ctrl_c()); },
            py::arg("path"), Unlocked(), "Records from now on, to a new file. Raises OutputError.")
        .def(
            "stop_recording", [](R& r) { return r.here().end_of_recording(); }, Unlocked(),
            "The number of its ticks. The session goes on. Ctrl-C ends the wait for a pipe that is "
            "read\nslowly. stop() does the same, and the number can be asked for afterwards.")
        .def("field", &R::field_now, Unlocked(), "A copy of the Field felt, edits included.")
        .def_property_readonly("device", &R::device, "DeviceInfo")
        .def_property_readonly("isovalue", &R::isovalue,
                               "The isovalue that was asked for last [data units].");
    add_session(live);
    bind_playback(live);
    bind_editing(live);
    module.def(
        "record_together", &record_together, py::arg("runs"), py::arg("path"), Unlocked(),
        "Records several Runs on the same data into one new file, as its hands 1, 2, ... Each "
        "ends with\nits stop_recording(); the file is whole after the last. Raises OutputError, "
        "ValueError.");
}

}  // namespace palpate::python
