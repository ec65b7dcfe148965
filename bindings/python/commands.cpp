// The classes of palpate.command.
#include "bindings/python/commands.hpp"

#include "bindings/python/bindings.hpp"
#include "bindings/python/record.hpp"
#include "palpate/io/layers_file.hpp"
#include "palpate/run/no_effect.hpp"

namespace palpate::python {
namespace {

struct MakeCommand {
    const Field& field;
    double isovalue;
    const ForceSettings& usual;

    Command operator()(const AskedForce& asked) const { return force_of(asked, usual); }
    Command operator()(const PressThrough& press) const {
        return penetrability_for(press, field, isovalue);
    }
    Command operator()(const auto& command) const { return command; }
};

/// A command of one value.
template <class C, class Value>
void bind(py::module_& names, const char* name, const char* argument, Value C::*member,
          const char* about, const ValueRange& range = ranges::any) {
    py::class_<C>(names, name, about)
        .def(py::init([=](Value value) {
                 if constexpr (HasNumbers<Value>) check_numbers(argument, value, range);
                 C command{};
                 command.*member = value;
                 return command;
             }),
             py::arg(argument))
        .def_readonly(argument, member);
}

}  // namespace

Command command_of(const Sent& sent, const Field& field, double isovalue,
                   const ForceSettings& usual) {
    return std::visit(MakeCommand{field, isovalue, usual}, sent);
}

void bind_commands(py::module_& module) {
    py::module_ names = module.def_submodule("command", "Commands to a running session.");
    bind(names, "Isovalue", "isovalue", &command::Isovalue::isovalue, "[data units]");
    bind(names, "Freeze", "on", &command::Freeze::on, "Hand and proxy stand still, no force.");
    bind(names, "Clutch", "on", &command::Clutch::on, "As if a clutch button was held.");
    bind(names, "Forces", "on", &command::Forces::on, "Forces on or off.");
    bind(names, "Scale", "scale", &command::Scale::scale,
         "Scales the volume about the SCP: physical mm per device mm.", ranges::scale);
    bind(names, "Moment", "time", &command::Moment::time, "Goes to a time of a sequence [s].",
         ranges::finite);
    bind(names, "Speed", "speed", &command::Speed::speed,
         "Seconds of a sequence per second; negative: backwards; 0: paused.", ranges::speed);
    py::class_<command::Lift>(names, "Lift",
                              "Lifts the hand off: the proxy starts at the hand with the next "
                              "tick, whatever holds it. The force starts again.")
        .def(py::init<>());
    py::class_<command::Samples>(names, "Samples", "Another version of the samples, same grid.")
        .def(py::init([](const std::shared_ptr<Samples>& samples, std::uint64_t version) {
                 return command::Samples{samples, version};
             }),
             py::arg("samples").none(false), py::arg("version") = 0)
        .def_property_readonly(
            "samples",
            [](const command::Samples& s) { return std::const_pointer_cast<Samples>(s.samples); })
        .def_readonly("version", &command::Samples::version);
    py::class_<command::UseLayers>(names, "UseLayers", "Layers from the next tick on; None: none.")
        .def(
            py::init([](const std::optional<io::LayersFile>& layers,
                        const std::optional<Volume>& volume, bool same_surfaces) {
                if (!layers) {
                    run::refuse_without_effect(
                        {{{"volume", "same_surfaces"}, "there are no layers"}},
                        {{"volume", volume.has_value()}, {"same_surfaces", same_surfaces}});
                    return command::UseLayers{};
                }
                if (layers->units == "%" && !volume) {
                    throw std::invalid_argument("layers in percent need the volume they are for");
                }
                return command::UseLayers{
                    std::make_shared<const Layers>(volume ? io::layers_for(*layers, *volume)
                                                          : layers->layers),
                    same_surfaces};
            }),
            py::arg("layers"), py::arg("volume") = py::none(), py::kw_only(),
            py::arg("same_surfaces") = false,
            "volume: what levels in percent are of. same_surfaces: they are the surfaces that are\n"
            "felt, with other levels or properties, so what was punctured stays open.")
        .def_readonly("same_surfaces", &command::UseLayers::same_surfaces);
    py::class_<command::UseTool>(names, "UseTool", "Another tool; None: a point.")
        .def(py::init([](const std::optional<std::shared_ptr<Tool>>& tool) {
                 return command::UseTool{tool.value_or(nullptr)};
             }),
             py::arg("tool"))
        .def_property_readonly("tool", [](const command::UseTool& to) {
            std::optional<std::shared_ptr<Tool>> tool;
            if (to.tool) tool = std::const_pointer_cast<Tool>(to.tool);
            return tool;
        });
}

}  // namespace palpate::python
