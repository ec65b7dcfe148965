// Keeps modes, thresholds, table and bands of penetrability in step.
#include "apps/viewer/panel/penetrability_controls.hpp"

#include <QHBoxLayout>
#include <QHeaderView>
#include <QKeyEvent>
#include <QRadioButton>
#include <QSignalBlocker>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace palpate::viewer {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Ranges rising(Ranges ranges) {
    std::ranges::sort(ranges, {}, &DensityRange::low);
    return ranges;
}

}  // namespace

Penetrability penetrability_of(const PressThrough& shown, Solid solid) {
    if (shown.mode == PressThrough::Mode::off) return no_penetrability();
    Penetrability p = shown.mode == PressThrough::Mode::threshold
                          ? penetrability_threshold(shown.threshold, shown.minimum, solid)
                          : penetrability_ranges(shown.threshold, shown.ranges, solid);
    p.function = shown.function;
    p.context = shown.context;
    return p;
}

PressThrough shown_from(const Penetrability& p, Solid solid, PressThrough before) {
    // A single range without a far end is a threshold with a minimum, unless it was made as a
    // range.
    const bool as_ranges = before.mode == PressThrough::Mode::ranges;
    PressThrough shown = std::move(before);
    shown.mode = PressThrough::Mode::off;
    if (!p.on) return shown;
    shown.threshold = p.threshold;
    shown.function = p.function;
    shown.context = p.context;
    const DensityRange& first = p.ranges[0];
    const double far = solid == Solid::above ? first.high : -first.low;
    if (!as_ranges && p.range_count == 1 && far == infinity) {
        shown.mode = PressThrough::Mode::threshold;
        shown.minimum = solid == Solid::above ? first.low : first.high;
        return shown;
    }
    shown.mode = PressThrough::Mode::ranges;
    shown.ranges = rising(Ranges(p.ranges.begin(), p.ranges.begin() + p.range_count));
    return shown;
}

PressThrough first_press_through(double isovalue, double low, double high, Solid solid) {
    PressThrough shown;
    const double begin = std::isfinite(isovalue) ? std::clamp(isovalue, low, high) : low;
    shown.minimum = begin;
    const double width = 0.1 * (high - low);
    shown.ranges = {solid == Solid::above ? DensityRange{begin, begin + width}
                                          : DensityRange{begin - width, begin}};
    return shown;
}

Ranges bands_of(const PressThrough& shown, Solid solid) {
    switch (shown.mode) {
        case PressThrough::Mode::off:
            return {};
        case PressThrough::Mode::threshold:
            return {solid == Solid::above ? DensityRange{shown.minimum, infinity}
                                          : DensityRange{-infinity, shown.minimum}};
        case PressThrough::Mode::ranges:
            break;
    }
    return shown.ranges;
}

PressThrough with_bands(PressThrough shown, const Ranges& bands, Solid solid) {
    if (shown.mode == PressThrough::Mode::threshold && !bands.empty()) {
        shown.minimum = solid == Solid::above ? bands.front().low : bands.front().high;
    } else if (shown.mode == PressThrough::Mode::ranges) {
        shown.ranges = bands;
    }
    return shown;
}

RangeTable::RangeTable() : QTableWidget(0, 2) {
    setObjectName("ranges");
    setAccessibleName(tr("Ranges of interest"));
    setHorizontalHeaderLabels({tr("from"), tr("to")});
    horizontalHeader()->setSectionResizeMode(QHeaderView::Stretch);
    verticalHeader()->setDefaultSectionSize(static_cast<int>(1.7 * fontMetrics().height()));
    setSelectionBehavior(QAbstractItemView::SelectRows);
    setSelectionMode(QAbstractItemView::SingleSelection);
    setTabKeyNavigation(false);  // Tab leaves the table
    setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
    setToolTip(
        tr("Ranges of interest [data units]: only these levels are felt. Del deletes a row."));
    connect(this, &QTableWidget::cellChanged, this, &RangeTable::read);
    connect(this, &QTableWidget::itemSelectionChanged, this,
            [this] { Q_EMIT row_chosen(chosen()); });
}

