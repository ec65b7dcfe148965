// Controls that are bound to values: the words of a control, its value and the effect of a change
// stand in one place. A form keeps no values of its own. Also names in the person's language, and
// the sections of the panel that only show and change the session in effect.
#pragma once

#include <QCheckBox>
#include <QComboBox>
#include <QPushButton>
#include <QString>
#include <QWidget>

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "apps/viewer/model/layer_set.hpp"
#include "apps/viewer/panel/colours.hpp"
#include "apps/viewer/panel/effect.hpp"
#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/panel/layout.hpp"

namespace palpate::viewer {

class LevelChart;

struct Words {
    QString name;         ///< of the object
    QString text;         ///< on the control, or beside it
    QString tip = {};     ///< one can be set later
    QString spoken = {};  ///< by screen readers; empty: the text, or what the tip begins with
};

/// What a control shows, and what is done when a person changes it.
template <class T>
struct Value {
    std::function<T()> get;
    std::function<void(const T&)> set;
};

/// A whole, whose parts controls show and change.
template <class Whole>
struct Parts {
    std::function<const Whole&()> get;
    std::function<void(const std::function<void(Whole&)>&)> change;

    template <class T>
    Value<T> operator[](T Whole::*member) const {
        return {[whole = get, member] { return whole().*member; },
                [alter = change, member](const T& to) {
                    alter([&](Whole& whole) { whole.*member = to; });
                }};
    }
    /// An item of a list. One that is not there has the usual values, and is not changed.
    template <class Item>
    Parts<Item> at(std::vector<Item> Whole::*list, std::size_t place) const {
        return {[whole = get, list, place]() -> const Item& {
                    static const Item usual{};
                    const std::vector<Item>& all = whole().*list;
                    return place < all.size() ? all[place] : usual;
                },
                [alter = change, list, place](const std::function<void(Item&)>& how) {
                    alter([&](Whole& whole) {
                        if (place < (whole.*list).size()) how((whole.*list)[place]);
                    });
                }};
    }
};

/// Changes are brought to `low` to `high`.
Value<double> within(double low, double high, Value<double> value);
inline Value<double> as_part(Value<double> value) {
    return within(0, 1, std::move(value));
}

/// Of a slider; and the step of its box.
struct Span {
    QString unit;
    double low, high, step;
    Quantity::Scale scale = Quantity::Scale::amounts;
};
/// Of opacities.
inline const Span parts_span{"", 0, 1, 0.05};

class Form : public QWidget {
    Q_OBJECT

  public:
    /// All controls show their values, which must be there.
    void refresh();

  Q_SIGNALS:
    /// What was asked for cannot be, and why; empty: all is well again.
    void nonsense(const QString& why);

  public:
    QCheckBox* check(const Words& words, Value<bool> value);
    NumberBox* number(const Words& words, Value<double> value);
    Quantity* quantity(const Words& words, const Span& span, Value<double> value);
    ColourButton* colour(const Words& words, Value<Colour> value);
    /// The value is the number of a choice, from 0.
    QComboBox* choice(const Words& words, const QStringList& choices, Value<int> value);
    /// Choices by their names, as shown_name() has them.
    QComboBox* choice(const Words& words, const std::vector<std::string>& names,
                      Value<std::string> value);
    QPushButton* button(const Words& words, std::function<void()> press,
                        std::function<bool()> possible = nullptr);
    /// A quantity with its label, its text, in a form.
    Quantity* quantity_in(QFormLayout& form, const Words& words, const Span& span,
                          Value<double> value);
    /// Calls how(*widget) whenever the values are shown.
    template <class Widget, class How>
    Widget* each_time(Widget* widget, How how) {
        showing_.push_back([widget, how] { how(*widget); });
        return widget;
    }

  private:
    /// A change by a person.
    template <class T>
    auto taking(const Value<T>& value) {
        return [this, set = value.set](const auto& changed) {
            set(static_cast<T>(changed));
            refresh();
        };
    }

    std::vector<std::function<void()>> showing_;
};

/// A form for the session in effect. It is shown again after each change.
class EffectForm : public Form {
  protected:
    explicit EffectForm(Effect& effect);
    /// Another session has begun.
    virtual void begin() {}
    /// There is none any more.
    virtual void clear() {}
    /// A length in the volume: `span` is for volumes in mm, others have the unit of their
    /// positions.
    Quantity* length_in(QFormLayout& form, const Words& words, const Span& span,
                        Value<double> value);

    Effect& effect_;
};

/// Of transfer functions, colour maps, and causes of slow ticks; others as they are. Files keep the
/// names themselves.
QString shown_name(const std::string& name);

QString shown_set(const std::string& name);

/// What felt_words() says, in the person's language.
QString felt_text(const LayersFelt& felt, const SharedLayers& layers);

/// Adds a choice that is shown so, with the name itself as its data.
void add_choice(QComboBox& box, const std::string& name);

/// Switches for forces, freeze and clutch, the force against its limit, and the contact.
Form* session_section(Effect& effect);

/// How contact feels: a row for each number in the tables of force and friction. The sliders end at
/// what the device can render.
Form* force_section(Effect& effect);

/// Whether surfaces give way, past which threshold, and the ranges of levels that are felt. These
/// are bands on the chart, too, which the section does not own. Object names: penetrability,
/// threshold, add_range, and of the ranges, from N = 1, range_N_low, range_N_high, range_N_remove.
Form* penetrability_section(Effect& effect, LevelChart& chart);

}  // namespace palpate::viewer
