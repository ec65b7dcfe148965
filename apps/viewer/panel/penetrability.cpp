// The section of penetrability: threshold, ranges, and their bands on the level chart.
#include <QBoxLayout>
#include <QCoreApplication>
#include <QLabel>
#include <QPushButton>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <utility>

#include "apps/viewer/panel/form.hpp"
#include "apps/viewer/panel/level_chart.hpp"
#include "apps/viewer/panel/sentences.hpp"

namespace palpate::viewer {
namespace {

/// The values that are shown. While penetrability is off, they are kept for later.
struct Pressing {
    bool on = false;
    double threshold = 1;  ///< PT [device mm]
    Ranges ranges;         ///< [data units] in any order
};

class PenetrabilityControls : public EffectForm {
    Q_DECLARE_TR_FUNCTIONS(palpate::viewer::PenetrabilityControls)

  public:
    PenetrabilityControls(Effect& effect, LevelChart& chart) : EffectForm(effect), chart_(chart) {
        each_time(this, [this](QWidget&) { show_effect(); });
        auto* on =
            check({"penetrability", tr("Surfaces give way"),
                   tr("A surface that is pressed deep enough gives way: the level felt follows the "
                      "hand")},
                  pressing_[&Pressing::on]);
        auto* form = form_in();
        auto* threshold = quantity_in(
            *form,
            {"threshold", tr("Depth"),
             tr("How deep the hand presses before the surface gives way [mm of the hand]: the "
                "penetration threshold, PT. The spring never exceeds stiffness x PT."),
             tr("Depth at which surfaces give way")},
            {"mm", 0, 5, 0.1}, pressing_[&Pressing::threshold]);
        threshold->box().set_infinite(true);
        each_time(threshold, [this](QWidget& one) { one.setEnabled(shown_.on); });
        auto* column = column_in(this);
        column->addWidget(on, 0, Qt::AlignLeft);
        column->addLayout(form);
        column->addWidget(make_ranges());
        connect_chart();
        refresh();
    }

  private:
    QWidget* make_ranges() {
        auto* all = column_of({new QLabel(tr("Levels that are felt, from and to"))});
        all->layout()->setSpacing(2);
        for (std::size_t i = 0; i < Penetrability::most_ranges; ++i) {
            all->layout()->addWidget(make_range(i));
        }
        auto* add = button({"add_range", tr("Add range"),
                            tr("Another range of interest; or shift-drag on the histogram")},
                           [this] { add_range(room_for_a_range()); });
        all->layout()->addWidget(row_of({add, new QLabel}, 1));
        return each_time(all, [this](QWidget& one) { one.setVisible(shown_.on); });
    }

    /// Rows of ranges that there are not are hidden.
    QWidget* make_range(std::size_t at) {
        const int number = static_cast<int>(at) + 1;
        const QString name = QString("range_%1").arg(number);
        const auto range = pressing_.at(&Pressing::ranges, at);
        auto* low = this->number(
            {name + "_low", "",
             tr("The least level of this range [data units]; also by the end of its band on the "
                "histogram. -inf: without an end"),
             tr("Range %1, from").arg(number)},
            range[&DensityRange::low]);
        auto* high = this->number(
            {name + "_high", "",
             tr("The greatest level of this range [data units]; also by the end of its band on the "
                "histogram. inf: without an end"),
             tr("Range %1, to").arg(number)},
            range[&DensityRange::high]);
        for (NumberBox* box : {low, high}) {
            box->set_infinite(true);
            box->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
            each_time(box, [this](NumberBox& one) { one.setSingleStep(chart_.fine_step()); });
        }
        auto* chip = new QLabel;
        chip->setPixmap(icon_of(from_qt(band_colour(number - 1))).pixmap(16, 16));
        auto* remove = button(
            {name + "_remove", "×", tr("Remove it"), tr("Remove range %1").arg(number)},
            [this, at] { remove_range(at); }, [this] { return shown_.ranges.size() > 1; });
        remove->setMaximumWidth(2 * fontMetrics().height());
        return each_time(row_of({chip, low, high, remove}),
                         [this, at](QWidget& one) { one.setVisible(at < shown_.ranges.size()); });
    }

