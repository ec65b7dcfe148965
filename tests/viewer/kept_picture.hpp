// Pictures that tests leave for people to look at.
#pragma once

#include <QImage>
#include <QString>

namespace palpate::viewer {

/// As PNG, hardly compressed: to compress a picture takes longer than to draw it.
inline bool keep(const QImage& image, const QString& path) {
    constexpr int fastest_deflate = 85;  // Qt makes a level of 0 to 9 of a quality of 100 to 0
    return image.save(path, "PNG", fastest_deflate);
}

}  // namespace palpate::viewer
