// Keeps preferences in QSettings, sets palettes and translations, and shows all in a form.
#include "apps/viewer/window/preferences.hpp"

#include <QApplication>
#include <QComboBox>
#include <QCoreApplication>
#include <QDialogButtonBox>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QLibraryInfo>
#include <QLocale>
#include <QPalette>
#include <QSettings>

#include <algorithm>

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

Appearance last_appearance() {
    const int last = QSettings().value("appearance", 0).toInt();
    return last == 1 ? Appearance::light : last == 2 ? Appearance::dark : Appearance::system;
}

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

namespace {

constexpr double least_wheel = 2, most_wheel = 100;
constexpr double least_millions = 0.1, most_millions = 50;

double number_in(const QSettings& settings, const char* name, double usual, double low,
                 double high) {
    bool is_number = false;
    const double value = settings.value(name).toDouble(&is_number);
    return is_number && value >= low && value <= high ? value : usual;
}

QDoubleSpinBox* number_box(const char* name, double value, double low, double high, double step,
                           const QString& unit) {
    auto* box = new QDoubleSpinBox;
    box->setObjectName(name);
    box->setRange(low, high);
    box->setSingleStep(step);
    box->setDecimals(1);
    box->setSuffix(unit);
    box->setValue(value);
    return box;
}

QComboBox* choice_box(const char* name, const QStringList& words, int chosen) {
    auto* box = new QComboBox;
    box->setObjectName(name);
    box->addItems(words);
    box->setCurrentIndex(chosen);
    return box;
}

}  // namespace

Preferences saved_preferences() {
    const QSettings settings;
    const Preferences usual;
    Preferences found;
    found.appearance = last_appearance();
    found.language = chosen_language();
    found.wheel_px =
        number_in(settings, "preferences/wheel_px", usual.wheel_px, least_wheel, most_wheel);
    found.unit = static_cast<LengthUnit>(
        std::clamp(settings.value("preferences/unit", 0).toInt(), 0, int(LengthUnit::inches)));
    found.surface_millions = number_in(settings, "preferences/surface_millions",
                                       usual.surface_millions, least_millions, most_millions);
    return found;
}

void save_preferences(const Preferences& preferences) {
    choose_language(preferences.language);
    QSettings settings;
    settings.setValue("preferences/wheel_px", preferences.wheel_px);
    settings.setValue("preferences/unit", static_cast<int>(preferences.unit));
    settings.setValue("preferences/surface_millions", preferences.surface_millions);
}

PreferencesDialog::PreferencesDialog(const Preferences& preferences, QWidget* window)
    : QDialog(window), preferences_(preferences) {
    setObjectName("preferences");
    setWindowTitle(tr("Preferences"));
    auto* theme = choice_box("preferred_theme", {tr("as the system"), tr("light"), tr("dark")},
                             static_cast<int>(preferences.appearance));
    // Each language by its own name: whoever looks for it may not read the others.
    auto* language = choice_box("preferred_language", {tr("as the system"), "English", "Deutsch"},
                                static_cast<int>(preferences.language));
    auto* wheel = number_box("preferred_wheel", preferences.wheel_px, least_wheel, most_wheel, 1,
                             tr(" pixels"));
    auto* unit = choice_box(
        "preferred_unit",
        {tr("automatic"), tr("micrometres"), tr("millimetres"), tr("centimetres"), tr("inches")},
        static_cast<int>(preferences.unit));
    auto* millions = number_box("preferred_triangles", preferences.surface_millions, least_millions,
                                most_millions, 1, tr(" million"));
    auto* form = new QFormLayout(this);
    add_row(*form, tr("Theme"), theme, tr("Colours of the window"));
    add_row(*form, tr("Language, from the next start"), language, tr("Of the window's words"));
    add_row(*form, tr("A notch of the wheel"), wheel,
            tr("Moves the probe into the depth as far as a drag of so many pixels"));
    add_row(*form, tr("Units of lengths"), unit, tr("Of measurements"));
    add_row(*form, tr("Triangles of the surface"), millions,
            tr("At most; a finer surface is thinned. A million takes about 80 MB"));
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Close);
    form->addRow(buttons);
    connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::accept);
    const auto choice = [this](QComboBox* box, auto set) {
        connect(box, qOverload<int>(&QComboBox::activated), this, [this, set](int at) {
            set(preferences_, at);
            Q_EMIT changed(preferences_);
        });
    };
    choice(theme, [](Preferences& p, int at) { p.appearance = static_cast<Appearance>(at); });
    choice(language, [](Preferences& p, int at) { p.language = static_cast<Language>(at); });
    choice(unit, [](Preferences& p, int at) { p.unit = static_cast<LengthUnit>(at); });
    const auto number = [this](QDoubleSpinBox* box, double Preferences::*member) {
        connect(box, qOverload<double>(&QDoubleSpinBox::valueChanged), this,
                [this, member](double value) {
                    preferences_.*member = value;
                    Q_EMIT changed(preferences_);
                });
    };
    number(wheel, &Preferences::wheel_px);
    number(millions, &Preferences::surface_millions);
}

}  // namespace palpate::viewer
