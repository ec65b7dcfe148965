// The slice pane: its data, and how it is painted.
#include "apps/viewer/slices/slice_pane.hpp"

#include <QCoreApplication>
#include <QFontMetrics>
#include <QHelpEvent>
#include <QKeyEvent>
#include <QPainter>
#include <QToolTip>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "apps/viewer/model/measurement.hpp"
#include "apps/viewer/slices/slice_marks.hpp"
#include "apps/viewer/slices/slice_picture.hpp"
#include "palpate/lattice.hpp"

namespace palpate::viewer {
namespace {

/// Times as long as a slice took to draw, the next one waits.
constexpr qint64 rest = 3;

constexpr double least_zoom = 0.2, most_zoom = 200;
/// The narrowest window, as a part of the data's range.
constexpr double narrowest = 1e-4;

bool is_zoom_key(int key) {
    return key == Qt::Key_Plus || key == Qt::Key_Equal || key == Qt::Key_Minus;
}

GreyWindow whole_range(const Field& field) {
    const double low = field.volume().minimum();
    return {low, low + field.volume().range()};
}

}  // namespace

SlicePane::SlicePane(int axis, QWidget* parent) : QWidget(parent), axis_(axis), later_(this) {
    setObjectName(QStringLiteral("slice%1").arg(axis));
    setAccessibleName(tr("Slice"));
    setWhatsThis(
        tr("Wheel: next slice. Left: crosshair. Ctrl+left: the probe, if the mouse is the hand. "
           "Right drag: window (sideways) and level (up, down). Middle drag: move. "
           "Ctrl+wheel: zoom. Double click: this pane alone, or all again; with Shift: reset. "
           "Keys: arrows, Page Up and Down, +, -, Home."));
    setFocusPolicy(Qt::StrongFocus);
    setMouseTracking(true);
    setAttribute(Qt::WA_OpaquePaintEvent);
    setCursor(Qt::CrossCursor);
    later_.setSingleShot(true);
    connect(&later_, &QTimer::timeout, this, qOverload<>(&QWidget::update));
}

void SlicePane::set_field(const Field& field, double isovalue,
                          const std::optional<Geometry>& counted) {
    const Geometry grid = counted.value_or(field.geometry());
    const bool same = content_ &&
                      content_->samples.field().volume().data() == field.volume().data() &&
                      plane().grid == grid;
    shown_ = with_field(shown_, same ? &content_->samples.field() : nullptr, field, isovalue);
    content_ = std::make_unique<Content>(field, slice_plane(grid, axis_));
    if (!same) {
        view_ = {};
        snapshots_ = {};
    }
    setAccessibleName(tr("%1 slice").arg(title()));
    picture_changed();
}

void SlicePane::update_field(const Field& field) {
    if (!content_ || content_->samples.field().geometry() != field.geometry()) {
        throw std::invalid_argument("the pane shows no other version of these data");
    }
    content_->newer = field;
    update();
}

void SlicePane::clear() {
    content_.reset();
    snapshots_ = {};
    drag_ = Drag::none;
    setAccessibleName(tr("Slice"));
    update();
}

void SlicePane::set_shown(Shown shown) {
    if (!shown.crosshair.allFinite()) shown.crosshair = shown_.crosshair;
    if (shown == shown_) return;
    shown_ = std::move(shown);
    if (!shown_.probe && drag_ == Drag::probe) drag_ = Drag::none;
    update();
}

GreyWindow SlicePane::grey_window() const {
    for (const GreyWindow& one : {shown_.window, shown_.usual_window}) {
        if (one.low < one.high && std::isfinite(one.high - one.low)) return one;
    }
    return content_ ? whole_range(content_->samples.field()) : GreyWindow{0, 1};
}

SliceStyle SlicePane::style() const {
    const Look look = slice_look(shown_.look, shown_.layers);
    const double level = shown_.next_level.value_or(shown_.pressed.value_or(shown_.isovalue));
    return {grey_window(), colour_table(look.colours), level, look.surfaces, shown_.overlay,
            look.overlay};
}

/// Layer of the slice through the crosshair, along the grid axis. The samples follow when it is
/// painted. Beyond two layers outside of the grid, all layers are the same.
double SlicePane::layer() const {
    return std::clamp(plane().point(shown_.crosshair)[2], -2.0, plane().layers() + 1.0);
}

/// The same in another grid. A layer that is whole except for rounding becomes whole.
double SlicePane::layer_in(const SlicePlane& other) const {
    if (other.grid == plane().grid) return layer();
    constexpr double hair = 1e-6;
    const double at = other.point(plane().physical({0, 0, layer()}))[2];
    return std::abs(at - std::round(at)) < hair ? std::round(at) : at;
}

void SlicePane::show_snapshot(const std::optional<Snapshot>& snapshot, int hand) {
    constexpr double unseen_px = 0.1;
    std::optional<Snapshot>& shown = snapshots_[hand];
    if (!snapshot && !shown) return;
    if (snapshot && shown && content_ && looks_same(*snapshot, *shown, unseen_px / map().per_mm)) {
        return;
    }
    shown = snapshot;
    update();
}

int SlicePane::anatomical() const {
    return content_ ? plane().anatomical : axis_;
}

QString SlicePane::title() const {
    return content_ ? tr(plane().title.c_str()) : QString();
}

double SlicePane::margin() const {
    return QFontMetricsF(font()).height();
}

SliceMap SlicePane::map() const {
    return slice_map(plane(), view_, size(), margin());
}

QPointF SlicePane::pixel_of(const Vec3& physical) const {
    if (!content_) return {};
    const SliceMap where = map();
    return SliceSheet{plane(), where, 0, size()}.pixel(physical);
}

/// (u, v) as the nearest sample's if it lies outside the data.
Vec3 SlicePane::in_data(Vec3 point) const {
    point[0] = std::clamp(point[0], 0.0, plane().width() - 1.0);
    point[1] = std::clamp(point[1], 0.0, plane().height() - 1.0);
    return point;
}

Vec3 SlicePane::point_at(const QPointF& pixel) const {
    if (!content_) return Vec3::Zero();
    const QPointF at = map().sample(pixel);
    return plane().physical({at.x(), at.y(), layer()});
}

QSize SlicePane::sizeHint() const {
    return 20 * QSize(1, 1) * QFontMetrics(font()).height();
}

QSize SlicePane::minimumSizeHint() const {
    return 6 * QSize(1, 1) * QFontMetrics(font()).height();
}

void SlicePane::picture_changed() {
    if (content_) content_->picture = {};
    update();
}

/// Draws the picture if needed. Hand and data may change all the time, and a slice of a large
/// volume takes milliseconds. If only these have changed, the picture is drawn a little later, so
/// that most of the time remains for others.
void SlicePane::make_picture(const SliceMap& where) {
    Content& c = *content_;
    const double scale = devicePixelRatioF();
    const bool moved = layer() != c.layer;
    const SliceStyle now = style();
    if (now == c.style && !c.picture.isNull() &&
        c.picture.size() == (QSizeF(size()) * scale).toSize()) {
        if (!moved && !c.newer) return;
        const auto wait = rest * c.took_ms - c.made.elapsed();
        if (wait > 0) {
            if (!later_.isActive()) later_.start(static_cast<int>(wait) + 1);
            return;
        }
    }
    c.made.start();
    if (c.newer) c.samples.use(*c.newer);
    c.newer.reset();
    c.layer = layer();
    c.samples.go_to(layer_in(c.samples.plane()));
    c.style = now;
    const SliceMap map = map_in(c.samples.plane(), c.plane, where);
    c.picture = slice_picture(c.samples, map, now, size(), scale, finer_slice(where));
    c.took_ms = c.made.elapsed();
    c.made.start();
}

void SlicePane::set_detail(std::shared_ptr<const DetailField> detail) {
    if (!content_ || detail == content_->finer) return;
    content_->finer = std::move(detail);
    content_->finer_samples.reset();
    if (content_->finer) content_->finer_samples.emplace(content_->finer->field, content_->plane);
    picture_changed();
}

std::optional<SeenBox> SlicePane::seen() const {
    if (!content_ || !isVisible()) return std::nullopt;
    const SliceMap where = map();
    const QPointF low = where.sample({0, 0}), high = where.sample(QPointF(width(), height()));
    const auto at = [&](const QPointF& p) {
        return plane().physical(in_data({p.x(), p.y(), layer()}));
    };
    return SeenBox{at(low), at(high), 1 / (where.per_mm * devicePixelRatioF())};
}

const DetailField* SlicePane::shown_detail() const {
    if (!content_ || !content_->finer) return nullptr;
    // The layers before and after the slice, and one more of each for a smooth field.
    const DetailField& finer = *content_->finer;
    const double at = layer_in(content_->finer_samples->plane());
    const bool begins = finer.at_begin(axis_) || std::floor(at) >= 1;
    const bool ends =
        finer.at_end(axis_) || std::ceil(at) + 1 <= content_->finer_samples->plane().layers() - 1;
    return begins && ends ? content_->finer.get() : nullptr;
}

/// The part with finer samples. It excludes its edges, because a contour needs samples beyond them,
/// but reaches to the end of the data and beyond.
std::optional<FinerSlice> SlicePane::finer_slice(const SliceMap& where) {
    const DetailField* const finer = shown_detail();
    if (!finer) return std::nullopt;
    SliceSamples& samples = *content_->finer_samples;
    samples.go_to(layer_in(samples.plane()));
    constexpr double edge = 1.5, beyond = 1e6;
    const SliceMap map = map_in(samples.plane(), plane(), where);
    const auto range = [&](const ScreenAxis& s, int count) {
        const bool first = s.flip ? finer->at_end(s.axis) : finer->at_begin(s.axis);
        const bool last = s.flip ? finer->at_begin(s.axis) : finer->at_end(s.axis);
        return std::pair{first ? -beyond : edge, last ? beyond : count - 1 - edge};
    };
    const auto [left, right] = range(plane().right, samples.width());
    const auto [top, bottom] = range(plane().down, samples.height());
    const QRectF drawn(map.pixel(left, top), map.pixel(right, bottom));
    return FinerSlice{&samples, map, drawn & QRectF(rect())};
}

/// Value of the finest data that is loaded.
double SlicePane::value_there(const Vec3& physical) const {
    const DetailField* const finer = shown_detail();
    if (!finer) return value_at(content_->samples.field(), physical);
    const Vec3 index = index_from_physical(finer->field.geometry(), physical);
    const Vec3 last = (finer->field.geometry().size - Index3::Constant(2)).cast<double>();
    const bool inside = (index.array() >= 1).all() && (index.array() <= last.array()).all();
    return value_at(inside ? finer->field : content_->samples.field(), physical);
}

void SlicePane::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    if (!content_) {
        painter.fillRect(rect(), palette().window());
        painter.setPen(palette().color(QPalette::Disabled, QPalette::WindowText));
        painter.drawText(rect(), Qt::AlignCenter | Qt::TextWordWrap, tr("No volume"));
        return;
    }
    const SliceMap where = map();
    make_picture(where);
    painter.drawImage(QPointF(0, 0), content_->picture);
    const SliceSheet sheet{plane(), where, content_->layer, size()};
    const std::vector<SliceWords> words = words_in();
    painter.setClipRegion(QRegion(rect()) - place_of(words, font(), size()));
    paint_crosshair(painter, sheet, sheet.pixel(shown_.crosshair));
    painter.setClipping(false);
    const bool several = snapshots_[2].has_value();
    for (int hand = 1; hand <= most_hands; ++hand) {
        if (!snapshots_[hand]) continue;
        const Snapshot& now = *snapshots_[hand];
        paint_brush(painter, sheet, now.session.tick.proxy.scp, shown_.brush);
        paint_probe(painter, sheet, now, colours_of(hand), several ? QString::number(hand) : "");
    }
    for (const Measurement& measurement : shown_.measurements) {
        paint_measurement(painter, sheet, measurement, shown_.unit);
    }
    paint_words(painter, words, size());
    if (hasFocus()) {
        painter.setPen(QPen(palette().highlight().color(), 2));
        painter.setBrush(Qt::NoBrush);
        painter.drawRect(QRectF(rect()).adjusted(1, 1, -1, -1));
    }
}

