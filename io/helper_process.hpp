// Runs palpate-io-helper and turns every way it can end (an answer, an error, a crash, a hang) into
// one result. Linux: posix_spawn, memfd, prctl. Private to io/.
#pragma once

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

/// Memory without a name that two processes can share. Throws std::system_error.
Descriptor shared_memory();

/// `bytes` of it mapped into this process until the last copy of the pointer is gone.
/// Throws std::system_error.
std::shared_ptr<void> map_shared(const Descriptor& memory, std::size_t bytes);

struct HelperJob {
    std::filesystem::path program;  ///< empty: looked for
    std::vector<std::string> arguments;
    const Descriptor* samples = nullptr;
    std::function<void(double)> progress;
    double time_limit_s = 0;
};

struct HelperResult {
    nlohmann::json done;  ///< the answer, if `failure` is empty
    std::string failure;  ///< what went wrong, without the file's name
};

/// Blocks until the helper has ended. Exceptions of `progress` end it and pass through.
HelperResult run_helper(const HelperJob& job);

}  // namespace palpate::io
