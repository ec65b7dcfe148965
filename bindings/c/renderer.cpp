// Renderers of the C interface: a tick at a time in the caller's own loop.
#include <vector>

#include "bindings/c/handles.hpp"
#include "bindings/c/structs.hpp"
#include "palpate/run/no_effect.hpp"

namespace palpate::c {

extern "C" PALPATE_API palpate_status palpate_renderer_create(const palpate_field* field,
                                                              const palpate_render_options* options,
                                                              const palpate_transform* transform,
                                                              palpate_renderer** out) {
    return guarded([&] {
        given(out, "out");
        const palpate_field& felt = given(field, "field");
        const auto asked = taken_or_default(options, "options");
        std::optional<double> isovalue = felt.isovalue;
        if (asked.has_isovalue) isovalue = asked.isovalue;
        if (!isovalue) throw std::invalid_argument("constant data: give an isovalue");
        const run::RenderSetup setup = render_setup(asked);
        std::vector<run::NoEffect> useless = run::without_effect(setup);
        if (setup.layers && !setup.layers->layers.layers.empty()) {
            useless.push_back({{"isovalue"}, "layers have levels of their own"});
        }
        run::refuse_without_effect(useless, {{"isovalue", asked.has_isovalue != 0}});
        RendererSettings settings =
            run::render_settings(setup, felt.field, *isovalue, std::nullopt, progress_of_thread());
        settings.transform = transform_from(transform);
        if (asked.scale != 0) settings.transform.scale = asked.scale;
        *out = new palpate_renderer{make_renderer(felt.field, *isovalue, settings)};
    });
}

extern "C" PALPATE_API palpate_status palpate_renderer_render(palpate_renderer* renderer,
                                                              const palpate_hand* hand,
                                                              palpate_felt* out) {
    return guarded([&] {
        Renderer& r = given(renderer, "renderer").renderer;
        const palpate_hand at = taken(hand, "hand");
        size_of(given(out, "out"), "out");
        TickInput state{.time = at.time, .position = vec3(at.position), .valid = !at.invalid};
        state.orientation = quaternion(at.orientation).toRotationMatrix();
        give(out, "out", felt_from(render(r, state)));
    });
}

extern "C" PALPATE_API palpate_status palpate_renderer_set_isovalue(palpate_renderer* renderer,
                                                                    double isovalue) {
    return guarded([&] {
        Renderer& r = given(renderer, "renderer").renderer;
        check_isovalue(isovalue, r.field.solid());
        use_isovalue(r, isovalue);
        r.force.changed = true;  // the force rises with the ramp, as after a command
    });
}

extern "C" PALPATE_API void palpate_renderer_destroy(palpate_renderer* renderer) {
    delete renderer;
}

}  // namespace palpate::c
