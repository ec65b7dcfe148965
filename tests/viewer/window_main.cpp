// Runs the tests of a program that has windows.
#include <gtest/gtest.h>

#include <QApplication>
#include <QSurfaceFormat>

#include <QVTKOpenGLNativeWidget.h>

int main(int argc, char** argv) {
    testing::InitGoogleTest(&argc, argv);
    QSurfaceFormat::setDefaultFormat(QVTKOpenGLNativeWidget::defaultFormat());
    QApplication application(argc, argv);
    QApplication::setOrganizationName("palpate-tests");
    return RUN_ALL_TESTS();
}
