// Windows and enlarges the samples, looks every pixel up in the overlay, and draws the contour on
// top.
#include "apps/viewer/slices/slice_picture.hpp"

#include <QCoreApplication>
#include <QPainter>
#include <QRegion>

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>

#include "apps/viewer/model/transfer.hpp"

namespace palpate::viewer {
namespace {

/// [pixels] A longer line is cut, so that the box round it is not mostly empty.
constexpr double longest = 8;

}  // namespace

LineMask::LineMask(int width, int height)
    : width_(std::max(width, 0)),
      height_(std::max(height, 0)),
      covered_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), 0) {}

void LineMask::draw(double x0, double y0, double x1, double y1, double radius) {
    if (!std::isfinite(x0 + y0 + x1 + y1)) return;
    const double margin = radius + 1;
    // The part inside the picture, for a line may be far longer than it (Liang and Barsky 1984).
    double from = 0, to = 1;
    const auto clip = [&](double start, double length, double low, double high) {
        if (length == 0) {
            if (start < low || start > high) to = -1;
            return;
        }
        const double a = (low - start) / length, b = (high - start) / length;
        from = std::max(from, std::min(a, b));
        to = std::min(to, std::max(a, b));
    };
    const double dx = x1 - x0, dy = y1 - y0;
    clip(x0, dx, -margin, width_ + margin);
    clip(y0, dy, -margin, height_ + margin);
    if (!(from <= to)) return;
    const double length = (to - from) * std::sqrt(dx * dx + dy * dy);
    const int parts = std::max(1, static_cast<int>(std::ceil(length / longest)));
    for (int i = 0; i < parts; ++i) {
        const double a = from + (to - from) * i / parts, b = from + (to - from) * (i + 1) / parts;
        draw_short(x0 + a * dx, y0 + a * dy, x0 + b * dx, y0 + b * dy, radius);
    }
}

void LineMask::draw_short(double x0, double y0, double x1, double y1, double radius) {
    const auto fx0 = static_cast<float>(x0), fy0 = static_cast<float>(y0);
    const auto dx = static_cast<float>(x1 - x0), dy = static_cast<float>(y1 - y0);
    const auto r = static_cast<float>(radius);
    const float squared = dx * dx + dy * dy;
    const float scale = squared > 0 ? 1 / squared : 0;
    const double reach = radius + 0.5;
    const float outer = (r + 0.5F) * (r + 0.5F);                  // beyond this nothing is covered,
    const float inner = r > 0.5F ? (r - 0.5F) * (r - 0.5F) : -1;  // up to this all
    const auto pixel = [](double at, int count) {
        return static_cast<int>(std::clamp(std::floor(at), 0.0, double(count)));
    };
    const int left = pixel(std::min(x0, x1) - reach, width_);
    const int right = pixel(std::max(x0, x1) + reach + 1, width_);
    const int top = pixel(std::min(y0, y1) - reach, height_);
    const int bottom = pixel(std::max(y0, y1) + reach + 1, height_);
    for (int y = top; y < bottom; ++y) {
        std::uint8_t* const covered = covered_.data() + static_cast<std::ptrdiff_t>(y) * width_;
        const float py = static_cast<float>(y) + 0.5F - fy0;
        for (int x = left; x < right; ++x) {
            const float px = static_cast<float>(x) + 0.5F - fx0;
            const float along = std::clamp((px * dx + py * dy) * scale, 0.0F, 1.0F);
            const float ex = px - along * dx, ey = py - along * dy;
            const float away = ex * ex + ey * ey;
            if (away >= outer) continue;
            const float near = away <= inner ? 1 : r + 0.5F - std::sqrt(away);
            const auto value = static_cast<std::uint8_t>(255 * std::min(near, 1.0F));
            covered[x] = std::max(covered[x], value);
        }
    }
}