void RangeTable::write(int row) {
    const DensityRange& range = ranges_[static_cast<std::size_t>(row)];
    const QString texts[] = {number_text(range.low), number_text(range.high)};
    for (int column = 0; column < 2; ++column) {
        if (!item(row, column)) setItem(row, column, new QTableWidgetItem);
        item(row, column)->setText(texts[column]);
    }
}

void RangeTable::set_ranges(const Ranges& ranges) {
    const QSignalBlocker quiet(this);
    const bool resized = ranges.size() != ranges_.size();
    ranges_ = ranges;
    setRowCount(static_cast<int>(ranges.size()));
    for (int row = 0; row < rowCount(); ++row) {
        write(row);
        if (!verticalHeaderItem(row)) {
            auto* chip = new QTableWidgetItem(QString::number(row + 1));
            chip->setIcon(icon_of(from_qt(band_colour(row))));
            setVerticalHeaderItem(row, chip);
        }
    }
    if (resized) updateGeometry();
}

int RangeTable::chosen() const {
    return selectedItems().isEmpty() ? -1 : selectedItems().front()->row();
}

void RangeTable::choose(int row) {
    const QSignalBlocker quiet(this);
    if (row < 0) {
        clearSelection();
    } else {
        selectRow(row);
    }
}

void RangeTable::read(int row, int column) {
    if (row >= static_cast<int>(ranges_.size())) return;
    DensityRange range = ranges_[static_cast<std::size_t>(row)];
    double& end = column == 0 ? range.low : range.high;
    const QString text = item(row, column)->text();
    if (text == number_text(end)) return;  // only looked at
    if (const auto number = number_from(text.trimmed())) {
        end = *number;
        Q_EMIT edited(row, range);
        return;
    }
    {
        const QSignalBlocker quiet(this);
        write(row);
    }
    Q_EMIT nonsense(tr("'%1' is not a number").arg(text));
}

void RangeTable::keyPressEvent(QKeyEvent* event) {
    if ((event->key() == Qt::Key_Delete || event->key() == Qt::Key_Backspace) &&
        currentRow() >= 0) {
        Q_EMIT delete_wanted(currentRow());
        return;
    }
    QTableWidget::keyPressEvent(event);
}

QSize RangeTable::sizeHint() const {
    const int rows = std::clamp(rowCount(), 1, 5);
    const int height = horizontalHeader()->sizeHint().height() +
                       rows * verticalHeader()->defaultSectionSize() + 2 * frameWidth();
    return {14 * fontMetrics().height(), height};
}

namespace {

using Mode = PressThrough::Mode;

struct ModeText {
    const char* name;
    const char* text;
    const char* tip;
};
constexpr ModeText mode_texts[] = {
    {"penetrability_off", QT_TRANSLATE_NOOP("palpate::viewer::PenetrabilityControls", "Off"),
     QT_TRANSLATE_NOOP("palpate::viewer::PenetrabilityControls",
                       "Surfaces hold, however hard the hand presses")},
    {"penetrability_threshold",
     QT_TRANSLATE_NOOP("palpate::viewer::PenetrabilityControls", "Threshold"),
     QT_TRANSLATE_NOOP(
         "palpate::viewer::PenetrabilityControls",
         "A surface that is pressed deeper than PT gives way: the level felt follows the hand")},
    {"penetrability_ranges", QT_TRANSLATE_NOOP("palpate::viewer::PenetrabilityControls", "Ranges"),
     QT_TRANSLATE_NOOP("palpate::viewer::PenetrabilityControls",
                       "As Threshold, but only levels in the ranges of interest are felt")}};

}  // namespace

