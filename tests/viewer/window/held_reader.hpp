// Holds up the program that reads files, for tests in which a window goes on meanwhile.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace palpate::viewer::test {

/// While it lives, the program that reads and writes files waits for release().
class HeldReader {
  public:
    /// `folder`: for files of its own.
    explicit HeldReader(const std::filesystem::path& folder)
        : usual_(std::getenv(variable)), gate_(folder / "may-read") {
        std::filesystem::remove(gate_);
        const std::filesystem::path program = folder / "held-reader";
        std::ofstream(program) << "#!/bin/sh\nuntil [ -e " << gate_
                               << " ]; do sleep 0.01; done\nexec " << std::filesystem::path(usual_)
                               << " \"$@\"\n";
        std::filesystem::permissions(program, std::filesystem::perms::owner_all);
        ::setenv(variable, program.c_str(), 1);
    }
    ~HeldReader() {
        ::setenv(variable, usual_.c_str(), 1);
        release();
    }
    HeldReader(const HeldReader&) = delete;
    HeldReader& operator=(const HeldReader&) = delete;

    void release() const { const std::ofstream made(gate_); }

  private:
    static constexpr const char* variable = "PALPATE_IO_HELPER";
    const std::string usual_;
    const std::filesystem::path gate_;
};

}  // namespace palpate::viewer::test
