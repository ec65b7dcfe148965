// Keeps preferences in QSettings, sets palettes and translations, and shows all in a form.
#include "apps/viewer/window/preferences.hpp"

#include <QApplication>
#include <QCoreApplication>
#include <QDialog>
#include <QDialogButtonBox>
#include <QFormLayout>
#include <QLibraryInfo>
#include <QLocale>
#include <QPalette>
#include <QSettings>

#include <cstddef>
#include <utility>

#include "apps/viewer/panel/form.hpp"
#include "apps/viewer/panel/layout.hpp"

// Outside of all namespaces, as Qt wants it. A static library's resources are linked only if
// called.
static void use_resources() {
    Q_INIT_RESOURCE(translations);
}

namespace palpate::viewer {
namespace {

QPalette palette_of(const QColor& window, const QColor& base, const QColor& text,
                    const QColor& faint) {
    QPalette palette(window, window);  // buttons, and what is made from them
    for (const auto role : {QPalette::WindowText, QPalette::ButtonText, QPalette::BrightText}) {
        palette.setColor(role, text);
    }
    palette.setColor(QPalette::Base, base);
    palette.setColor(QPalette::AlternateBase, window);
    palette.setColor(QPalette::Text, text);
    palette.setColor(QPalette::ToolTipBase, base);
    palette.setColor(QPalette::ToolTipText, text);
    palette.setColor(QPalette::PlaceholderText, faint);
    palette.setColor(QPalette::Highlight, QColor(0, 114, 178));
    palette.setColor(QPalette::HighlightedText, Qt::white);
    palette.setColor(QPalette::Link, QColor(86, 180, 233));
    for (const auto role : {QPalette::Text, QPalette::WindowText, QPalette::ButtonText}) {
        palette.setColor(QPalette::Disabled, role, faint);
    }
    return palette;
}

}  // namespace

void set_appearance(Appearance appearance) {
    static const QPalette system = QApplication::palette();
    QSettings().setValue("appearance", static_cast<int>(appearance));
    switch (appearance) {
        case Appearance::system:
            QApplication::setPalette(system);
            break;
        case Appearance::light:
            QApplication::setPalette(
                palette_of(QColor(239, 239, 239), Qt::white, QColor(20, 20, 20), Qt::gray));
            break;
        case Appearance::dark:
            QApplication::setPalette(palette_of(QColor(45, 46, 48), QColor(30, 31, 33),
                                                QColor(226, 226, 226), QColor(130, 130, 130)));
            break;
    }
}

namespace {

constexpr const char* language_key = "preferences/language";
constexpr const char* resources = ":/translations";

/// In the order of Language.
constexpr const char* language_codes[] = {"", "en", "de"};

const char* code_of(Language language) {
    return language_codes[static_cast<std::size_t>(language)];
}

}  // namespace

Translation::Translation(Language language) {
    use_resources();
    // The first of the person's languages that there is; English has a file, too, for its plurals.
    const QLocale locale =
        language == Language::system ? QLocale::system() : QLocale(code_of(language));
    if (!own_.load(locale, "palpate", "_", resources)) {
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

namespace {

constexpr double least_wheel = 2, most_wheel = 100;
constexpr double least_millions = 0.1, most_millions = 50;

/// Numbers that are none of the choices up to `last` stand for the first one.
template <typename Choice>
Choice choice_in(const QSettings& settings, const char* name, Choice last) {
    const int choice = settings.value(name).toInt();
    return choice >= 0 && choice <= static_cast<int>(last) ? static_cast<Choice>(choice) : Choice{};
}

double number_in(const QSettings& settings, const char* name, double usual, double low,
                 double high) {
    bool is_number = false;
    const double value = settings.value(name).toDouble(&is_number);
    return is_number && value >= low && value <= high ? value : usual;
}

}  // namespace

Preferences saved_preferences() {
    const QSettings settings;
    const Preferences usual;
    Preferences found;
    found.appearance = choice_in(settings, "appearance", Appearance::dark);
    const QString code = settings.value(language_key).toString();
    for (const Language language : {Language::english, Language::german}) {
        if (code == code_of(language)) found.language = language;
    }
    found.wheel_px =
        number_in(settings, "preferences/wheel_px", usual.wheel_px, least_wheel, most_wheel);
    found.unit = choice_in(settings, "preferences/unit", LengthUnit::inches);
    found.surface_millions = number_in(settings, "preferences/surface_millions",
                                       usual.surface_millions, least_millions, most_millions);
    return found;
}

void save_preferences(const Preferences& preferences) {
    const Language language = preferences.language;
    QSettings settings;
    settings.remove(language_key);
    if (language != Language::system) {
        settings.setValue(language_key, code_of(language));
    }
    settings.setValue("preferences/wheel_px", preferences.wheel_px);
    settings.setValue("preferences/unit", static_cast<int>(preferences.unit));
    settings.setValue("preferences/surface_millions", preferences.surface_millions);
}

namespace {

class PreferencesDialog : public Form {
    Q_DECLARE_TR_FUNCTIONS(palpate::viewer::PreferencesDialog)

  public:
    PreferencesDialog(const Preferences& now, std::function<void(const Preferences&)> changed)
        : now_(now), changed_(std::move(changed)) {
        auto* rows = form_in(this);
        add_row(*rows, tr("Theme"),
                choice({"preferred_theme", ""}, {tr("as the system"), tr("light"), tr("dark")},
                       of<int>(&Preferences::appearance)),
                tr("Colours of the window"));
        // Each language by its own name, because people who need it may not read the others.
        add_row(*rows, tr("Language, from the next start"),
                choice({"preferred_language", ""}, {tr("as the system"), "English", "Deutsch"},
                       of<int>(&Preferences::language)),
                tr("Of the window's words"));
        auto* wheel = number({"preferred_wheel", ""},
                             within(least_wheel, most_wheel, of<double>(&Preferences::wheel_px)));
        wheel->setSuffix(tr(" pixels"));
        add_row(*rows, tr("A notch of the wheel"), wheel,
                tr("Moves the probe into the depth as far as a drag of so many pixels"));
        add_row(*rows, tr("Units of lengths"),
                choice({"preferred_unit", ""},
                       {tr("automatic"), tr("micrometres"), tr("millimetres"), tr("centimetres"),
                        tr("inches")},
                       of<int>(&Preferences::unit)),
                tr("Of measurements"));
        auto* millions = number(
            {"preferred_triangles", ""},
            within(least_millions, most_millions, of<double>(&Preferences::surface_millions)));
        millions->setSuffix(tr(" million"));
        add_row(*rows, tr("Triangles of the surface"), millions,
                tr("At most; a finer surface is thinned. A million takes about 80 MB"));
        refresh();
    }

  private:
    template <typename As, typename T>
    Value<As> of(T Preferences::*member) {
        return {[this, member] { return static_cast<As>(now_.*member); },
                [this, member](As to) {
                    now_.*member = static_cast<T>(to);
                    changed_(now_);
                }};
    }

    Preferences now_;
    std::function<void(const Preferences&)> changed_;
};

}  // namespace

QDialog* make_preferences_dialog(const Preferences& preferences, QWidget* window,
                                 std::function<void(const Preferences&)> changed) {
    auto* dialog = named(new QDialog(window), "preferences");
    auto* form = new PreferencesDialog(preferences, std::move(changed));
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Close);
    QObject::connect(buttons, &QDialogButtonBox::rejected, dialog, &QDialog::accept);
    dialog->setWindowTitle(PreferencesDialog::tr("Preferences"));
    column_in(dialog, {form, buttons})->setContentsMargins(9, 9, 9, 9);
    return dialog;
}

}  // namespace palpate::viewer
