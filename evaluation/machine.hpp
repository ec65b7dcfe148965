// A line that says on which machine and when numbers were measured.
#pragma once

#include <string>

namespace palpate::evaluation {

/// "2026-01-31, Debian GNU/Linux 12, Intel(R) ... (2 processors), g++ 12.2.0, -O2, Palpate 0.2.0";
/// nothing that identifies the machine itself.
std::string machine_and_date();

}  // namespace palpate::evaluation
