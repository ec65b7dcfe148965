// The image of a slice: grey levels, an overlay, and the isosurface's contour.
#pragma once

#include <QColor>
#include <QImage>
#include <QRectF>
#include <QString>

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "apps/viewer/model/shown.hpp"
#include "apps/viewer/model/transfer.hpp"
#include "apps/viewer/slices/contour.hpp"
#include "apps/viewer/slices/plane.hpp"

namespace palpate::viewer {

/// Draws many short lines smoothly and fast: how much of each pixel they cover. No Qt.
class LineMask {
  public:
    /// [pixels]
    LineMask(int width, int height);

    int width() const { return width_; }
    int height() const { return height_; }
    /// A line of `radius` [pixels] with round ends. Pixel (0, 0) is centred at (0.5, 0.5). What is
    /// outside is left out; where lines meet, nothing is drawn twice.
    void draw(double x0, double y0, double x1, double y1, double radius);
    /// Covered part of each pixel of a row, 0 to 255.
    const std::uint8_t* row(int y) const {
        return covered_.data() + static_cast<std::ptrdiff_t>(y) * width_;
    }

  private:
    int width_, height_;
    std::vector<std::uint8_t> covered_;
};

/// Over `picture`, by the look's opacity: labels in their colours, sample by sample; an image in
/// its colour map, interpolated, fading out towards its dark end. Each pixel is looked up in the
/// overlay's own grid, whatever that is. `layer`: of the slice.
void draw_overlay(QImage& picture, const SlicePlane& plane, const SliceMap& map, double layer,
                  const Overlay& overlay, const OverlayLook& look);

/// What the overlay has at a point [mm, physical]: a label's name, or a number. Empty outside.
QString overlay_words(const Overlay& overlay, const Vec3& physical);

/// The colour of the contour: a light vermilion, like the proxy's.
QColor contour_colour();

struct SliceStyle {
    GreyWindow window{0, 1};  ///< its ends have the first colour and the last
    ColourTable colours = colour_table("grey");
    double isovalue = 0;                     ///< of the contour [data units]
    std::vector<SeenSurface> surfaces;       ///< contours of others, in their colours
    std::shared_ptr<const Overlay> overlay;  ///< null: none
    OverlayLook overlay_look;
    bool operator==(const SliceStyle&) const = default;
};

/// A finer part of the slice, drawn in its place.
struct FinerSlice {
    const SliceSamples* samples;
    SliceMap map;
    QRectF drawn;  ///< [pixels] where
};

/// The slice as it is seen through `map` in a widget of `size`, `scale` device pixels a pixel;
/// black where there are no data. Nothing is drawn beyond what is seen.
QImage slice_picture(const SliceSamples& samples, const SliceMap& map, const SliceStyle& style,
                     const QSize& size, double scale, const std::optional<FinerSlice>& finer = {});

}  // namespace palpate::viewer
