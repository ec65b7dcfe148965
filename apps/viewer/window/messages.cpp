// Shows problems in a dialog that does not block the window, and watches tasks.
#include "apps/viewer/window/messages.hpp"

#include <QAbstractButton>
#include <QHBoxLayout>
#include <QLabel>
#include <QMessageBox>
#include <QProgressBar>
#include <QPushButton>
#include <QRegularExpression>
#include <QTimer>

#include <cstdio>
#include <thread>
#include <utility>

#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/panel/sentences.hpp"

namespace palpate::viewer {

bool Messages::guarded(const std::function<void()>& action) {
    try {
        action();
        return true;
    } catch (const std::exception& e) {
        const app::Failure failure = app::failure_of(e);
        show_problem(in_words(failure.text), failure.status);
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

bool Messages::may_lose(const char* name, const QString& question, const QString& without,
                        const std::function<void()>& save) {
    QMessageBox box(QMessageBox::Question, "Palpate", question,
                    QMessageBox::Save | QMessageBox::Discard | QMessageBox::Cancel, window_);
    box.setObjectName(name);
    box.setDefaultButton(QMessageBox::Save);
    if (!without.isEmpty()) box.button(QMessageBox::Discard)->setText(without);
    const int answer = answer_to(box);
    if (answer == QMessageBox::Save) guarded(save);
    return answer == QMessageBox::Discard;
}

namespace {

/// With places at which a long name can go on in the next line.
QString breakable(QString text) {
    const QRegularExpression part("(\\S{40}\\S*?[-_/.])(?=\\S)");
    return text.replace(part, QString("\\1%1").arg(QChar(0x200b)));
}

}  // namespace

void Messages::show_problem(const QString& what, int status) {
    problem_ = what;
    problem_status_ = status;
    const QString text = breakable(what);
    for (const auto* open : window_->findChildren<QMessageBox*>("problem")) {
        if (open->isVisible() && open->text() == text) return;
    }
    std::fprintf(stderr, "palpate: %s\n", what.toLocal8Bit().constData());
    auto* box = new QMessageBox(QMessageBox::Warning, "Palpate", text, QMessageBox::Ok, window_);
    box->setObjectName("problem");
    box->setTextFormat(Qt::PlainText);  // also of a file with a name like "<b>"
    box->setTextInteractionFlags(Qt::TextSelectableByMouse);
    box->setAttribute(Qt::WA_DeleteOnClose);
    box->open();  // does not block the live run
}

QList<BackgroundTask*> Messages::tasks() const {
    return findChildren<BackgroundTask*>(QString(), Qt::FindDirectChildrenOnly);
}

void BackgroundTask::start(const QString& label, Worker::Task task, std::function<void()> then) {
    abandon();
    then_ = std::move(then);
    Q_EMIT began(label);
    worker_ = std::make_unique<Worker>(std::move(task), [this] {
        QMetaObject::invokeMethod(
            this, [this] { look(); }, Qt::QueuedConnection);
    });
}

void BackgroundTask::look() {
    if (!worker_) return;
    Q_EMIT progressed(worker_->progress());
    if (!worker_->ended()) return;
    const auto ended_worker = std::move(worker_);
    const auto then = std::exchange(then_, nullptr);
    Q_EMIT ended();
    messages_.guarded([&] {
        if (ended_worker->finish()) then();
    });
}

void BackgroundTask::cancel() {
    if (worker_) worker_->cancel();
}

void BackgroundTask::abandon() {
    if (!worker_) return;
    worker_.reset();
    then_ = nullptr;
    Q_EMIT ended();
}

void BackgroundTask::end_within(std::chrono::milliseconds time) {
    constexpr std::chrono::milliseconds between_looks{2};
    const auto latest = std::chrono::steady_clock::now() + time;
    while (worker_ && !worker_->ended() && std::chrono::steady_clock::now() < latest) {
        std::this_thread::sleep_for(between_looks);
    }
    if (worker_ && worker_->ended()) look();
    abandon();
}

/// Not for what is done at once: the strip makes the views smaller, which draws them anew.
QWidget* make_progress_strip(BackgroundTask& task) {
    constexpr int shown_after_ms = 150;
    auto* label = new QLabel;
    label->setTextFormat(Qt::PlainText);
    label->setMinimumWidth(1);  // a long name must not make the window wider
    auto* bar = new QProgressBar;
    bar->setRange(0, 100);
    auto* cancel = named(new QPushButton(BackgroundTask::tr("Cancel")), "cancel");
    auto* strip = named(new QWidget, "progress");
    auto* late = new QTimer(strip);
    late->setSingleShot(true);
    auto* row = new QHBoxLayout(strip);
    row->addWidget(label);
    row->addWidget(bar, 1);
    row->addWidget(cancel);
    QObject::connect(cancel, &QPushButton::clicked, &task, &BackgroundTask::cancel);
    QObject::connect(&task, &BackgroundTask::began, strip, [=](const QString& what) {
        label->setText(what);
        label->setToolTip("<p>" + what.toHtmlEscaped() + "</p>");
        bar->setValue(0);
        late->start(shown_after_ms);
    });
    QObject::connect(late, &QTimer::timeout, strip, &QWidget::show);
    QObject::connect(&task, &BackgroundTask::progressed, strip,
                     [bar](double fraction) { bar->setValue(static_cast<int>(100 * fraction)); });
    QObject::connect(&task, &BackgroundTask::ended, strip, [=] {
        late->stop();
        strip->hide();
    });
    strip->hide();
    return strip;
}

}  // namespace palpate::viewer
