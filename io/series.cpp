// DICOM series as text. See the header.
#include "palpate/io/series.hpp"

#include "io/words.hpp"

namespace palpate::io {

std::string text_of(const SeriesInfo& s) {
    std::string text = std::to_string(s.slices) + (s.slices == 1 ? " slice of " : " slices of ") +
                       std::to_string(s.size[0]) + "x" + std::to_string(s.size[1]) + "  " +
                       s.modality + " '" + s.description + "'";
    if (s.spacing[0] > 0) {
        text += "  " + text_of(s.spacing[0]) + " x " + text_of(s.spacing[1]);
        if (s.spacing[2] > 0) text += " x " + text_of(s.spacing[2]);
        text += " mm";
    }
    if (!s.stack.empty()) text += "  stack " + s.stack;
    if (!s.patient.empty()) text += "  patient '" + s.patient + "'";
    if (!s.study.empty()) text += "  study '" + s.study + "'";
    return one_line(text + "  " + s.uid);
}

}  // namespace palpate::io