PenetrabilityControls::PenetrabilityControls(Effect& effect, LevelChart& chart)
    : effect_(effect), chart_(&chart), table_(new RangeTable) {
    auto* form = new QFormLayout;
    auto* threshold = quantity_in(
        *form,
        {"threshold", "PT",
         tr("PT, the penetration threshold [mm of the hand]: pulled further apart than this, hand "
            "and proxy get the surface to give way. The spring never exceeds stiffness x PT."),
         tr("PT, penetration threshold")},
        {"mm", 0, 5, 0.1},
        {[this] { return shown_.threshold; },
         [this](double to) { change([=](PressThrough& p) { p.threshold = to; }); }});
    threshold->box().set_infinite(true);
    each_time(threshold, [this](QWidget& one) { one.setEnabled(shown_.mode != Mode::off); });
    auto* row = new QWidget;
    auto* box = number({"minimum", ""},
                       {[this] { return shown_.minimum; },
                        [this](double to) { change([=](PressThrough& p) { p.minimum = to; }); }});
    box->set_infinite(true);
    add_row(*form_in(row), tr("Minimum level"), box,
            tr("The least level felt [data units] (the greatest, where below is solid); also by "
               "the end of the band on the histogram"));
    each_time(row, [this, box](QWidget& one) {
        box->setSingleStep(chart_->fine_step());
        one.setVisible(shown_.mode == Mode::threshold);
    });
    auto* column = column_in(this);
    column->addLayout(make_modes());
    column->addLayout(form);
    column->addWidget(row);
    column->addWidget(make_ranges());
    connect_chart();
    connect(&effect_, &Effect::begun, this, &PenetrabilityControls::begin);
    connect(&effect_, &Effect::ended, this, [this] { dragging_ = false; });
    connect(&effect_, &Effect::changed, this, &PenetrabilityControls::show_effect);
    refresh();
}

QLayout* PenetrabilityControls::make_modes() {
    auto* modes = new QHBoxLayout;
    for (int i = 0; i < 3; ++i) {
        const auto mode = static_cast<Mode>(i);
        auto* one = named(new QRadioButton(tr(mode_texts[i].text)), mode_texts[i].name,
                          tr(mode_texts[i].tip));
        modes->addWidget(one);
        connect(one, &QRadioButton::clicked, this, [this, mode] {
            if (mode != shown_.mode) change([=](PressThrough& p) { p.mode = mode; });
        });
        each_time(one, [this, mode](QRadioButton& b) { b.setChecked(shown_.mode == mode); });
    }
    modes->addStretch(1);
    return modes;
}

QWidget* PenetrabilityControls::make_ranges() {
    connect(table_, &RangeTable::edited, this, [this](int row, const DensityRange& range) {
        change([&](PressThrough& p) { p.ranges[static_cast<std::size_t>(row)] = range; });
    });
    connect(table_, &RangeTable::nonsense, this, &PenetrabilityControls::nonsense);
    connect(table_, &RangeTable::delete_wanted, this, &PenetrabilityControls::remove_range);
    each_time(table_, [this](RangeTable& table) { table.set_ranges(shown_.ranges); });
    auto* buttons =
        row_of({button({"add_range", tr("Add range"),
                        tr("Another range of interest; or shift-drag on the histogram")},
                       [this] { add_range(room_for_a_range()); }),
                button({"delete_range", tr("Delete range"), tr("Delete the chosen range")},
                       [this] { remove_range(table_->chosen()); })});
    buttons->layout()->setAlignment(Qt::AlignLeft);
    auto* whole = column_of({table_, buttons});
    return each_time(whole, [this](QWidget& w) { w.setVisible(shown_.mode == Mode::ranges); });
}

