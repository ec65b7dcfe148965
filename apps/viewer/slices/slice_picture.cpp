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
LineMask::LineMask(int width, int height)
    : width_(std::max(width, 0)),
      height_(std::max(height, 0)),
      covered_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), 0) {}

void LineMask::draw(double x0, double y0, double x1, double y1, double radius) {
    if (!std::isfinite(x0 + y0 + x1 + y1)) return;
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

void draw_overlay(QImage& picture, const SlicePlane& plane, const SliceMap& map, double layer,
                  const Overlay& overlay, const OverlayLook& look) {
    const double scale = picture.devicePixelRatio();
    const auto index_of = [&](double x, double y) {
        const QPointF at = map.sample(QPointF((x + 0.5) / scale, (y + 0.5) / scale));
        return index_from_physical(overlay.volume.geometry(),
                                   plane.physical({at.x(), at.y(), layer}));
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
/// [device pixels] Straight pieces of the contour are about so long.
constexpr double contour_step = 2;
constexpr int most_parts = 16;
/// A picture that is made smaller than this is averaged, not sampled.
constexpr double least_enlargement = 0.75;

/// A part of the picture that shows samples of its own.
struct Part {
    const SliceSamples& samples;
    SliceMap map;
    QRectF drawn;     // [pixels] where its grey levels are
    QRegion contour;  // [device pixels] where its contour is
    QRect cells;      // that are seen, with one more on each side to interpolate with
};

QRect seen(const SliceSamples& samples, const SliceMap& map, const QSize& size) {
    const QPointF low = map.sample({0, 0}), high = map.sample(QPointF(size.width(), size.height()));
    const auto cut = [](double at, int count) {
        return static_cast<int>(std::clamp(at, -2.0, count + 1.0));
    };
    return {QPoint(cut(std::floor(low.x()) - 1, samples.width()),
                   cut(std::floor(low.y()) - 1, samples.height())),
            QPoint(cut(std::ceil(high.x()) + 1, samples.width()),
                   cut(std::ceil(high.y()) + 1, samples.height()))};
}

/// A finer part is drawn in the place of the whole.
std::vector<Part> parts_of(const SliceSamples& samples, const SliceMap& map, const QSize& size,
                           double scale, const std::optional<FinerSlice>& finer) {
    const QRect all({0, 0}, (QSizeF(size) * scale).toSize());
    std::vector<Part> parts{
        {samples, map, QRectF({0, 0}, QSizeF(size)), all, seen(samples, map, size)}};
    if (!finer) return parts;
    const QRectF& drawn = finer->drawn;
    const QRect inside = QRectF(scale * drawn.topLeft(), scale * drawn.size()).toAlignedRect();
    parts.front().contour -= inside;
    parts.push_back({*finer->samples, finer->map, drawn, inside & all,
                     seen(*finer->samples, finer->map, size)});
    return parts;
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

/// Grey levels over what is there, and black where they end.
void draw_grey(QImage& picture, const Part& part, const SliceStyle& style) {
    QPainter painter(&picture);
    painter.fillRect(part.drawn, Qt::black);
    const SliceMap& map = part.map;
    const QRect shown = part.cells & QRect(0, 0, part.samples.width(), part.samples.height());
    if (shown.isEmpty() || !part.samples.in_data()) return;
    QImage image = grey_image(part.samples, shown, style);
    const QRectF target(map.pixel(shown.left() - 0.5, shown.top() - 0.5),
                        map.pixel(shown.right() + 0.5, shown.bottom() + 0.5));
    const double scale = picture.devicePixelRatio();
    if (std::min(map.per_u, map.per_v) * scale < least_enlargement) {
        const QSize pixels = (target.size() * scale).toSize().expandedTo(QSize(1, 1));
        image = image.scaled(pixels.boundedTo(image.size() * 4), Qt::IgnoreAspectRatio,
                             Qt::SmoothTransformation);
    }
    painter.setRenderHint(QPainter::SmoothPixmapTransform);
    painter.setClipRect(part.drawn);
    painter.drawImage(target, image, QRectF(image.rect()));
}

void draw_contour(QImage& picture, const Part& part, double isovalue, const QColor& colour) {
    const double scale = picture.devicePixelRatio();
    const double cell = std::min(part.map.per_u, part.map.per_v) * scale;
    const auto steps = std::clamp<double>(std::round(cell / contour_step), 1, most_parts);
    const QRect& cells = part.cells;
    std::vector<ContourPiece> pieces;
    append_contour(part.samples, isovalue,
                   {cells.left(), cells.top(), cells.right() + 1, cells.bottom() + 1},
                   static_cast<int>(steps), pieces);
    LineMask mask(picture.width(), picture.height());
    for (const ContourPiece& p : pieces) {
        const QPointF a = scale * part.map.pixel(p.u0, p.v0),
                      b = scale * part.map.pixel(p.u1, p.v1);
        mask.draw(a.x(), a.y(), b.x(), b.y(), scale * contour_radius);
    }
    for (const QRect& rect : part.contour) {
        for (int y = rect.top(); y <= rect.bottom(); ++y) {
            const std::uint8_t* const covered = mask.row(y);
            auto* const line = reinterpret_cast<QRgb*>(picture.scanLine(y));
            for (int x = rect.left(); x <= rect.right(); ++x) {
                if (covered[x] > 0) line[x] = mixed(line[x], {colour.rgb(), covered[x] / 255.0});
            }
        }
    }
}

}  // namespace

QColor contour_colour() {
    return {250, 120, 30};
}

QImage slice_picture(const SliceSamples& samples, const SliceMap& map, const SliceStyle& style,
                     const QSize& size, double scale, const std::optional<FinerSlice>& finer) {
    QImage picture((QSizeF(size) * scale).toSize().expandedTo(QSize(1, 1)), QImage::Format_RGB32);
    picture.setDevicePixelRatio(scale);
    picture.fill(Qt::black);
    const std::vector<Part> parts = parts_of(samples, map, size, scale, finer);
    for (const Part& part : parts) draw_grey(picture, part, style);
    if (style.overlay && style.overlay_look.shown) {
        draw_overlay(picture, samples.plane(), map, samples.position(), *style.overlay,
                     style.overlay_look);
    }
    const auto contour = [&](double level, const QColor& colour) {
        for (const Part& part : parts) draw_contour(picture, part, level, colour);
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
