// Runs a helper program such as palpate-io-helper, which isolates libraries that crash, hang or
// load slowly, and turns every outcome (an answer, an error, a crash, a hang) into one result.
// Linux: posix_spawn, memfd. For the libraries that have such a program, not for the apps.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace palpate::io {

/// An open file descriptor, closed at the end of its life.
class Descriptor {
  public:
    explicit Descriptor(int number = -1) : number_(number) {}
    ~Descriptor();
    Descriptor(Descriptor&& other) noexcept : number_(other.number_) { other.number_ = -1; }
    Descriptor& operator=(Descriptor&&) = delete;
    int number() const { return number_; }
    void close_now();

  private:
    int number_;
};

/// Memory without a name that two processes can share; of no size yet. Throws std::system_error.
Descriptor shared_memory();

/// The same, of `bytes`. Throws std::system_error.
Descriptor shared_memory(std::size_t bytes);

/// `bytes` of it mapped into this process until the last copy of the pointer is gone.
/// Throws std::system_error.
std::shared_ptr<void> map_shared(const Descriptor& memory, std::size_t bytes);

/// Which program, and what its failures most likely mean to the user. Each text ends a message, so
/// it begins in lower case and has no full stop.
struct HelperProgram {
    const char* name;           ///< "palpate-io-helper"; its variable is then PALPATE_IO_HELPER
    const char* who_crashes;    ///< "the format's library"
    const char* after_crash;    ///< "the file is damaged or not what its name says; ..."
    const char* out_of_memory;  ///< "close other programs or use a smaller volume"
    const char* too_slow;       ///< "the file is damaged or very large; ..."
};

struct HelperJob {
    const HelperProgram& program;
    /// Empty: the environment variable's, else the first one in helper_folders().
    std::filesystem::path path;
    std::vector<std::string> arguments;
    /// What both share, its descriptor 3 (helper/protocol.hpp); it reports on 4. May be null.
    const Descriptor* memory = nullptr;
    std::function<void(double)> progress;
    double time_limit_s = 0;
    double processor_limit_s = 0;  ///< [s] of its processor time, rounded up; 0: no limit
};

struct HelperResult {
    nlohmann::json done;  ///< the answer, if `failure` is empty
    std::string failure;  ///< what went wrong, without the file's name
};

/// Blocks until the helper has ended; safe from several threads. An exception of `progress` ends
/// the helper and passes through.
HelperResult run_helper(const HelperJob& job);

/// The bytes that a helper asks for. May throw.
using GiveBytes = std::function<std::vector<std::byte>(std::uint64_t offset, std::uint64_t length)>;

/// Asks a helper that answers one question after the other, and asks for bytes of a file meanwhile
/// (helper/protocol.hpp). What `give` or `progress` throws passes through. After that, and after a
/// failure, it has no more answers. One thread at a time.
using HelperTalk = std::function<HelperResult(const nlohmann::json& question, const GiveBytes& give,
                                              const std::function<void(double)>& progress)>;

/// Starts one, which is killed when the last copy of this is gone. The job's time limit is that of
/// a question, without the time that `give` takes. Its memory is not used. Throws
/// std::system_error.
HelperTalk talk_to_helper(HelperJob job);

}  // namespace palpate::io
