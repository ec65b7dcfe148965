// Makes controls, connects them with their values, and looks names up among the translations.
#include "apps/viewer/panel/form.hpp"

#include <QComboBox>
#include <QCoreApplication>
#include <algorithm>
#include <utility>

#include "apps/viewer/model/measurement.hpp"

namespace palpate::viewer {
namespace {

template <class Widget>
Widget* worded(Widget* widget, const Words& words) {
    named(widget, words.name, words.tip);
    if (!words.spoken.isEmpty()) widget->setAccessibleName(words.spoken);
    return widget;
}

}  // namespace

Value<double> within(double low, double high, Value<double> value) {
    return {value.get, [=, set = value.set](double to) { set(std::clamp(to, low, high)); }};
}

void Form::refresh() {
    for (const auto& show : showing_) show();
}

QCheckBox* Form::check(const Words& words, Value<bool> value) {
    auto* box = worded(new QCheckBox(words.text), words);
    connect(box, &QCheckBox::clicked, this, taking(value));
    return each_time(box, [get = value.get](QCheckBox& shown) { shown.setChecked(get()); });
}

NumberBox* Form::number(const Words& words, Value<double> value) {
    auto* box = worded(new NumberBox, words);
    connect(box, qOverload<double>(&NumberBox::valueChanged), this, taking(value));
    return each_time(box, [get = value.get](NumberBox& shown) { shown.show_value(get()); });
}

Quantity* Form::quantity(const Words& words, const Span& span, Value<double> value) {
    auto* row = new Quantity(words.name, span.unit, span.low, span.high, span.step, span.scale);
    row->setToolTip(words.tip);
    row->set_accessible_name(!words.spoken.isEmpty() ? words.spoken
                             : !words.text.isEmpty() ? words.text
                                                     : first_words(words.tip));
    connect(row, &Quantity::wanted, this, taking(value));
    return each_time(row, [get = value.get](Quantity& shown) { shown.set_value(get()); });
}

Quantity* Form::quantity_in(QFormLayout& form, const Words& words, const Span& span,
                            Value<double> value) {
    Quantity* row = quantity(words, span, std::move(value));
    add_row(form, words.text, row, words.tip);
    return row;
}

ColourButton* Form::colour(const Words& words, Value<Colour> value) {
    auto* button = new ColourButton(words.name, words.tip);
    connect(button, &ColourButton::wanted, this, taking(value));
    return each_time(button, [get = value.get](ColourButton& shown) { shown.set_colour(get()); });
}

QComboBox* Form::choice(const Words& words, const QStringList& choices, Value<int> value) {
    auto* box = worded(new QComboBox, words);
    box->addItems(choices);
    let_wheel_pass(*box);
    connect(box, qOverload<int>(&QComboBox::activated), this, taking(value));
    return each_time(box, [get = value.get](QComboBox& shown) { shown.setCurrentIndex(get()); });
}

QComboBox* Form::choice(const Words& words, const std::vector<std::string>& names,
                        Value<std::string> value) {
    auto* box = worded(new QComboBox, words);
    for (const std::string& name : names) add_choice(*box, name);
    let_wheel_pass(*box);
    connect(box, qOverload<int>(&QComboBox::activated), this, [box, set = taking(value)](int at) {
        set(box->itemData(at).toString().toStdString());
    });
    return each_time(box, [get = value.get](QComboBox& shown) {
        shown.setCurrentIndex(shown.findData(QString::fromStdString(get())));
    });
}

QPushButton* Form::button(const Words& words, std::function<void()> press,
                          std::function<bool()> possible) {
    auto* button = worded(new QPushButton(words.text), words);
    connect(button, &QPushButton::clicked, this, [this, press = std::move(press)] {
        press();
        refresh();
    });
    if (!possible) return button;
    return each_time(button, [possible = std::move(possible)](QPushButton& shown) {
        shown.setEnabled(possible());
    });
}

EffectForm::EffectForm(Effect& effect) : effect_(effect) {
    connect(&effect, &Effect::begun, this, [this] { begin(); });
    connect(&effect, &Effect::changed, this, &Form::refresh);
    connect(&effect, &Effect::ended, this, [this] {
        clear();
        refresh();
    });
}

Quantity* EffectForm::length_in(QFormLayout& form, const Words& words, const Span& span,
                                Value<double> value) {
    Quantity* row = quantity_in(form, words, span, std::move(value));
    connect(&effect_, &Effect::begun, row, [this, row, low = span.low, high = span.high] {
        const Ruler ruler = ruler_of(effect_.field().geometry());
        row->set_unit(QCoreApplication::translate("Units", ruler.unit), ruler.per_mm);
        row->set_ends(low / ruler.per_mm, high / ruler.per_mm);
    });
    return row;
}

namespace {

/// Words of this file. The names stand here for the translators alone.
struct Names {
    Q_DECLARE_TR_FUNCTIONS(Names)

    [[maybe_unused]] static constexpr const char* to_translate[] = {
        // transfer functions
        QT_TR_NOOP("CT bone"), QT_TR_NOOP("CT skin"), QT_TR_NOOP("CT soft tissue"),
        QT_TR_NOOP("Dense parts"), QT_TR_NOOP("Outer surface"), QT_TR_NOOP("Soft parts"),
        QT_TR_NOOP("MR"), QT_TR_NOOP("Microscopy"), QT_TR_NOOP("Grey"),
        // colour maps
        QT_TR_NOOP("grey"), QT_TR_NOOP("hot"), QT_TR_NOOP("bone"), QT_TR_NOOP("viridis"),
        QT_TR_NOOP("cool-warm"), QT_TR_NOOP("spectrum"),
        // causes of slow ticks
        QT_TR_NOOP("none"), QT_TR_NOOP("the machine"), QT_TR_NOOP("the device"),
        QT_TR_NOOP("the proxy update"), QT_TR_NOOP("the rest of the tick"), QT_TR_NOOP("unknown")};
};

}  // namespace

QString shown_name(const std::string& name) {
    return Names::tr(name.c_str());
}

QString shown_set(const std::string& name) {
    const QString text = QString::fromStdString(name);
    if (text.isEmpty() || text == "Own layers") return Names::tr("Own layers");
    if (const QString begin("Labels of "); text.startsWith(begin)) {
        return Names::tr("Labels of %1").arg(text.mid(begin.size()));
    }
    if (const QString end(", by label"); text.endsWith(end)) {
        return Names::tr("%1, by label").arg(text.chopped(end.size()));
    }
    return text;
}

QString felt_text(const LayersFelt& felt, const SharedLayers& layers) {
    const FeltWords words{Names::tr("on %1").toStdString(), Names::tr("in %1").toStdString(),
                          Names::tr("on %1, in %2").toStdString(),
                          Names::tr("on %1, from inside").toStdString()};
    return QString::fromStdString(felt_words(felt, layers, words));
}

void add_choice(QComboBox& box, const std::string& name) {
    box.addItem(shown_name(name), QString::fromStdString(name));
}

}  // namespace palpate::viewer
