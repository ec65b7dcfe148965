// The list of devices in the C interface.
#include "bindings/c/handles.hpp"
#include "bindings/c/structs.hpp"

namespace palpate::c {

extern "C" PALPATE_API palpate_status palpate_device_list_create(palpate_device_list** out) {
    return guarded([&] {
        given(out, "out") = new palpate_device_list{devices::find_devices(progress_of_thread())};
    });
}

extern "C" PALPATE_API size_t palpate_device_list_count(const palpate_device_list* list) {
    return list ? list->findings.size() : 0;
}

extern "C" PALPATE_API palpate_status palpate_device_list_get(const palpate_device_list* list,
                                                              size_t index,
                                                              palpate_device_finding* out) {
    return guarded([&] {
        const auto& findings = given(list, "list").findings;
        if (index >= findings.size()) {
            throw std::invalid_argument("there are " + std::to_string(findings.size()) +
                                        " devices in the list");
        }
        const devices::DeviceFinding& from = findings[index];
        give(out, "out",
             palpate_device_finding{sizeof(palpate_device_finding), from.found, from.name.c_str(),
                                    from.what.c_str(), from.missing.c_str(), from.options.c_str()});
    });
}

extern "C" PALPATE_API void palpate_device_list_destroy(palpate_device_list* list) {
    delete list;
}

}  // namespace palpate::c