/// Letters, and what the corners tell.
std::vector<SliceWords> SlicePane::words_in() const {
    const double layer = content_->layer;
    const int layers = plane().layers();
    const bool in_data = layer >= -0.5 && layer <= layers - 0.5;
    const Vec3 middle = point_at(QPointF(rect().center()));
    std::vector<SliceWords> all = letters_of(plane());
    QStringList corner{title(),
                       in_data ? QString("%1 / %2").arg(std::lround(layer) + 1).arg(layers)
                               : tr("outside the data"),
                       QString::fromStdString(position_text(plane(), middle))};
    const int beside = width() / 2 - fontMetrics().height();  // the letter of the upper edge
    if (fontMetrics().horizontalAdvance(title()) > beside) corner.push_front("");
    all.push_back({Qt::AlignLeft | Qt::AlignTop, corner.join('\n')});
    // Above the letter of the lower edge if there is no room beside it.
    const auto [low, high] = grey_window();
    QStringList grey{tr("W %1", "window, in the corner").arg(high - low, 0, 'g', 5),
                     tr("L %1", "level, in the corner").arg(0.5 * (low + high), 0, 'g', 5)};
    if (fontMetrics().horizontalAdvance(grey.back()) > beside) grey << "";
    all.push_back({Qt::AlignRight | Qt::AlignBottom, grey.join('\n')});
    if (!pointer_) return all;
    const Vec3 at = point_at(*pointer_);
    const Vec3 index = index_from_physical(plane().grid, at);
    if (!(index.cwiseAbs().maxCoeff() <= farthest_index)) return all;
    const Ruler ruler = ruler_of(plane().grid);
    const auto number = [&](double mm) { return QString::fromStdString(ruler.number(mm)); };
    QStringList words{QString("(%1, %2, %3) %4")
                          .arg(number(at[0]), number(at[1]), number(at[2]),
                               QCoreApplication::translate("Units", ruler.unit)),
                      QString::number(value_there(at), 'g', 6)};
    if (shown_.overlay && shown_.look.overlay.shown) {
        const QString there = overlay_words(*shown_.overlay, at);
        if (!there.isEmpty()) words.push_front(there);
    }
    all.push_back({Qt::AlignLeft | Qt::AlignBottom, words.join('\n')});
    return all;
}

