// DICOM series as text. See the header.
#include "palpate/io/series.hpp"

#include <cstdio>

namespace palpate::io {
namespace {

std::string number_text(double number) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", number);
    return text;
}

}  // namespace

std::string text_of(const SeriesInfo& s) {
    std::string text = std::to_string(s.slices) + (s.slices == 1 ? " slice of " : " slices of ") +
                       std::to_string(s.size[0]) + "x" + std::to_string(s.size[1]) + "  " +
                       s.modality + " '" + s.description + "'";
    if (s.spacing[0] > 0) {
        text += "  " + number_text(s.spacing[0]) + " x " + number_text(s.spacing[1]);
        if (s.spacing[2] > 0) text += " x " + number_text(s.spacing[2]);
        text += " mm";
    }
    if (!s.stack.empty()) text += "  stack " + s.stack;
    if (!s.patient.empty()) text += "  patient '" + s.patient + "'";
    if (!s.study.empty()) text += "  study '" + s.study + "'";
    return one_line(text + "  " + s.uid);
}

}  // namespace palpate::io
