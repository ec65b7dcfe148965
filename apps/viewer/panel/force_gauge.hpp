// A gauge of the force against its limit: a bar, a number, and a text while the force is reduced.
#pragma once

#include <QString>
#include <QWidget>

namespace palpate::viewer {

class ForceGauge : public QWidget {
    Q_OBJECT

  public:
    ForceGauge();

    /// [N]; `words`, as app::force_words() has them, stand beside the number.
    void set_force(double force, double limit, const QString& words);
    void clear();
    double force() const { return force_; }
    double limit() const { return limit_; }
    const QString& words() const { return words_; }
    /// How much of the bar is filled, 0 to 1.
    double filled() const;

    QSize sizeHint() const override;
    QSize minimumSizeHint() const override;

  protected:
    void paintEvent(QPaintEvent* event) override;

  private:
    double force_ = 0, limit_ = 0;
    QString words_;
};

}  // namespace palpate::viewer
