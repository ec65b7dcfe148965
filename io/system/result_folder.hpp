// A folder of results that appear together, when they are complete. Private to io/ and programs.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace palpate::io {

/// The results are made in a hidden folder inside the one asked for and appear there together: an
/// interrupted command leaves nothing that could be taken for results. What a killed one has left
/// in this folder goes when the next one begins there.
class ResultFolder {
  public:
    /// Makes both folders. `names` are those of all results that may be made; empty: any. Throws
    /// OutputError if nothing can be written there.
    explicit ResultFolder(const std::filesystem::path& folder, std::vector<std::string> names = {});
    /// What was not completed goes.
    ~ResultFolder();
    ResultFolder(const ResultFolder&) = delete;
    ResultFolder& operator=(const ResultFolder&) = delete;

    /// Where to make the results.
    const std::filesystem::path& part() const { return part_; }
    /// Calls make(part()). An OutputError names the results as they would lie in the folder.
    void make(const std::function<void(const std::filesystem::path& part)>& results) const;
    /// Puts what was made in place; more may be made and completed after. Throws OutputError, and
    /// std::logic_error for a result that is not among the names: whether it is an input was
    /// not checked.
    void complete();

  private:
    std::filesystem::path folder_, part_;
    std::vector<std::string> names_;
    bool is_new_ = false;
    bool complete_ = false;
    int lock_ = -1;  // on part_, see io/system/leftovers.hpp
};

}  // namespace palpate::io