bool SlicePane::event(QEvent* event) {
    // A tip over the picture would hide it: only over the words in the corner.
    if (event->type() == QEvent::ToolTip) {
        const auto* const help = static_cast<QHelpEvent*>(event);
        const int words = 5 * fontMetrics().height();
        if (help->pos().x() < words && help->pos().y() < words) {
            QToolTip::showText(help->globalPos(), whatsThis(), this);
        } else {
            QToolTip::hideText();
            event->ignore();
        }
        return true;
    }
    // With the focus here, these keys are not the menu's.
    if (event->type() == QEvent::ShortcutOverride && content_ &&
        is_zoom_key(static_cast<QKeyEvent*>(event)->key())) {
        event->accept();
        return true;
    }
    return QWidget::event(event);
}

void SlicePane::choose(const Vec3& physical) {
    set(*this, &Shown::crosshair, physical);
    Q_EMIT crosshair_chosen(physical);
}

/// The nearest point in the data.
void SlicePane::choose_at(const QPointF& pixel) {
    const QPointF at = map().sample(pixel);
    choose(plane().physical(in_data({at.x(), at.y(), layer()})));
}

Vec3 SlicePane::physical(const Aim& aim) const {
    return plane().physical({aim.at.x(), aim.at.y(), aim.layer});
}