namespace {

struct OverlayWords {
    Q_DECLARE_TR_FUNCTIONS(OverlayWords)
};

/// The sample nearest to a point in index space; nothing outside the voxels.
std::optional<double> nearest_sample(const Volume& volume, const Vec3& index) {
    const Vec3 rounded = (index.array() + 0.5).floor();
    const Vec3 last = (volume.geometry().size - Index3::Ones()).cast<double>();
    if (!(rounded.array() >= 0).all() || !(rounded.array() <= last.array()).all()) {
        return std::nullopt;
    }
    return volume.sample(rounded.cast<int>());
}

/// Trilinear; beyond the outermost samples, up to their voxels' ends, these go on.
std::optional<double> interpolated(const Volume& volume, const Vec3& index) {
    const Index3 size = volume.geometry().size;
    const Vec3 last = (size - Index3::Ones()).cast<double>();
    if (!(index.array() >= -0.5).all() || !(index.array() <= last.array() + 0.5).all()) {
        return std::nullopt;
    }
    const Vec3 in = index.cwiseMax(Vec3::Zero()).cwiseMin(last);
    const Index3 low = in.cast<int>().cwiseMin((size - Index3::Constant(2)).cwiseMax(0));
    const Vec3 part = in - low.cast<double>();
    double value = 0;
    for (int c = 0; c < 8; ++c) {
        const Index3 side(c & 1, c >> 1 & 1, c >> 2 & 1);
        double weight = 1;
        for (int a = 0; a < 3; ++a) weight *= side[a] ? part[a] : 1 - part[a];
        if (weight > 0) value += weight * volume.sample(low + side);
    }
    return value;
}

struct Ink {
    QRgb colour = 0;
    double alpha = 0;
};

/// Colours of the values of an overlay.
class Inks {
  public:
    Inks(const Overlay& overlay, const OverlayLook& look)
        : overlay_(overlay), look_(look), table_(colour_table(look.colours)) {
        for (const Label& label : overlay.labels) {
            const bool hidden = std::ranges::count(look.hidden, label.value) > 0;
            const Colour& c = label.colour;
            labels_[label.value] = {QColor::fromRgbF(c.red, c.green, c.blue).rgb(),
                                    hidden ? 0 : look.opacity};
        }
    }
    Ink at(const Vec3& index) const {
        if (overlay_.is_label_map()) {
            const auto value = nearest_sample(overlay_.volume, index);
            const auto found = value ? labels_.find(static_cast<int>(*value)) : labels_.end();
            return found == labels_.end() ? Ink{} : found->second;
        }
        const auto value = interpolated(overlay_.volume, index);
        if (!value) return {};
        constexpr double fades = 0.15;  // of the range
        const double part = (*value - overlay_.dark) / (overlay_.bright - overlay_.dark);
        const double clamped = std::clamp(part, 0.0, 1.0);
        return {table_[static_cast<std::size_t>(std::lround(255 * clamped))],
                look_.opacity * std::min(1.0, clamped / fades)};
    }

  private:
    const Overlay& overlay_;
    const OverlayLook& look_;
    ColourTable table_;
    std::unordered_map<int, Ink> labels_;
};

QRgb mixed(QRgb under, const Ink& ink) {
    const auto mix = [&](int a, int b) {
        return static_cast<int>(std::lround(a + (b - a) * ink.alpha));
    };
    return qRgb(mix(qRed(under), qRed(ink.colour)), mix(qGreen(under), qGreen(ink.colour)),
                mix(qBlue(under), qBlue(ink.colour)));
}

}  // namespace

void draw_overlay(QImage& picture, const SlicePlane& plane, const Geometry& geometry,
                  const SliceMap& map, double position, const Overlay& overlay,
                  const OverlayLook& look) {
    const double scale = picture.devicePixelRatio();
    const auto index_of = [&](double x, double y) {
        const QPointF at = map.sample(QPointF((x + 0.5) / scale, (y + 0.5) / scale));
        const Vec3 physical = physical_from_index(
            geometry, index_from_slice(plane, geometry, {at.x(), at.y(), position}));
        return index_from_physical(overlay.volume.geometry(), physical);
    };
    // All of it is affine.
    const Vec3 first = index_of(0, 0);
    const Vec3 right = index_of(1, 0) - first, down = index_of(0, 1) - first;
    const Inks inks(overlay, look);
    for (int y = 0; y < picture.height(); ++y) {
        auto* const line = reinterpret_cast<QRgb*>(picture.scanLine(y));
        for (int x = 0; x < picture.width(); ++x) {
            const Ink ink = inks.at(first + x * right + y * down);
            if (ink.alpha > 0) line[x] = mixed(line[x], ink);
        }
    }
}

