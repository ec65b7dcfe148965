// A row of the panel for each force setting, with words and ends that only a window needs.
#pragma once

#include <QString>

#include "palpate/settings.hpp"

namespace palpate::viewer {

/// Of a Setting.
struct SettingWords {
    const char *title, *unit, *about;
};

struct ForceRow {
    QString name;  ///< of the widgets
    QString unit, label, tip;
    double low = 0, high = 1, step = 0.02;  ///< of slider and box
    bool infinite = false;                  ///< "inf" is a value
    bool plain = false;                     ///< everybody needs it; the others are advanced
    int place = 0;                          ///< rows stand in this order
};

/// "force_limit" for "force limit"
QString row_name(const char* title);

/// For a setting that is usually `usual`. One that this file does not know has the words of its
/// table, in English, a slider to four times the usual value, and a place at the end.
ForceRow row_of(const SettingWords& setting, const ValueRange& range, double usual);

}  // namespace palpate::viewer