void SlicePane::drag_probe(const Aim& to) {
    Q_EMIT probe_dragged(physical(to) - physical(aimed_));
    aimed_ = to;
}

/// Whole layers, up towards the patient's left, back or head; where coarser ones are shown, as far
/// as from one of those to the next.
double SlicePane::next_layer(double from, int steps) const {
    const DetailField* const finer = shown_detail();
    const Field& shown = finer ? finer->field : content_->samples.field();
    const double ratio = shown.geometry().spacing[axis_] / plane().grid.spacing[axis_];
    steps *= std::max(1, static_cast<int>(std::lround(ratio)));
    if (plane().grid.direction(plane().anatomical, axis_) < 0) steps = -steps;
    constexpr double hair = 1e-6;
    const double layer =
        steps > 0 ? std::floor(from + hair) + steps : std::ceil(from - hair) + steps;
    return std::clamp(layer, 0.0, plane().layers() - 1.0);
}

void SlicePane::step_slice(int steps) {
    Vec3 point = plane().point(shown_.crosshair);
    point[2] = next_layer(point[2], steps);
    choose(plane().physical(point));
}

/// The point at the pixel stays there.
void SlicePane::zoom_at(const QPointF& pixel, double factor) {
    const double zoom = std::clamp(view_.zoom * factor, least_zoom, most_zoom);
    const QPointF at = map().sample(pixel);
    view_.zoom = zoom;
    const SliceMap now = map();
    view_.moved += (pixel - now.pixel(at.x(), at.y())) / now.per_mm;
    picture_changed();
}

/// The pane's width is the data's range.
void SlicePane::change_window(const QPointF& drag) {
    const double range = content_->samples.field().volume().range();
    const double per_pixel = range / std::max(width(), 100);
    const auto [low, high] = grey_window();
    const double wide = std::max(high - low + drag.x() * per_pixel, narrowest * range);
    const double level = std::clamp(0.5 * (low + high) - drag.y() * per_pixel,
                                    content_->samples.field().volume().minimum() - range,
                                    content_->samples.field().volume().maximum() + range);
    choose_window({level - 0.5 * wide, level + 0.5 * wide});
}

void SlicePane::choose_window(const GreyWindow& window) {
    set(*this, &Shown::window, window);
    Q_EMIT window_chosen(window);
}

void SlicePane::reset() {
    view_ = {};
    picture_changed();
    choose_window({});
}

}  // namespace palpate::viewer
