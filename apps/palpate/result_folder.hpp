// A folder of results that appear together, when they are complete.
#pragma once

#include <filesystem>

namespace palpate::app {

/// The results are made in a hidden folder inside the one asked for and appear there together: an
/// interrupted command leaves nothing that could be taken for results. What a killed one has left
/// in this folder goes when the next one begins there.
class ResultFolder {
  public:
    /// Makes both folders. Throws io::OutputError if nothing can be written there.
    explicit ResultFolder(const std::filesystem::path& folder);
    /// What was not completed goes.
    ~ResultFolder();
    ResultFolder(const ResultFolder&) = delete;
    ResultFolder& operator=(const ResultFolder&) = delete;

    /// Where to make the results.
    const std::filesystem::path& part() const { return part_; }
    /// Puts what was made in place; more may be made and completed after. Throws io::OutputError.
    void complete();

  private:
    std::filesystem::path folder_, part_;
    bool is_new_ = false;
    bool complete_ = false;
    int lock_ = -1;  // on part_, see io/system/leftovers.hpp
};

}  // namespace palpate::app
