// The language of the window's words: the system's, or one that was chosen in the preferences.
#pragma once

#include <QTranslator>

namespace palpate::viewer {

enum class Language { system, english, german };

/// For the next start. From QSettings; the system's where nothing, or nothing that exists, is kept.
Language chosen_language();
void choose_language(Language language);

/// Translates all words, Qt's own too, as long as it lives. What a window shows already stays as it
/// is. Words without a translation are English.
class Translation {
  public:
    explicit Translation(Language language);

  private:
    QTranslator own_, qt_;
};

}  // namespace palpate::viewer
