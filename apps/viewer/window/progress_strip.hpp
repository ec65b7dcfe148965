// Shows the progress of loading, with a button to cancel it.
#pragma once

#include <QWidget>

class QLabel;
class QProgressBar;

namespace palpate::viewer {

/// Hidden while there is no work.
class ProgressStrip : public QWidget {
    Q_OBJECT

  public:
    explicit ProgressStrip(QWidget* parent = nullptr);
    void begin(const QString& what);
    /// `fraction` from 0 to 1.
    void at(double fraction);
    void end();

  Q_SIGNALS:
    void cancelled();

  private:
    QLabel* what_;
    QProgressBar* bar_;
};

}  // namespace palpate::viewer
