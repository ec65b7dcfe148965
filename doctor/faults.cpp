// All faults in order.
#include "doctor/faults.hpp"

#include <algorithm>
#include <iterator>

namespace palpate::doctor {

std::vector<Fault> faults_of(const Facts& facts) {
    std::vector<Fault> faults;
    for (const auto& part :
         {&real_time_faults, &kernel_faults, &latency_faults, &program_faults, &device_faults}) {
        std::ranges::move(part(facts), std::back_inserter(faults));
    }
    std::stable_partition(faults.begin(), faults.end(),
                          [](const Fault& fault) { return fault.essential; });
    return faults;
}

}  // namespace palpate::doctor