void PenetrabilityControls::connect_chart() {
    connect(table_, &RangeTable::row_chosen, chart_, &LevelChart::choose_band);
    connect(chart_, &LevelChart::band_chosen, table_, &RangeTable::choose);
    connect(chart_, &LevelChart::band_added, this, &PenetrabilityControls::add_range);
    connect(chart_, &LevelChart::band_deleted, this, &PenetrabilityControls::remove_range);
    connect(chart_, &LevelChart::bands_moved, this, [this](const Ranges& bands) {
        dragging_ = true;
        shown_ = with_bands(shown_, bands, solid_);
        refresh();
        request();
    });
    connect(chart_, &LevelChart::bands_settled, this, [this] {
        if (!std::exchange(dragging_, false)) return;
        change([](PressThrough&) {});  // bands that were drawn over each other become one
    });
    each_time(chart_, [this](LevelChart& chart) {
        chart.set_editable(shown_.mode == Mode::ranges);
        chart.set_bands(bands_of(shown_, solid_));
    });
}

/// Modes that are not in use begin at the level and with the range of the data.
void PenetrabilityControls::begin() {
    dragging_ = false;
    const Volume& volume = effect_.field().volume();
    solid_ = effect_.field().solid();
    shown_ = first_press_through(effect_.isovalue(), volume.minimum(),
                                 volume.minimum() + volume.range(), solid_);
}

/// While layers are felt, this rests.
void PenetrabilityControls::show_effect() {
    allow(*this, have_surfaces(effect_.settings().layers)
                     ? tr("Layers are felt: their surfaces give way by puncture forces. Choose No "
                          "layers to press through by depth")
                     : QString());
    if (dragging_) return;  // overlapping bands are merged when the drag ends
    shown_ = shown_from(effect_.settings().penetrability, solid_, shown_);
    refresh();
}

/// What cannot be is refused there, or here in words.
void PenetrabilityControls::request() {
    if (!effect_.there()) return;
    try {
        const Penetrability penetrability = penetrability_of(shown_, solid_);
        const bool ends = effect_.settings().penetrability.on && !penetrability.on;
        const bool done = effect_.request(penetrability);
        // Else the session keeps the level that the hand has reached.
        if (ends && done) effect_.request(command::Isovalue{effect_.isovalue()});
    } catch (const std::invalid_argument& error) {
        Q_EMIT nonsense(QString::fromStdString(error.what()));
        show_effect();
    }
}

void PenetrabilityControls::change(const std::function<void(PressThrough&)>& how) {
    how(shown_);
    refresh();
    request();
}

/// The first range asks for the mode, too.
void PenetrabilityControls::add_range(const DensityRange& range) {
    change([&](PressThrough& p) {
        if (p.mode != Mode::ranges) p.ranges.clear();
        p.mode = Mode::ranges;
        p.ranges.push_back(range);
        std::ranges::sort(p.ranges, {}, &DensityRange::low);
    });
}

void PenetrabilityControls::remove_range(int which) {
    if (which < 0 || which >= static_cast<int>(shown_.ranges.size())) {
        Q_EMIT nonsense(tr("choose the range to delete, in the table or on the histogram"));
    } else if (shown_.ranges.size() == 1) {
        Q_EMIT nonsense(tr("the last range stays: switch penetrability off to have none"));
    } else {
        change([=](PressThrough& p) { p.ranges.erase(p.ranges.begin() + which); });
    }
}

/// In the middle of the widest gap, a third of it wide at most.
DensityRange PenetrabilityControls::room_for_a_range() const {
    const LevelAxis whole = chart_->whole_axis();
    DensityRange gap{whole.low, whole.low};
    double end = whole.low;
    const auto consider = [&](double from, double to) {
        if (to - from > gap.high - gap.low) gap = {from, to};
    };
    if (shown_.mode == Mode::ranges) {
        for (const DensityRange& range : shown_.ranges) {
            consider(end, range.low);
            end = std::max(end, range.high);
        }
    }
    consider(end, whole.high);
    const double width = gap.high - gap.low;
    const LevelAxis axis = chart_->axis();
    return {rounded_to(gap.low + width / 3, axis.step()),
            rounded_to(gap.high - width / 3, axis.step())};
}

}  // namespace palpate::viewer
