// Makes controls, and connects them with their values.
#include "apps/viewer/panel/form.hpp"

#include <algorithm>
#include <utility>

#include "apps/viewer/panel/names.hpp"

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

}  // namespace palpate::viewer
