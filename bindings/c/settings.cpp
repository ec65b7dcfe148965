// Finds settings by name and describes them.
#include "bindings/c/settings.hpp"

#include <deque>
#include <stdexcept>
#include <vector>

#include "bindings/c/handles.hpp"
#include "bindings/c/structs.hpp"

namespace palpate::c {
namespace {

struct SettingList {
    std::deque<std::string> names;  // which the settings point to
    std::vector<palpate_setting> settings;
};

SettingList described() {
    SettingList made;
    const RendererSettings usual;
    for_each_live_number(usual, [&](const auto& name, const auto& one, double value, const auto&) {
        auto setting = sized<palpate_setting>();
        setting.open = one.range.open;
        setting.name = made.names.emplace_back(name).c_str();
        setting.unit = one.unit;
        setting.about = one.about;
        setting.least = one.range.least;
        setting.most = one.range.most;
        setting.usual = value;
        made.settings.push_back(setting);
    });
    return made;
}

}  // namespace

const std::vector<palpate_setting>& all_settings() {
    static const SettingList all = described();
    return all.settings;
}

double value_of(const RendererSettings& settings, const std::string& name) {
    double value = 0;
    visit_live_number(settings, name, [&](double number, const auto&) { value = number; });
    return value;
}

extern "C" PALPATE_API size_t palpate_setting_count(void) {
    size_t count = 0;
    guarded([&] { count = all_settings().size(); });
    return count;
}

extern "C" PALPATE_API palpate_status palpate_setting_describe(size_t index, palpate_setting* out) {
    return guarded([&] {
        if (index >= all_settings().size()) {
            throw std::invalid_argument("index: there are " +
                                        std::to_string(all_settings().size()) + " settings");
        }
        give(out, "out", all_settings()[index]);
    });
}

extern "C" PALPATE_API palpate_status palpate_renderer_get(const palpate_renderer* renderer,
                                                           const char* name, double* value) {
    return guarded([&] {
        const RendererSettings& now = given(renderer, "renderer").renderer.settings;
        given(value, "value") = value_of(now, &given(name, "name"));
    });
}

extern "C" PALPATE_API palpate_status palpate_renderer_set(palpate_renderer* renderer,
                                                           const char* name, double value) {
    return guarded([&] {
        Renderer& r = given(renderer, "renderer").renderer;
        RendererSettings changed = r.settings;
        change(changed, &given(name, "name"), value);
        check(changed);
        r.settings = changed;
        r.force.changed = true;
    });
}

}  // namespace palpate::c
