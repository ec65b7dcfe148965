// Preferences of a person, kept from one day to the next, such as appearance and language, and the
// dialog to change them.
#pragma once

#include <QTranslator>

#include <functional>

#include "apps/viewer/model/measurement.hpp"

class QDialog;
class QWidget;

namespace palpate::viewer {

enum class Appearance { system, light, dark };

/// For the whole application, at once, and for the next start; `system` is what it had when this
/// was first called.
void set_appearance(Appearance appearance);

/// The language of the window's words: the system's, or one that was chosen in the preferences.
enum class Language { system, english, german };

/// Translates all words, Qt's own too, as long as it lives. What a window shows already stays as it
/// is. Words without a translation are English.
class Translation {
  public:
    explicit Translation(Language language);

  private:
    QTranslator own_, qt_;
};

struct Preferences {
    Appearance appearance = Appearance::system;
    Language language = Language::system;  ///< of the window's words, from the next start
    double wheel_px = 15;  ///< a notch of the wheel moves the probe as a drag of so many pixels
    LengthUnit unit = LengthUnit::automatic;  ///< of measurements
    double surface_millions = 6;              ///< the most triangles of the felt surface

    bool operator==(const Preferences&) const = default;
};

/// From QSettings; what is missing or cannot be is as it is by default. The appearance is that of
/// set_appearance().
Preferences saved_preferences();
void save_preferences(const Preferences& preferences);

/// A dialog that calls `changed` at every change.
QDialog* make_preferences_dialog(const Preferences& preferences, QWidget* window,
                                 std::function<void(const Preferences&)> changed);

}  // namespace palpate::viewer
