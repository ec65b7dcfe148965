// Icons of tool buttons.
#include "apps/viewer/panel/icons.hpp"

#include <QApplication>
#include <QImage>
#include <QPalette>

#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace palpate::viewer {
namespace {

constexpr int count = static_cast<int>(Shape::whole) + 1;

QImage picture_of(Shape shape) {
    return icon_of(shape).pixmap(24, 24).toImage().convertToFormat(
        QImage::Format_ARGB32_Premultiplied);
}

TEST(Icons, are_all_different_and_neither_empty_nor_full) {
    std::set<std::vector<uchar>> pictures;
    for (int i = 0; i < count; ++i) {
        const QImage picture = picture_of(static_cast<Shape>(i));
        double covered = 0;
        for (int y = 0; y < picture.height(); ++y) {
            for (int x = 0; x < picture.width(); ++x) covered += qAlpha(picture.pixel(x, y)) > 128;
        }
        covered /= picture.width() * picture.height();
        EXPECT_GT(covered, 0.06) << i;
        EXPECT_LT(covered, 0.6) << i;
        pictures.emplace(picture.constBits(), picture.constBits() + picture.sizeInBytes());
    }
    EXPECT_EQ(pictures.size(), std::size_t{count});
}

/// In the left bar of the sign for a pause.
QColor colour_of(const QIcon& icon, QIcon::Mode mode) {
    const QImage picture = icon.pixmap(48, 48, mode).toImage();
    return picture.pixelColor(picture.width() * 3 / 10, picture.height() / 2);
}

TEST(Icons, have_the_colour_of_text_at_the_time_when_they_are_painted) {
    const QPalette before = QApplication::palette();
    const QIcon icon = icon_of(Shape::pause);
    for (const QColor& ink : {QColor(250, 250, 250), QColor(10, 20, 30)}) {
        QPalette palette = before;
        palette.setColor(QPalette::Active, QPalette::ButtonText, ink);
        palette.setColor(QPalette::Disabled, QPalette::ButtonText, Qt::red);
        QApplication::setPalette(palette);
        EXPECT_EQ(colour_of(icon, QIcon::Normal), ink);
        EXPECT_EQ(colour_of(icon, QIcon::Disabled), Qt::red);
    }
    QApplication::setPalette(before);
}

}  // namespace
}  // namespace palpate::viewer
