// The slice pane: its data and how it is painted. Input is in slice_pane_events.cpp.
#include "apps/viewer/slices/slice_pane.hpp"

#include <QFontMetrics>
#include <QPaintEvent>
#include <QPainter>

#include <cmath>
#include <stdexcept>

#include "apps/viewer/slices/slice_content.hpp"
#include "apps/viewer/slices/slice_marks.hpp"
#include "palpate/lattice.hpp"

namespace palpate::viewer {
namespace {

/// Times as long as a slice took to draw, the next one waits.
constexpr qint64 rest = 3;

}  // namespace

SlicePane::SlicePane(int axis, QWidget* parent) : QWidget(parent), axis_(axis) {
    setObjectName(QStringLiteral("slice%1").arg(axis));
    setAccessibleName(tr("Slice"));
    setWhatsThis(
        tr("Wheel: next slice. Left: crosshair, or the probe where the mouse is the hand (Ctrl: "
           "crosshair). Right drag: window (sideways) and level (up, down). Middle drag: move. "
           "Ctrl+wheel: zoom. Double click: reset. Keys: arrows, Page Up and Down, +, -, Home."));
    setFocusPolicy(Qt::StrongFocus);
    setMouseTracking(true);
    setAttribute(Qt::WA_OpaquePaintEvent);
    setCursor(Qt::CrossCursor);
    later_.setSingleShot(true);
    connect(&later_, &QTimer::timeout, this, qOverload<>(&QWidget::update));
}

SlicePane::~SlicePane() = default;

const Geometry& SlicePane::geometry() const {
    return content_->samples.field().geometry();
}

void SlicePane::set_field(const Field& field, double isovalue) {
    const bool same = content_ &&
                      content_->samples.field().volume().data() == field.volume().data() &&
                      geometry() == field.geometry();
    const GreyWindow usual = same ? content_->usual : usual_window(field.volume());
    const bool given = same && content_->usual_given;
    content_ = std::make_unique<Content>(field, slice_plane(field.geometry(), axis_), usual);
    content_->usual_given = given;
    isovalue_ = isovalue;
    if (!same) {
        low_ = usual.low;
        high_ = usual.high;
        crosshair_ = physical_centre(field.geometry());
        view_ = {};
        snapshot_.reset();
    }
    setAccessibleName(tr("%1 slice").arg(title()));
    set_crosshair(crosshair_);
    picture_changed();
}

void SlicePane::update_field(const Field& field) {
    if (!content_ || geometry() != field.geometry()) {
        throw std::invalid_argument("the pane shows no other version of these data");
    }
    content_->newer = field;
    update();
}

void SlicePane::clear() {
    content_.reset();
    snapshot_.reset();
    drag_ = Drag::none;
    setAccessibleName(tr("Slice"));
    update();
}

void SlicePane::set_isovalue(double isovalue) {
    if (isovalue == isovalue_) return;
    isovalue_ = isovalue;
    picture_changed();
}

void SlicePane::set_crosshair(const Vec3& physical) {
    if (!physical.allFinite()) return;
    crosshair_ = physical;
    update();
}

/// Of the slice through the crosshair, along the grid axis. The samples follow when it is painted.
double SlicePane::layer() const {
    return content_->samples.nearest(index_from_physical(geometry(), crosshair_)[axis_]);
}

void SlicePane::show_snapshot(const std::optional<Snapshot>& snapshot) {
    snapshot_ = snapshot;
    update();
}

void SlicePane::set_window(double low, double high) {
    if (!(low < high) || !std::isfinite(low) || !std::isfinite(high)) return;
    if (content_ && !content_->usual_given) {
        content_->usual = {low, high};
        content_->usual_given = true;
    }
    use_window(low, high);
}

void SlicePane::use_window(double low, double high) {
    if (low == low_ && high == high_) return;
    low_ = low;
    high_ = high;
    picture_changed();
}

void SlicePane::set_hand(bool probe) {
    probe_ = probe;
    if (!probe && drag_ == Drag::probe) drag_ = Drag::none;
}

QString SlicePane::title() const {
    return content_ ? QString::fromStdString(content_->plane.title) : QString();
}

double SlicePane::margin() const {
    return QFontMetricsF(font()).height();
}

SliceMap SlicePane::map() const {
    return slice_map(content_->plane, geometry(), view_, size(), margin());
}

QPointF SlicePane::pixel_of(const Vec3& physical) const {
    if (!content_) return {};
    const SliceMap where = map();
    return SliceSheet{content_->plane, geometry(), where, 0, size()}.pixel(physical);
}

Vec3 SlicePane::point_at(const QPointF& pixel) const {
    if (!content_) return Vec3::Zero();
    const QPointF at = map().sample(pixel);
    return physical_from_index(
        geometry(), index_from_slice(content_->plane, geometry(), Vec3(at.x(), at.y(), layer())));
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

/// Where need be. A hand moves all the time, data may change all the time, and a slice of a large
/// volume takes milliseconds: as long as only these have changed, most of the time is left to
/// others, and it is drawn a little later.
void SlicePane::make_picture(const SliceMap& where) {
    Content& c = *content_;
    const double scale = devicePixelRatioF();
    const bool moved = layer() != c.samples.position();
    if (!c.picture.isNull() && c.picture.size() == (QSizeF(size()) * scale).toSize()) {
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
    c.samples.go_to(layer());
    c.picture = slice_picture(c.samples, where, {low_, high_}, isovalue_, size(), scale);
    c.took_ms = c.made.elapsed();
    c.made.start();
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
    const SliceSheet sheet{content_->plane, geometry(), where, content_->samples.position(),
                           size()};
    paint_crosshair(painter, sheet, sheet.pixel(crosshair_));
    if (snapshot_) paint_probe(painter, sheet, *snapshot_);
    paint_letters(painter, sheet);
    paint_words(painter);
    if (hasFocus()) {
        painter.setPen(QPen(palette().highlight().color(), 2));
        painter.setBrush(Qt::NoBrush);
        painter.drawRect(QRectF(rect()).adjusted(1, 1, -1, -1));
    }
}

void SlicePane::paint_words(QPainter& painter) const {
    const SliceSamples& samples = content_->samples;
    const int layers = geometry().size[axis_];
    const Vec3 middle = point_at(QPointF(rect().center()));
    painter.setFont(font());
    paint_corner(
        painter, size(), Qt::AlignLeft | Qt::AlignTop,
        {title(),
         samples.in_data() ? tr("%1 / %2").arg(std::lround(samples.position()) + 1).arg(layers)
                           : tr("outside the data"),
         QString::fromStdString(position_text(content_->plane, geometry(), middle))});
    // Short where the letter of the lower edge is, so that narrow panes have room for both.
    paint_corner(
        painter, size(), Qt::AlignRight | Qt::AlignBottom,
        {tr("W %1").arg(high_ - low_, 0, 'g', 5), tr("L %1").arg(0.5 * (low_ + high_), 0, 'g', 5)});
    if (!pointer_) return;
    const Vec3 at = point_at(*pointer_);
    const Vec3 index = index_from_physical(geometry(), at);
    if (!(index.cwiseAbs().maxCoeff() <= farthest_index)) return;
    const auto mm = [](double x) { return QString::number(x, 'f', 1); };
    paint_corner(painter, size(), Qt::AlignLeft | Qt::AlignBottom,
                 {tr("(%1, %2, %3) mm").arg(mm(at[0]), mm(at[1]), mm(at[2])),
                  QString::number(value_at(samples.field(), at), 'g', 6)});
}

}  // namespace palpate::viewer
