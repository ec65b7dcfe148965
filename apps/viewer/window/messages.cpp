// Shows problems in a dialog that does not block the window.
#include "apps/viewer/window/messages.hpp"

#include <QMessageBox>
#include <cstdio>

namespace palpate::viewer {

bool Messages::guarded(const std::function<void()>& action) {
    try {
        action();
        return true;
    } catch (const std::exception& e) {
        const app::Failure failure = app::failure_of(e);
        show_problem(QString::fromStdString(failure.text), failure.status);
        return false;
    }
}

void Messages::ask(QDialog* dialog, const QString& otherwise) {
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    if (!unattended_) return dialog->open();
    show_problem(otherwise.isEmpty() ? dialog->windowTitle() : otherwise);
    dialog->deleteLater();
}

int Messages::answer_to(QMessageBox& question) {
    return unattended_ ? int(QMessageBox::Discard) : question.exec();
}

void Messages::show_problem(const QString& what, int status) {
    problem_ = what;
    problem_status_ = status;
    std::fprintf(stderr, "palpate: %s\n", what.toLocal8Bit().constData());
    auto* box = new QMessageBox(QMessageBox::Warning, "Palpate", what, QMessageBox::Ok, window_);
    box->setObjectName("problem");
    box->setTextInteractionFlags(Qt::TextSelectableByMouse);
    box->setAttribute(Qt::WA_DeleteOnClose);
    box->open();  // does not block the live run
}

}  // namespace palpate::viewer
