// Looks up every pixel in the overlay.
#include "apps/viewer/slices/overlay_picture.hpp"

#include <QCoreApplication>
#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>

#include "apps/viewer/model/colour_map.hpp"

namespace palpate::viewer {
namespace {

/// Words of this file.
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

/// Colour and how much of it.
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

}  // namespace palpate::viewer
