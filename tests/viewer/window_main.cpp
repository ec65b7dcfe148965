// Runs the tests of a program that has windows. Without a window system, unless the environment
// names one: windows are active when a test says so, and no other program takes part.
#include <gtest/gtest.h>

#include <QSurfaceFormat>

#include <QVTKOpenGLNativeWidget.h>

#include <cstdio>

#include "apps/viewer/panel/application.hpp"

namespace {

/// All that Qt says, but for what its offscreen platform cannot do.
void tell(QtMsgType, const QMessageLogContext&, const QString& what) {
    for (const char* usual : {"This plugin does not support", "QOpenGLWidget"}) {
        if (what.startsWith(usual)) return;
    }
    std::fprintf(stderr, "%s\n", what.toLocal8Bit().constData());
}

}  // namespace

int main(int argc, char** argv) {
    testing::InitGoogleTest(&argc, argv);
    if (!qEnvironmentVariableIsSet("QT_QPA_PLATFORM")) {
        qputenv("QT_QPA_PLATFORM", "offscreen");
        qputenv("QT_QPA_OFFSCREEN_NO_GLX", "1");  // not even OpenGL of a display
        qInstallMessageHandler(tell);
    }
    QSurfaceFormat::setDefaultFormat(QVTKOpenGLNativeWidget::defaultFormat());
    palpate::viewer::Application application(argc, argv);
    QApplication::setOrganizationName("palpate-tests");
    return RUN_ALL_TESTS();
}