QString overlay_words(const Overlay& overlay, const Vec3& physical) {
    const Vec3 index = index_from_physical(overlay.volume.geometry(), physical);
    if (!overlay.is_label_map()) {
        const auto value = interpolated(overlay.volume, index);
        return value ? OverlayWords::tr("overlay %1").arg(*value, 0, 'g', 5) : QString();
    }
    const auto value = nearest_sample(overlay.volume, index);
    if (!value) return {};
    const auto found = std::ranges::find(overlay.labels, static_cast<int>(*value), &Label::value);
    return found == overlay.labels.end() ? QString() : QString::fromStdString(found->name);
}

namespace {

/// [device pixels] Half the contour's width, for a scale of 1.
constexpr double contour_radius = 0.8;
/// [device pixels] Cells that are smaller show no difference between the lattice and two triangles.
constexpr double smallest_exact_cell = 3;
/// A picture that is made smaller than this is averaged, not sampled.
constexpr double least_enlargement = 0.75;

/// The samples that are seen, with one more on each side to interpolate with.
QRect seen(const SliceSamples& samples, const SliceMap& map, const QSize& size) {
    const QPointF low = map.sample({0, 0}), high = map.sample(QPointF(size.width(), size.height()));
    const auto cut = [](double at, int count) {
        return static_cast<int>(std::clamp(at, -2.0, count + 1.0));
    };
    const QRect wide(QPoint(cut(std::floor(low.x()) - 1, samples.width()),
                            cut(std::floor(low.y()) - 1, samples.height())),
                     QPoint(cut(std::ceil(high.x()) + 1, samples.width()),
                            cut(std::ceil(high.y()) + 1, samples.height())));
    return wide;
}

QImage grey_image(const SliceSamples& samples, const QRect& part, const SliceStyle& style) {
    const GreyWindow& window = style.window;
    QImage image(part.size(), QImage::Format_RGB32);
    std::vector<float> values(static_cast<std::size_t>(samples.width()));
    const auto low = static_cast<float>(window.low);
    const auto scale = static_cast<float>(255 / (window.high - window.low));
    for (int y = 0; y < part.height(); ++y) {
        samples.interpolate(part.top() + y, values.data());
        auto* const line = reinterpret_cast<QRgb*>(image.scanLine(y));
        const float* const from = values.data() + part.left();
        for (int x = 0; x < part.width(); ++x) {
            const float level = std::clamp((from[x] - low) * scale, 0.0F, 255.0F);
            line[x] = style.colours[static_cast<std::size_t>(level + 0.5F)];
        }
    }
    return image;
}

void draw_grey(QImage& picture, const SliceSamples& samples, const SliceMap& map,
               const SliceStyle& style, const QRect& cells, const QRectF& drawn) {
    const QRect part = cells & QRect(0, 0, samples.width(), samples.height());
    if (part.isEmpty() || !samples.in_data()) return;
    QImage image = grey_image(samples, part, style);
    const QRectF target(map.pixel(part.left() - 0.5, part.top() - 0.5),
                        map.pixel(part.right() + 0.5, part.bottom() + 0.5));
    const double scale = picture.devicePixelRatio();
    if (std::min(map.per_u, map.per_v) * scale < least_enlargement) {
        const QSize pixels = (target.size() * scale).toSize().expandedTo(QSize(1, 1));
        image = image.scaled(pixels.boundedTo(image.size() * 4), Qt::IgnoreAspectRatio,
                             Qt::SmoothTransformation);
    }
    QPainter painter(&picture);
    painter.setRenderHint(QPainter::SmoothPixmapTransform);
    painter.setClipRect(drawn);
    painter.drawImage(target, image, QRectF(image.rect()));
}

/// `drawn`: the pixels of the picture in which the contour is drawn.
void draw_contour(QImage& picture, const SliceSamples& samples, const SliceMap& map,
                  double isovalue, const QColor& colour, const QRect& part, const QRegion& drawn) {
    const double scale = picture.devicePixelRatio();
    const ContourDetail detail = std::min(map.per_u, map.per_v) * scale < smallest_exact_cell
                                     ? ContourDetail::cells
                                     : ContourDetail::lattice;
    std::vector<ContourPiece> pieces;
    append_contour(samples, isovalue,
                   {part.left(), part.top(), part.right() + 1, part.bottom() + 1}, detail, pieces);
    LineMask mask(picture.width(), picture.height());
    for (const ContourPiece& p : pieces) {
        const QPointF a = scale * map.pixel(p.u0, p.v0), b = scale * map.pixel(p.u1, p.v1);
        mask.draw(a.x(), a.y(), b.x(), b.y(), scale * contour_radius);
    }
    const std::array<int, 3> ink{colour.red(), colour.green(), colour.blue()};
    const auto draw_row = [&](int y, int first, int last) {
        const std::uint8_t* const covered = mask.row(y);
        auto* const line = reinterpret_cast<QRgb*>(picture.scanLine(y));
        for (int x = first; x <= last; ++x) {
            const int c = covered[x];
            if (c == 0) continue;
            const auto mix = [c](int under, int over) { return under + (over - under) * c / 255; };
            line[x] = qRgb(mix(qRed(line[x]), ink[0]), mix(qGreen(line[x]), ink[1]),
                           mix(qBlue(line[x]), ink[2]));
        }
    };
    for (const QRect& rect : drawn) {
        for (int y = rect.top(); y <= rect.bottom(); ++y) draw_row(y, rect.left(), rect.right());
    }
}

/// Grey levels over what is there, and black where they end.
void draw_finer_grey(QImage& picture, const FinerSlice& finer, const SliceStyle& style,
                     const QSize& size) {
    {
        QPainter painter(&picture);
        painter.fillRect(finer.drawn, Qt::black);
    }
    draw_grey(picture, *finer.samples, finer.map, style, seen(*finer.samples, finer.map, size),
              finer.drawn);
}

}  // namespace

