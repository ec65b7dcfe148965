// Windows and enlarges the samples, and draws the contour on top.
#include "apps/viewer/slices/slice_picture.hpp"

#include <QPainter>
#include <QRegion>

#include <algorithm>
#include <cmath>

#include "apps/viewer/slices/line_mask.hpp"
#include "apps/viewer/slices/overlay_picture.hpp"

namespace palpate::viewer {
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
