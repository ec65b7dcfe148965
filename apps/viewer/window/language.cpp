// Loads translations: the viewer's from its resources, Qt's from where Qt is installed.
#include "apps/viewer/window/language.hpp"

#include <QCoreApplication>
#include <QLibraryInfo>
#include <QLocale>
#include <QSettings>

// Outside of all namespaces, as Qt wants it. A static library's resources are linked only if
// called.
static void use_resources() {
    Q_INIT_RESOURCE(translations);
}

namespace palpate::viewer {
namespace {

constexpr const char* language_key = "preferences/language";
constexpr const char* resources = ":/translations";

QLocale locale_of(Language language) {
    switch (language) {
        case Language::system:
            break;
        case Language::english:
            return {QLocale::English};
        case Language::german:
            return {QLocale::German};
    }
    return QLocale::system();
}

}  // namespace

Language chosen_language() {
    const QString code = QSettings().value(language_key).toString();
    return code == "en" ? Language::english : code == "de" ? Language::german : Language::system;
}

void choose_language(Language language) {
    if (language == Language::system) return QSettings().remove(language_key);
    QSettings().setValue(language_key, locale_of(language).name().section('_', 0, 0));
}

Translation::Translation(Language language) {
    use_resources();
    // The first of the person's languages that there is; English has a file, too, for its plurals.
    if (!own_.load(locale_of(language), "palpate", "_", resources)) {
        (void)own_.load("palpate_en", resources);
    }
    QCoreApplication::installTranslator(&own_);
    // Fields read and show numbers as all other words do: with a decimal point.
    QLocale::setDefault(QLocale(QLocale::English));
    if (qt_.load(QLocale(own_.language()), "qtbase", "_",
                 QLibraryInfo::location(QLibraryInfo::TranslationsPath))) {
        QCoreApplication::installTranslator(&qt_);
    }
}

}  // namespace palpate::viewer
