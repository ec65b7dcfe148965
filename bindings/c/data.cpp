// The data of runs in the C interface: edits, and playing sequences.
#include <limits>
#include <stdexcept>

#include "bindings/c/handles.hpp"
#include "bindings/c/structs.hpp"

namespace palpate::c {
namespace {

run::Data& data_of(const palpate_data* data) {
    return *given(data, "data").data;
}

run::HandBrush hand_brush(const palpate_brush& asked) {
    run::HandBrush brush;
    brush.kind = one_of<BrushKind>(asked.kind, "brush.kind");
    brush.radius = asked.radius;
    brush.hardness = 1 - asked.softness;
    if (asked.rate != 0) brush.rate = asked.rate;
    if (asked.has_value || brush.kind == BrushKind::paint) brush.value = asked.value;
    brush.as_tool = asked.as_tool != 0;
    return brush;
}

Brush stroke_brush(const palpate_brush& asked) {
    if (asked.as_tool) throw std::invalid_argument("brush.as_tool: is for a hand's brush only");
    check(hand_brush(asked));  // also what a stroke does not use
    Brush brush;
    brush.kind = one_of<BrushKind>(asked.kind, "brush.kind");
    brush.radius = asked.radius;
    brush.hardness = 1 - asked.softness;
    brush.level = asked.level;
    brush.solid = one_of<Solid>(asked.solid, "brush.solid");
    brush.value = asked.value;
    return brush;
}

Index3 index3(const std::int32_t* from) {
    return {from[0], from[1], from[2]};
}

void tell(std::int32_t* done, bool is_done) {
    if (done) *done = is_done;
}

}  // namespace

extern "C" PALPATE_API palpate_status palpate_data_create(const palpate_volume* volume,
                                                          palpate_data** out) {
    return guarded([&] {
        given(out, "out");
        *out = new palpate_data{std::make_shared<run::Data>(given(volume, "volume").loaded)};
    });
}

extern "C" PALPATE_API palpate_status palpate_data_set_brush(palpate_data* data,
                                                             const palpate_brush* brush) {
    return guarded([&] {
        std::optional<run::HandBrush> asked;
        if (brush) asked = hand_brush(taken(brush, "brush"));
        data_of(data).editor().set_brush(asked);
    });
}

extern "C" PALPATE_API palpate_status palpate_data_stroke(palpate_data* data,
                                                          const palpate_brush* brush,
                                                          const double from[3],
                                                          const double to[3]) {
    return guarded([&] {
        data_of(data).editor().apply(
            edit::Stroke{stroke_brush(taken(brush, "brush")), vec3(&given(from, "from")),
                         vec3(&given(to, "to"))},
            progress_of_thread());
    });
}

extern "C" PALPATE_API palpate_status palpate_data_fill(palpate_data* data, const int32_t low[3],
                                                        const int32_t high[3], double value) {
    return guarded([&] {
        const SampleBox box{index3(&given(low, "low")), index3(&given(high, "high"))};
        if (box.empty()) throw std::invalid_argument("high must not lie below low along any axis");
        data_of(data).editor().apply(edit::Fill{box, value}, progress_of_thread());
    });
}

extern "C" PALPATE_API palpate_status palpate_data_replace(palpate_data* data, const int32_t at[3],
                                                           const palpate_volume* samples) {
    return guarded([&] {
        data_of(data).editor().apply(
            edit::Replace{index3(&given(at, "at")), given(samples, "samples").loaded.volume},
            progress_of_thread());
    });
}

extern "C" PALPATE_API palpate_status palpate_data_undo(palpate_data* data, int32_t* done) {
    return guarded([&] { tell(done, data_of(data).editor().undo(progress_of_thread())); });
}

extern "C" PALPATE_API palpate_status palpate_data_redo(palpate_data* data, int32_t* done) {
    return guarded([&] { tell(done, data_of(data).editor().redo(progress_of_thread())); });
}

extern "C" PALPATE_API palpate_status palpate_data_edits(const palpate_data* data,
                                                         palpate_edit_state* out) {
    return guarded([&] {
        const run::EditState now = data_of(data).editor().state();
        give(out, "out",
             palpate_edit_state{sizeof(palpate_edit_state), now.changed, now.version,
                                now.undo_steps, now.redo_steps});
    });
}

extern "C" PALPATE_API palpate_status palpate_data_field(const palpate_data* data,
                                                         const palpate_field_options* options,
                                                         palpate_field** out) {
    return guarded([&] {
        given(out, "out");
        const run::Data& from = data_of(data);
        const run::FieldSetup setup = field_setup(options);
        Field field = run::make_field(from.start(), setup);
        from.update(field);
        *out = new palpate_field{std::move(field), usual_isovalue(from.loaded())};
    });
}

extern "C" PALPATE_API palpate_status palpate_data_save(palpate_data* data, const char* path) {
    return guarded([&] { data_of(data).save(&given(path, "path"), progress_of_thread()); });
}

extern "C" PALPATE_API palpate_status palpate_data_play(palpate_data* data, double speed) {
    return guarded([&] { data_of(data).player().play(speed); });
}

extern "C" PALPATE_API palpate_status palpate_data_seek(palpate_data* data, double time) {
    return guarded([&] { data_of(data).player().seek(time); });
}

extern "C" PALPATE_API void palpate_data_destroy(palpate_data* data) {
    delete data;
}

}  // namespace palpate::c
