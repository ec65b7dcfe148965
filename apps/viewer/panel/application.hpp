// The application of programs with windows: an exception in a slot or a handler of events does not
// end it.
#pragma once

#include <QApplication>

#include <exception>
#include <functional>

namespace palpate::viewer {

class Application : public QApplication {
  public:
    using QApplication::QApplication;

    /// Is called where one is caught. Without it, it ends the program.
    std::function<void(const std::exception&)> on_failure;

    bool notify(QObject* receiver, QEvent* event) override {
        try {
            return QApplication::notify(receiver, event);
        } catch (const std::exception& error) {
            if (!on_failure) throw;
            on_failure(error);
            return true;
        }
    }
};

}  // namespace palpate::viewer
