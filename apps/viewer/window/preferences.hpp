// What a person prefers, kept from one day to the next, and the dialog to change it.
#pragma once

#include <QDialog>

#include "apps/viewer/model/measurement.hpp"
#include "apps/viewer/window/appearance.hpp"
#include "apps/viewer/window/language.hpp"

namespace palpate::viewer {

struct Preferences {
    Appearance appearance = Appearance::system;
    Language language = Language::system;  ///< of the window's words, from the next start
    double wheel_px = 15;  ///< a notch of the wheel moves the probe as a drag of so many pixels
    LengthUnit unit = LengthUnit::automatic;  ///< of measurements
    double surface_millions = 6;              ///< the most triangles of the felt surface

    bool operator==(const Preferences&) const = default;
};

/// From QSettings; what is missing or cannot be is as it is by default.
Preferences saved_preferences();
void save_preferences(const Preferences& preferences);

class PreferencesDialog : public QDialog {
    Q_OBJECT

  public:
    PreferencesDialog(const Preferences& preferences, QWidget* window);

  Q_SIGNALS:
    /// At every change.
    void changed(const palpate::viewer::Preferences& preferences);

  private:
    Preferences preferences_;
};

}  // namespace palpate::viewer
