// Keeps preferences in QSettings, and shows them in a form.
#include "apps/viewer/window/preferences.hpp"

#include <QComboBox>
#include <QDialogButtonBox>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QSettings>
#include <algorithm>

#include "apps/viewer/panel/layout.hpp"

namespace palpate::viewer {
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
