// The errors of VTK for a file that is wrong.
#pragma once

#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>

#include <string>

#include "io/helper/headers.hpp"
#include "io/helper/library_words.hpp"

namespace palpate::io {

/// VTK reports errors to a window and continues; this window keeps the first.
class ErrorKeeper : public vtkOutputWindow {
  public:
    static ErrorKeeper* New() { VTK_STANDARD_NEW_BODY(ErrorKeeper); }
    vtkTypeMacro(ErrorKeeper, vtkOutputWindow) void DisplayText(const char*) override {}
    void DisplayErrorText(const char* text) override { keep(text); }
    void DisplayWarningText(const char*) override {}
    const std::string& first() const { return first_; }

  private:
    void keep(const char* text) {
        if (!first_.empty()) return;
        // "ERROR: In file, line n\nvtkClass (0x...): what is wrong\n"
        const std::string all = trimmed(text);
        const auto colon = all.find("): ");
        first_ = library_words(colon == std::string::npos ? all : all.substr(colon + 3), 160);
    }
    std::string first_;
};

}  // namespace palpate::io
