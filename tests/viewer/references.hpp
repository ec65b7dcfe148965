// Compares pictures with committed references. After an intended change: run the tests with
// PALPATE_WRITE_REFERENCES=1, look at the pictures in references/, commit them.
#pragma once

#include <gtest/gtest.h>

#include <QImage>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace palpate::viewer {

/// Mean absolute difference of all channels, 0 to 255; 255 for pictures of two sizes.
inline double difference(const QImage& a, const QImage& b) {
    if (a.size() != b.size()) return 255;
    double sum = 0;
    for (int y = 0; y < a.height(); ++y) {
        for (int x = 0; x < a.width(); ++x) {
            const QRgb p = a.pixel(x, y), q = b.pixel(x, y);
            sum += std::abs(qRed(p) - qRed(q)) + std::abs(qGreen(p) - qGreen(q)) +
                   std::abs(qBlue(p) - qBlue(q));
        }
    }
    return sum / (3.0 * a.width() * a.height());
}

/// Edges and letters differ with drivers and fonts, a little everywhere or much in few pixels.
inline void expect_as_committed(const QImage& image, const std::string& name) {
    const QString path = QString::fromStdString(PALPATE_REFERENCES + ("/" + name + ".png"));
    if (std::getenv("PALPATE_WRITE_REFERENCES")) {
        std::filesystem::create_directories(PALPATE_REFERENCES);
        ASSERT_TRUE(image.save(path));
    }
    const QImage reference = QImage(path).convertToFormat(QImage::Format_RGB32);
    ASSERT_FALSE(reference.isNull()) << path.toStdString();
    if (image.size() != reference.size()) GTEST_SKIP() << "references are for a scale of 1";
    EXPECT_LT(difference(image, reference), 2) << name;
    int others = 0;
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            const QRgb p = image.pixel(x, y), q = reference.pixel(x, y);
            others += std::abs(qGray(p) - qGray(q)) > 50;
        }
    }
    EXPECT_LT(others, image.width() * image.height() / 100) << name;
}

}  // namespace palpate::viewer