    void connect_chart() {
        connect(&chart_, &LevelChart::band_added, this, &PenetrabilityControls::add_range);
        connect(&chart_, &LevelChart::band_deleted, this,
                [this](int band) { remove_range(static_cast<std::size_t>(band)); });
        connect(&chart_, &LevelChart::bands_moved, this, [this](const Ranges& bands) {
            dragging_ = true;
            change([&](Pressing& p) { p.ranges = bands; });
            refresh();
        });
        connect(&chart_, &LevelChart::bands_settled, this, [this] {
            // Bands that were drawn over each other become one.
            if (std::exchange(dragging_, false)) request();
        });
        each_time(&chart_, [this](LevelChart& chart) {
            chart.set_bands(shown_.on ? shown_.ranges : Ranges());
        });
    }

    /// At first, all levels from this one into the solid can be touched.
    void begin() override {
        constexpr double infinity = std::numeric_limits<double>::infinity();
        const Volume& volume = effect_.field().volume();
        const double low = volume.minimum(), level = effect_.isovalue();
        const double first =
            std::isfinite(level) ? std::clamp(level, low, low + volume.range()) : low;
        clear();
        shown_.ranges = {effect_.field().solid() == Solid::above ? DensityRange{first, infinity}
                                                                 : DensityRange{-infinity, first}};
    }

    void clear() override {
        dragging_ = false;
        shown_ = {};
    }

    /// While layers are used, this has no effect.
    void show_effect() {
        allow(*this, have_surfaces(effect_.settings().layers)
                         ? tr("Layers are felt: their surfaces give way by puncture forces. Choose "
                              "No layers to press through by depth")
                         : QString());
        if (dragging_) return;  // overlapping bands are merged when the drag ends
        const Penetrability& now = effect_.settings().penetrability;
        shown_.on = now.on;
        if (!now.on) return;
        shown_.threshold = now.threshold;
        shown_.ranges.assign(now.ranges.begin(), now.ranges.begin() + now.range_count);
        std::ranges::sort(shown_.ranges, {}, &DensityRange::low);
    }

    /// Invalid values are refused by the effect, or here with a message.
    void request() {
        if (!effect_.there()) return;
        try {
            const Penetrability before = effect_.settings().penetrability;
            Penetrability next = no_penetrability();
            if (shown_.on) {
                next =
                    penetrability_ranges(shown_.threshold, shown_.ranges, effect_.field().solid());
                next.function = before.function;
                next.context = before.context;
            }
            // Else the session keeps the level that the hand has reached.
            if (effect_.request(next) && before.on && !next.on) {
                effect_.request(command::Isovalue{effect_.isovalue()});
            }
        } catch (const std::invalid_argument& error) {
            Q_EMIT nonsense(in_words(error.what()));
            refresh();
        }
    }

    void change(const std::function<void(Pressing&)>& how) {
        how(shown_);
        request();
    }

    /// The first range asks for pressing through, too. One inside of a range without an end takes
    /// its place.
    void add_range(const DensityRange& range) {
        change([&](Pressing& p) {
            if (!p.on) p.ranges.clear();
            p.on = true;
            std::erase_if(p.ranges, [&](const DensityRange& one) {
                return std::isinf(one.high - one.low) && one.low <= range.low &&
                       range.high <= one.high;
            });
            p.ranges.push_back(range);
        });
    }

    void remove_range(std::size_t which) {
        if (shown_.ranges.size() == 1) {
            Q_EMIT nonsense(tr("the last range stays: switch pressing through off to have none"));
        } else {
            change([=](Pressing& p) { p.ranges.erase(p.ranges.begin() + std::ptrdiff_t(which)); });
        }
    }

    /// In the middle of the widest gap, a third of it wide at most.
    DensityRange room_for_a_range() const {
        const LevelAxis whole = chart_.whole_axis();
        DensityRange gap{whole.low, whole.low};
        double end = whole.low;
        const auto consider = [&](double from, double to) {
            if (to - from > gap.high - gap.low) gap = {from, to};
        };
        for (const DensityRange& range : shown_.on ? shown_.ranges : Ranges()) {
            consider(end, range.low);
            end = std::max(end, range.high);
        }
        consider(end, whole.high);
        const double third = (gap.high - gap.low) / 3, step = chart_.axis().step();
        return {rounded_to(gap.low + third, step), rounded_to(gap.high - third, step)};
    }

    LevelChart& chart_;
    Pressing shown_;
    const Parts<Pressing> pressing_{
        [this]() -> const Pressing& { return shown_; },
        [this](const std::function<void(Pressing&)>& how) { change(how); }};
    bool dragging_ = false;  // a band
};

}  // namespace

Form* penetrability_section(Effect& effect, LevelChart& chart) {
    return new PenetrabilityControls(effect, chart);
}

}  // namespace palpate::viewer