QColor contour_colour() {
    return {250, 120, 30};
}

QImage slice_picture(const SliceSamples& samples, const SlicePlane& plane, const SliceMap& map,
                     const SliceStyle& style, const QSize& size, double scale,
                     const std::optional<FinerSlice>& finer) {
    QImage picture((QSizeF(size) * scale).toSize().expandedTo(QSize(1, 1)), QImage::Format_RGB32);
    picture.setDevicePixelRatio(scale);
    picture.fill(Qt::black);
    const QRect cells = seen(samples, map, size);
    draw_grey(picture, samples, map, style, cells, QRectF(QPointF(0, 0), QSizeF(size)));
    if (finer) draw_finer_grey(picture, *finer, style, size);
    if (style.overlay && style.overlay_look.shown) {
        draw_overlay(picture, plane, samples.field().geometry(), map, samples.position(),
                     *style.overlay, style.overlay_look);
    }
    const QRegion inside =
        finer ? QRectF(scale * finer->drawn.topLeft(), scale * finer->drawn.size()).toAlignedRect()
              : QRect();
    const auto contour = [&](double level, const QColor& colour) {
        const QRect all = picture.rect();
        draw_contour(picture, samples, map, level, colour, cells, QRegion(all) - inside);
        if (!finer) return;
        draw_contour(picture, *finer->samples, finer->map, level, colour,
                     seen(*finer->samples, finer->map, size), inside & all);
    };
    for (const SeenSurface& other : style.surfaces) {
        const Colour& c = other.colour;
        if (!other.shown) continue;
        contour(other.level, QColor::fromRgbF(c.red, c.green, c.blue).lighter(130));
    }
    contour(style.isovalue, contour_colour());
    return picture;
}

}  // namespace palpate::viewer
