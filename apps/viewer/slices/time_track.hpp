// The slider of a time line, with the recording's course drawn on it.
#pragma once

#include <QAbstractSlider>

#include "apps/viewer/model/playback.hpp"

namespace palpate::viewer {

/// A slider over the time of a recording: force magnitude (green), isovalue (grey) where it
/// changes, stretches of contact (vermilion bar below). Its value counts milliseconds from the
/// begin; arrows go by 10 ms, Page Up and Down by a tenth of the whole.
class TimeTrack : public QAbstractSlider {
    Q_OBJECT

  public:
    explicit TimeTrack(QWidget* parent = nullptr);

    /// Nothing for an overview without pieces.
    void set_overview(const Overview& overview);
    /// [s] from the begin.
    double time() const { return time_; }
    /// [s] from the begin; what is outside goes to the ends. Tells nobody.
    void set_time(double time);
    /// [s] of the whole.
    double length() const { return overview_.end - overview_.begin; }

    QSize sizeHint() const override;
    QSize minimumSizeHint() const override;

  Q_SIGNALS:
    /// By the person [s] from the begin.
    void chosen(double time);

  protected:
    bool event(QEvent* event) override;
    void paintEvent(QPaintEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mouseReleaseEvent(QMouseEvent* event) override;
    void sliderChange(SliderChange change) override;

  private:
    QRectF plot() const;
    double x_of(double time) const;
    double time_at(double x) const;
    void choose_at(double x);
    void paint_course(QPainter& painter, const QRectF& box) const;

    Overview overview_;
    double most_force_ = 0, least_isovalue_ = 0, most_isovalue_ = 0;
    double time_ = 0;
    bool telling_ = true;
};

}  // namespace palpate::viewer
